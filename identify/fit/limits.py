"""The numbers that decide which minimum, which noise and which errors an answer has: unit, what, and why."""

from __future__ import annotations

from ..signals.odds import DECISIVE
from ..signals.registry import decides

# climb.py

POOR_NRMSE = decides(
    0.5,
    "part of the motion",
    "above which what a model leaves has not understood the recording",
    why="it then explains less than three quarters of the power",
)
QUIET = decides(
    0.01,
    "part of the loudest stretch",
    "below which the motion of a stretch is asked for nothing",
    why="a hundredth lies within what is lacking of the loudest",
)

# from_prediction.py

STRETCH = decides(
    8.0,
    "cycles",
    "in each of which a simulation keeps step that does so throughout",
    why="a quiet end is seen by itself, and the phase within a stretch is still one",
)

# hold.py

NEAR_HOLD = decides(
    0.5,
    "part of half a sample",
    "of a further lag or loss that does not speak against a hold",
    why="a quarter of a sample: what is nearer to this hold than to any other; converters and clocks are off by less",
)
MATTERS = decides(
    1.0,
    "standard errors",
    "by which a hold must move a parameter to matter",
    why="what moves none by its error changes no answer",
)
HOPELESS = decides(
    3.0 * DECISIVE,
    "log-likelihood",
    "by how much less likely than a smooth force, linearised, a hold is not fitted",
    why=(
        "odds: three times what is decisive; a steep resonance that a wrong mass has moved is not put back by a "
        "linear step"
    ),
)

# mismatch.py

CYCLES = decides(
    6.0,
    "cycles",
    "in what stretches of a mismatch are distinguished",
    why=(
        "physical limit: noise of a lightly damped rig under force noise keeps its phase for a few cycles (White 1982)"
    ),
)
HARMONICS = decides(
    5,
    "harmonics",
    "in which a stretch of a mismatch has an amplitude and a phase",
    why="physical limit: forces of a cubic and a quintic have three and five",
)

# identification.py

GAIN_RATIO = decides(
    300.0,
    "times",
    "by which the response per force of recordings differs that are not in the same units",
    why="half of a factor of a thousand, by logarithm and a bit: a resonance differs by less",
)
FREE_OF_FRICTION = decides(
    30.0,
    "times its noise",
    "that a response must have for its gain to be compared",
    why="a smaller one may be held by friction, and says nothing about the gain",
)

# identification.py

AMISS = decides(
    0.05,
    "part of a motion, beside its noise",
    "above which a remainder is bad news, where the user states no other",
    why="of a good rig in a laboratory Eq. 17 leaves one to four per cent, and its parameters are of use",
)
