"""Unit strings such as ``1/(m2.s2)``: checked, compared, and taken apart into SI base exponents.

The notation is that of the model file: a product of symbols with integer exponents written behind them,
``.`` between factors, at most one ``/``, ``1`` for a pure number.
"""

from __future__ import annotations

import re
from collections import Counter
from functools import cache

from ..errors import BadInput

#: SI base exponents of the symbols that carry a dimension (FMI 2.0.5, section 2.2.2, names the same bases).
SYMBOLS: dict[str, dict[str, int]] = {
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "A": {"A": 1},
    "K": {"K": 1},
    "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "Hz": {"s": -1},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "strain": {},
    "1": {},
}

#: Templates of energy and power, see ``compose``.
ENERGY, POWER = "Q.X", "Q.X/s"
#: Symbols of a force in N along m, or of a moment in N.m about rad (dropped by custom), and of their power.
_OF_WORK = {"N", "m", "rad", "s"}

_FACTOR = re.compile(r"([A-Za-z]+|1)(-?\d+)?$")


@cache
def factors(unit: str) -> dict[str, int]:
    """Symbols of ``unit`` with their exponents, without resolving them into base units.

    Raises BadInput when the text is not in the notation; a symbol that SI does not know is allowed
    (a recording may be in counts), it simply carries no dimension.
    """
    above, slash, below = unit.strip().partition("/")
    exponents: Counter[str] = Counter()
    for part, sign in ((above, 1), (below, -1)):
        if sign == -1 and not slash:
            continue
        text = part.removeprefix("(").removesuffix(")") if part.startswith("(") else part
        for factor in text.split("."):
            match = _FACTOR.match(factor)
            if not match:
                raise BadInput(f"unit {unit!r}: cannot read {factor!r}; write it like 1/(m2.s2) or m/s2")
            symbol, exponent = match.group(1), int(match.group(2) or 1)
            if symbol != "1":
                exponents[symbol] += sign * exponent
    return {symbol: exponent for symbol, exponent in exponents.items() if exponent}


def base_exponents(unit: str) -> dict[str, int]:
    """SI base exponents of ``unit``, for FMI's ``BaseUnit``; unknown symbols count as pure numbers."""
    total: Counter[str] = Counter()
    for symbol, exponent in factors(unit).items():
        for base, power in SYMBOLS.get(symbol, {}).items():
            total[base] += exponent * power
    return {base: power for base, power in total.items() if power}


def same(left: str, right: str) -> bool:
    """Whether two unit texts mean the same product of symbols."""
    return factors(left) == factors(right)


def render(exponents: dict[str, int]) -> str:
    """Text of a product of symbols, in the model file's notation."""

    def product(items: list[tuple[str, int]]) -> str:
        return ".".join(symbol + (str(power) if power != 1 else "") for symbol, power in items)

    above = [(symbol, power) for symbol, power in exponents.items() if power > 0]
    below = [(symbol, -power) for symbol, power in exponents.items() if power < 0]
    if not below:
        return product(above) or "1"
    text = product(below)
    return f"{product(above) or '1'}/{f'({text})' if len(below) > 1 else text}"


def compose(template: str, displacement: str, force: str = "N", response: str | None = None) -> str:
    """A parameter's unit for a given response.

    ``X`` in the template is the displacement's unit, ``Q`` the force's, ``Y`` that of the recorded signal (the
    displacement's where not given): ``compose("1/(X2.s2)", "m")`` is ``1/(m2.s2)``, ``compose("Q.s2/X", "m")`` ``kg``,
    ``compose(ENERGY, "m")`` ``J``.
    """
    meaning = {"X": displacement, "Q": force, "Y": response or displacement}
    total: Counter[str] = Counter()
    for symbol, exponent in factors(template).items():
        for inner, power in factors(meaning[symbol]).items() if symbol in meaning else [(symbol, 1)]:
            total[inner] += exponent * power
    exponents = {symbol: power for symbol, power in total.items() if power}
    if template in (ENERGY, POWER) and exponents.get("N") == exponents.get("m") == 1 and exponents.keys() <= _OF_WORK:
        return "J" if template == ENERGY else "W"  # not by the exponents alone: a moment is in N.m too
    if exponents == {"N": 1, "s": 2, "m": -1}:
        return "kg"
    if exponents == {"N": 1, "m": 1, "s": 2, "rad": -1}:
        return "kg.m2"  # a moment over an angular acceleration; the radian is dropped by custom
    return render(exponents)
