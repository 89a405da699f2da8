"""The registry of numbers that decide, and of those that only look as if they did.

Each wing has a `limits.py` in which every number that decides what is fitted, found or named stands once, with its
unit, what it decides and why it has this value. `benchmarks/deciding_numbers.py` counts them, prints the table of
[limits.md](../../docs/limits.md), and fails where there are more than there were.

A number that changes no answer stays where it is used and says so: a ``budget`` changes how long an answer takes or how
many candidates are looked at, ``numerics`` are steps of differences, densities of grids and tolerances far below any
noise, and what is ``shown`` changes only what a reader sees.
"""

from __future__ import annotations

from typing import TypeVar

Value = TypeVar("Value")


def decides(value: Value, unit: str, what: str, *, why: str) -> Value:
    """A number that decides: the value itself.

    Args:
        value: a number, or several that are one limit.
        unit: of it, or what it is a part or a multiple of.
        what: it decides.
        why: it has this value.
    """
    return value


def budget(value: Value, unit: str, *, why: str) -> Value:
    """A number that limits effort: another one changes how long an answer takes, and not which it is."""
    return value


def numerics(value: Value, unit: str, *, why: str) -> Value:
    """A step, a density or a tolerance of a method, far from what could change an answer."""
    return value


def shown(value: Value, unit: str, *, why: str) -> Value:
    """A number of what is shown to a reader: how many words, samples, ranges."""
    return value
