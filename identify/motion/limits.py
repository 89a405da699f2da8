"""The numbers that decide where the motion is free: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides, numerics

# decays.py

TAKES = decides(
    0.9,
    "part of what an envelope takes",
    "whether the modes of a linear rig explain the motion",
    why="the ends of either are that vague; what leaves out more is the small end of a motion that glides",
)

# shared_modes.py, rig_pieces.py and swings.py

KNOWN = decides(
    1 / 3,
    "of itself",
    "how well frequency and fall must be known",
    why="error rate: zero is three standard errors away",
)
BENT = decides(
    0.01,
    "of the motion",
    "what modes may leave of it where they do not reach the noise",
    why="physical limit: a clock that jitters, steps of a converter and a weak curvature of the spring bend as much",
)
#: What a rig may leave of the motion beside its noise: nothing, or where nothing is explained so, what bends it.
SHARES = (0.0, BENT)
#: Of a mode beside others: what is damped more has no resonance (its peak is at zero), and fits how a hand lets go.
RINGS = numerics(0.5**0.5, "damping ratio", why="where the resonance of a linear rig has its peak at zero")
BEYOND = decides(
    2.0,
    "standard deviations",
    "beyond which a block mean at an edge is something else's",
    why="error rate: likelier than not, where a motion begins as often as it goes on",
)

# falling.py, swings.py and whatever else falls

FALLS = decides(
    0.8,
    "of its amplitude",
    "to which a motion falls that is a decay, and from which it grows that is another one",
    why="a steady tone, a drive near resonance and noise change it by less than a fifth",
)

# mode_lines.py and mode.py

SAME_MODE = decides(
    1.05,
    "times its frequency",
    "up to which a frequency beside those of a mode is the same mode's",
    why="what a user types from a plot, and lines of two windows, are off by some per cent",
)
ORDERS = decides(
    3,
    "multiples",
    "of the frequencies of two modes, whose sums and differences a nonlinear joint or sensor makes",
    why="physical limit: a force of the third power makes them; those of higher orders are smaller",
)

# force_off.py

ON = decides(
    0.15,
    "part of its largest",
    "above which a force pushes, however quiet it is",
    why="crosstalk of an amplifier that is switched off, and the zero of a load cell, are less",
)

# excitation.py

NARROW = decides(
    0.2,
    "part of its frequency",
    "by which a force of one frequency spreads in a window, and between windows",
    why="a drive whose speed sags moves by less, a sweep by more",
)
