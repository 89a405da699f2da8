"""The numbers that decide what is fitted to a prescribed motion: unit, what, and why."""

from __future__ import annotations

from ..identify.signals.registry import decides

STANDS = decides(
    3.0,
    "standard errors of the speed",
    "below which a prescribed motion stands still, and dry friction says nothing there",
    why="error rate: the sign of a speed that noise makes is none of the motion",
)
FEWEST_CYCLES = decides(
    6.0,
    "cycles",
    "of a motion whose last third is held out where the user holds out nothing",
    why="two thirds then hold four cycles, as many as a mismatch is judged in, and the third two",
)
MIDDLE = decides(
    0.5,
    "part of the stroke's half",
    "within which the recorded zero is the one that the laws count from",
    why="a machine centred by hand is off by less; a file that counts from an end of the stroke is off by all of it",
)
