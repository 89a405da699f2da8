"""The numbers that decide from which values a fit starts: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides

# further_laws.py

MEMORY = decides(
    1.0,
    "cycles",
    "over which laws are told apart by prediction",
    why="over a cycle every start leads near its own place",
)

# linear_fit.py

MOST_DAMPING = decides(
    0.95,
    "part of the critical",
    "beyond which a linear start has no frequency",
    why="physical limit: what is fitted swings",
)

# measured_motion.py and fit/likeliest_modes.py

HALF = decides(
    0.5,
    "part of what can be gained",
    "that a law or a mode must promise to be tried, and a mode must foretell to be taken where more than noise is left",
    why="far from the truth a promise is of first order; what imitates a mode loses most where the motion is other",
)

# start.py

SAME_SPRING = decides(
    0.05,
    "part of the frequency",
    "by which two pictures of one spring differ at the same amplitude",
    why="the rest of what Eq. 6 leaves out is of the second order",
)
