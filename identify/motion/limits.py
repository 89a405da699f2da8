"""The numbers that decide where the motion is free: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides

# decays.py

TAKES = decides(
    0.9,
    "part of what an envelope takes",
    "whether the modes of a linear rig explain the motion",
    why="the ends of either are that vague; what leaves out more is the small end of a motion that glides",
)

# shared_modes.py

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
BEYOND = decides(
    2.0,
    "standard deviations",
    "beyond which a block mean at an edge is something else's",
    why="error rate: likelier than not, where a motion begins as often as it goes on",
)
