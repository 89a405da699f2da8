"""A number with its unit as a person says it, ``0.15 N`` or ``1.7 kN/m``, in the unit that is wanted."""

from __future__ import annotations

import math
import re
from collections import Counter

from ..errors import BadInput
from ..files.arguments import number_of
from . import units

_SAID = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
_PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6}
#: Symbols of a person's that are no symbol of the model file's with a prefix.
_OTHERS = {
    "g": (1e-3, "kg"),
    "deg": (math.pi / 180.0, "rad"),
    "um": (1e-6, "m"),
    "in": (0.0254, "m"),
    "ft": (0.3048, "m"),
    "mil": (2.54e-5, "m"),
}
_PLAIN = str.maketrans({"µ": "u", "μ": "u", "·": ".", "*": ".", "^": "", "²": "2", "³": "3", "⁵": "5", "−": "-"})


def said(text: str, what: str) -> tuple[float, str]:
    """Number and unit of a text; raises BadInput where it does not begin with a number. ``what`` begins the message."""
    found = _SAID.fullmatch(text)
    if found is None:
        raise BadInput(f"{what} is {text[:40]!r}; give a number, or a text such as '0.15 N'")
    return float(found[1]), found[2]


def plain(given: float | str, what: str) -> float:
    """A number as it is, a text with a unit in SI; raises BadInput where the text is none."""
    if not isinstance(given, str):
        return float(given)
    number, unit = said(given, what)
    return number * (in_base_units(unit, what)[0] if unit else 1.0)


def in_unit(given: float | str, unit: str, what: str) -> float:
    """A number in ``unit``, as such or as a text with a unit of its own; raises BadInput for another."""
    if not isinstance(given, str):
        return number_of(given, what)
    number, own = said(given, what)
    found = converted(number, own, unit, what) if own else number
    if found is None:
        raise BadInput(f"{what} is {given!r}, and {own} is no unit of it; give it in {unit}")
    return found


def in_base_units(unit: str, what: str) -> tuple[float, dict[str, int]]:
    """Factor to SI and base exponents of a unit that may have prefixes; raises BadInput where a symbol is not known."""
    text = re.sub(r"\s+", ".", unit.strip().translate(_PLAIN).replace("**", ""))
    text = re.sub(r"\.?([/()])\.?", r"\1", text)
    factor, total = 1.0, Counter()
    for symbol, power in units.factors(text).items():
        size, plain = _symbol(symbol, f"{what}: {unit!r}")
        factor *= size**power
        for base, exponent in units.SYMBOLS[plain].items():
            total[base] += exponent * power
    return factor, {base: power for base, power in total.items() if power}


def _symbol(symbol: str, where: str) -> tuple[float, str]:
    """Size of a symbol in a symbol of the model file's."""
    if symbol in units.SYMBOLS:
        return 1.0, symbol
    if symbol in _OTHERS:
        return _OTHERS[symbol]
    prefix, rest = symbol[:1], symbol[1:]
    if prefix in _PREFIXES and rest in units.SYMBOLS:
        return _PREFIXES[prefix], rest
    raise BadInput(f"{where} has the unit {symbol!r}, which is not known; write such as N/m, kN, m/s2 or Hz")


def converted(number: float, unit: str, wanted: str, what: str) -> float | None:
    """The number in the ``wanted`` unit; None where that measures something else.

    A frequency in Hz is one in rad/s too. Raises BadInput where the unit cannot be read.
    """
    factor, have = in_base_units(unit, what)
    target, want = in_base_units(wanted, what)
    if have == want:
        return number * factor / target
    turns = {"rad": 1, "s": -1}
    if (have, want) == ({"s": -1}, turns):
        return number * factor * 2.0 * math.pi / target
    if (have, want) == (turns, {"s": -1}):
        return number * factor / (2.0 * math.pi) / target
    return None
