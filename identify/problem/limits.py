"""The numbers that decide what is fitted, and over which samples: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides, numerics

# segments.py, and whatever takes part of a recording by itself

FEWEST_SWINGS = decides(
    10.0,
    "cycles",
    "of how many a stretch alone says what its rig is",
    why="fewer do not tell viscous damping from friction",
)
WORTH_ITS_START = decides(
    3.0,
    "cycles",
    "of how many a stretch says more than the two initial values that it costs",
    why="one tells its initial state, two are foretold",
)
WORTH_A_SLIDE = decides(
    1.0, "cycles", "the same of a slide, whose motion is not its own", why="a cycle of it has an amplitude and a phase"
)
NEAR_ITS_OWN = decides(
    2.0,
    "times the natural frequency",
    "up to which a driven motion is paced by its rig and not by its force",
    why="an octave above, a mass moves by a third of its static displacement",
)

# descent.py, and every other search that asks whether a step was worth its direction

KEPT_PROMISE = decides(
    0.25,
    "part of what it promised",
    "that a step must keep to be of a straight valley",
    why="a quarter, as trust-region methods have it (Nocedal and Wright 2006, section 4.1)",
)

# jumps.py

DISAGREE = decides(
    0.3,
    "part of the largest effect of any parameter there",
    "by how much forward and backward differences and the tangent disagree that are no derivative",
    why="a third: half of a jump within the cycle",
)
FALSE_INFORMATION = decides(
    0.01,
    "part of the information on each parameter",
    "that jumps may hold where a stretch is too short to be cut",
    why="no standard error is then off by more than half of it",
)

# last_swings.py

STANDS_OUT = decides(
    0.5,
    "times the noise",
    "beyond which the last swings of a decay stand out of it",
    why="by the tens of samples that a cycle has",
)

# rounding.py

DITHERS = decides(
    0.5,
    "steps of the converter",
    "of noise that makes the error of rounding white",
    why=(
        "physical limit: its mean over a cycle is then exp(-2 pi²/4) = 0.7 % of what it is without noise (Widrow and "
        "Kollar 2008, chapter 19)"
    ),
)

# structure.py

FENCE = decides(
    10.0,
    "times where a law is looked for",
    "beyond which its onset or speed has left the recordings",
    why="a decade beyond, nothing of its bend is left in them",
)
SLACK = decides(
    0.1,
    "rad in the longest recording",
    "what a spring must turn the phase by to be one",
    why="less is within the error of a phase",
)

# what several files share

FEWEST_SAMPLES = numerics(8, "samples", why="of a beginning: two initial values, as many again for what they leave")
ROUNDED = numerics(1e-9, "part of the motion", why="noise below this is rounding")
