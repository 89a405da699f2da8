"""The numbers that decide what the measuring chain did and which recording disagrees: unit, what, and why."""

from __future__ import annotations

from ..signals.registry import decides

# contradiction.py

PROMISING = decides(
    0.1,
    "part of what is more than noise",
    "that one step without a part of a recording must leave for the part to be tried",
    why=("a large fault is no small step: the step sees a tenth of it, and more than a tenth is left of what is none"),
)
ALIKE = decides(
    1.1,
    "times",
    "by how much amplitude, force or frequency of two parts may differ that are alike",
    why=(
        "physical limit: a law of the third power that acts at some level is still there at one a tenth lower, by "
        "three quarters"
    ),
)

# part_kinds.py

PASSED = decides(
    2.0,
    "times the limit",
    "by how much a sensor that clips is not passed elsewhere",
    why="physical limit: a limit may drift, and not to twice itself",
)

# stranger_among.py

KEPT = decides(
    1e-3,
    "part of the natural frequency",
    "by which recordings of one rig differ",
    why="physical limit: a lab cannot keep it more constant (the modulus of steel falls by 0.03 % a kelvin)",
)

# without_part.py, back_emf.py

HALVED = decides(
    0.5,
    "part of what is more than noise",
    "that each step without a part must leave",
    why="what does not halve it in eight steps ends above the noise; so does a step with a damping of what is driven",
)
