"""The numbers that decide what noise, spectra and analytic signals are: unit, what, and why."""

from __future__ import annotations

from .registry import budget, decides, numerics

# signals.py

SILENT = decides(
    0.7,
    "part of the standard deviation",
    "from which on white noise is all that is in a signal",
    why="half of the power: what is left is as likely noise as signal",
)

# whatever compares several

SEVERAL = decides(
    3,
    "decays or recordings",
    "of how many a spread means something, or one is odd",
    why="of two neither is the odd one",
)

# whatever clips

FLAT = decides(3, "equal samples", "at the top of a swing or a blow that no noise makes", why="two are common")

# weakform.py, and the regressions that use its windows

CLEAR_OF_NOISE = decides(
    5.0,
    "times the noise",
    "what stands clear of it, in a window or a sample",
    why="error rate: noise alone gets there once in two million",
)
RESTING = decides(
    0.02,
    "part of a window",
    "how much of it may rest for its friction to be told",
    why="friction at rest takes any value; a fiftieth of it is within the noise of a window",
)
ROUNDING = numerics(1e-6, "part of the standard deviation", why="noise below this is rounding")
WINDOW_CYCLES = numerics(
    8.0, "cycles", why="the length of a window: the resonance and its neighbours are lines of their own"
)
BELOW_NYQUIST = numerics(0.45, "of the sampling frequency", why="above, a recorder's filter has taken what there was")
WEIGHING_ROUNDS = budget(4, "rounds", why="the weights need the parameters: each round squares what is left")
SHORTEST_PERIOD = numerics(5, "samples", why="the fewest that a cycle or a span of a filter has")

# hilbert.py

FEWEST_CYCLES = decides(
    5,
    "cycles",
    "how many the Hilbert transform needs, and how many samples each of them",
    why="two on either side lean on the continuation of the ends",
)
DECAY_FLOOR = decides(
    3, "times the quietest cycle", "where a decay or a force has ended", why="the noise is then a tenth of the power"
)
DECAY_PART = decides(
    0.02,
    "part of the largest",
    "below which a motion or a blow has ended, or is held",
    why="four time constants of a decay: a rate is known from them",
)
DECAY_CYCLES = decides(
    4,
    "cycles",
    "of how many a decay is told, and which part of a record may go before it",
    why="a line through fewer says little",
)
