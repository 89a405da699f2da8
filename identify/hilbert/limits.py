"""The numbers that decide what the Hilbert transform says of a recording: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides, numerics

# further_harmonics.py

MOST_SHIFT = decides(
    0.5,
    "rad",
    "of the instant at which a sign changes, that is still believed",
    why="beyond, the motion is all but at rest",
)

# modal_fit.py

LEAST_POINTS = decides(8, "points", "of how many a curve has laws fitted", why="five parameters and some more")

# modal_mass.py

LEAST_PAIRS = decides(30, "values", "of how many a mass is estimated", why="fewer have no spread to take an error from")

# modal_stretch.py

CUT_CYCLES = decides(
    2.0, "cycles", "cut from both ends of a stretch before it is low-passed", why="there the continuation still speaks"
)
LEAST_FREQUENCY = decides(
    0.75,
    "of the line that kernels are made for",
    "below which a motion is not followed",
    why="its negative frequency lies behind the first zero of both low-passes, where less than 1e-6 passes",
)
CLEAR = decides(
    20.0,
    "times its low-passed noise",
    "of a motion whose amplitude and phase follow the noise linearly",
    why="the second order is smaller by this factor",
)

# forced_regression.py

LOUD_PART = decides(
    0.3,
    "part of the largest amplitude",
    "where the motion says its frequency",
    why="a third: below, the beginning and the end of a pass differ from the resonance",
)
NEAR_FUNDAMENTAL = decides(
    0.4,
    "part of the frequency",
    "which lines are of the fundamental",
    why="half of the way to the next harmonic, and a window is left between",
)

# curves.py, freevib.py and static_force.py

CURVE_LEAST = decides(
    5, "points", "of how many a curve, or a column of a regression, is one", why="fewer do not tell a bend from noise"
)

# what several files share

KERNELS_A_VALUE = numerics(3.0, "kernels", why="the effective length of two kernels is a third of their joint length")
LEAST_NOISE = numerics(1e-9, "part of the largest amplitude", why="white noise below this is rounding")
