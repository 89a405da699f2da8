"""Which numbers a model may hold: those whose squares, cubes and reciprocals are numbers of double precision."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

from ..errors import BadInput
from ..files.arguments import shown

#: Largest number of a model, whatever its unit: squares and cubes of it are still numbers ...
MOST = 1e100
#: ... and smallest of what a model divides by, its mass and frequency.
LEAST = 1.0 / MOST
#: Characters of a name that a model file may hold: those of the name of a file.
LONGEST_NAME = 255
#: What a model divides by.
POSITIVE = ("mass", "omega0")


def plain_number(name: str, value: Any) -> float:
    """A parameter's value as a float, of any size, as a search may meet it; raises BadInput where it is no number."""
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()  # of numpy
    if isinstance(value, bool) or not isinstance(value, Real):
        raise BadInput(f"parameter {name!r} must be a plain number such as 4.6e5, not {shown(value)}")
    try:
        return float(value)
    except OverflowError:
        return math.inf


def checked_value(name: str, value: Any, lower: float = -math.inf, upper: float = math.inf) -> float:
    """The value of a parameter as a float.

    Args:
        name: of the parameter; one of POSITIVE must be above zero.
        value: a plain number.
        lower, upper: its law's bounds.

    Raises:
        BadInput: it is none, is not finite, is beyond MOST, or lies outside.
    """
    number = plain_number(name, value)
    if not abs(number) <= MOST:
        raise BadInput(f"parameter {name!r} is {number:g}; it must be a finite number of at most {MOST:g}")
    if name in POSITIVE and not number > 0:
        raise BadInput(f"parameter {name!r} must be greater than 0, not {number:g}")
    if name in POSITIVE and number < LEAST:
        raise BadInput(f"parameter {name!r} must not be below {LEAST:g}, but is {number:g}; check its unit")
    if not lower <= number <= upper:
        raise BadInput(f"parameter {name!r} must lie between {lower:g} and {upper:g}, but is {number:g}")
    return number
