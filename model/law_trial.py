"""What a user's own law must keep to beyond its words: types, given symbols, located kinks, finite values, units."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from .law import Expression, Law, LawParameter, Motion, Scales
from .units import factors

_TEXTS = ("name", "path", "equation", "sentence", "source", "curves")
_FUNCTIONS = ("force", "stored", "drive", "record", "proper")
#: CasADi's operations with a kink or a jump, as a law writes them.
_KINKS = {
    "SIGN": "sign",
    "FABS": "abs",
    "FMIN": "fmin",
    "FMAX": "fmax",
    "FLOOR": "floor",
    "CEIL": "ceil",
    "FMOD": "fmod",
    "REMAINDER": "remainder",
    "COPYSIGN": "copysign",
    "LT": "a comparison",
    "LE": "a comparison",
    "EQ": "a comparison",
    "NE": "a comparison",
    "IF_ELSE_ZERO": "if_else",
}


#: What a unit of a law is made of, for a user; and by how much each is counted otherwise, to see whether that matters.
_COUNTED = {"X": "displacement", "Q": "force", "Y": "recorded signal", "s": "time"}
_OTHERWISE = 1.7
#: Numbers that differ by less than this part of themselves are the same but for rounding.
_SAME = 1e-6
_POINTS = 20


def wrong_types(law: Law) -> Iterator[str]:
    """Fields that hold something of another kind than they are for, one sentence each."""
    for field in _TEXTS:
        if not isinstance(value := getattr(law, field), str):
            yield f"{field} is {value!r:.60}; give a text"
    for field in _FUNCTIONS:
        if (value := getattr(law, field)) is not None and not callable(value):
            yield f"{field} is {value!r:.60}; give a function"
    if not isinstance(law.parameters, (tuple, list)):
        yield f"parameters is {law.parameters!r:.60}; give a tuple of LawParameter, with a comma behind a single one"
        return
    for p in law.parameters:
        if not isinstance(p, LawParameter):
            yield f"parameters holds {p!r:.60}; give a LawParameter for each"
            continue
        for field in ("name", "unit", "description"):
            if not isinstance(value := getattr(p, field), str):
                yield f"parameter {p.name!r:.60}: {field} is {value!r:.60}; give a text"
        for field in ("lower", "upper"):
            if not _number(value := getattr(p, field)):
                yield f"parameter {p.name!r:.60}: {field} is {value!r:.60}; give a number"
        if p.probes != "lines" and not (isinstance(p.probes, (tuple, list)) and all(map(_number, p.probes))):
            yield f"parameter {p.name!r:.60}: probes is {p.probes!r:.60}; give a tuple of numbers, or 'lines'"
        if p.in_radians is not None and not _number(p.in_radians):
            yield f"parameter {p.name!r:.60}: in_radians is {p.in_radians!r:.60}; give a number, or leave it out"
        if p.size is not None and not callable(p.size):
            yield f"parameter {p.name!r:.60}: size is {p.size!r:.60}; give a function of the scales, or leave it out"


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and not math.isnan(value)


def fault(
    law: Law,
    motion: Motion,
    own: dict[str, Expression],
    signal: Expression,
    made: Expression,
    scales: Scales,
    stored: Expression | None = None,
) -> str:
    """What is wrong with the expression that a law made, in a sentence; empty where nothing is.

    Args:
        law: whose it is.
        motion: that it was made of, with what the law asked for.
        own: symbols of the law's parameters by name.
        signal: the symbol of the force or the recorded signal.
        made: the expression.
        scales: of the motion that it is tried in.
        stored: the energy that it made, if any.
    """
    import casadi as ca

    given = [motion.x, motion.v, motion.t, signal]
    energy = [] if stored is None else [stored]
    results = ca.SX(ca.vertcat(made, *motion.rates, *energy, *motion.surfaces))
    inputs = [ca.SX(ca.vertcat(*part)) for part in (given, own.values(), motion.symbols, motion.signs)]
    known = {symbol.element_hash() for part in inputs for symbol in ca.symvar(part)}
    free = [str(symbol) for symbol in ca.symvar(results) if symbol.element_hash() not in known]
    if free:
        return f"its expression holds {free[0]!r}, which nothing gives a value; use motion, p and motion.state alone"
    function = ca.Function("law", inputs, [results])
    if kink := _kink(function):
        return (
            f"its expression has {kink} of the motion, which is located by nothing; write it with motion.sign(surface) "
            "or motion.beyond(surface)"
        )
    typical = [_typical(p, scales) for p in law.parameters]
    for values in [typical, *_at_bounds(law.parameters, typical)]:
        for x, v, t, s, sign in product((0.0, 1.0, -1.0), (0.0, 1.0, -1.0), (0.0, 1.0), (0.0, 1.0, -1.0), (1.0, -1.0)):
            at = [x * scales.length, v * scales.length * scales.omega, t * scales.duration, s * scales.response]
            numbers = function(at, values, [0.0] * len(motion.symbols), [sign] * len(motion.signs))
            if not all(math.isfinite(number) for number in ca.DM(numbers).full().ravel()):
                shown = ", ".join(f"{p.name} = {value:g}" for p, value in zip(law.parameters, values, strict=True))
                return (
                    f"it gives no finite number at x = {at[0]:g}, v = {at[1]:g}, t = {at[2]:g} with {shown}; write it "
                    "so that it does within its bounds, or narrow these"
                )
    return _wrong_unit(law, motion, function, typical, scales, stored=stored is not None)


def _at_bounds(parameters: Sequence[LawParameter], typical: Sequence[float]) -> Iterator[list[float]]:
    """The typical values with one of them at a bound, where a fit may come to rest."""
    for i, p in enumerate(parameters):
        for bound in (p.lower, p.upper):
            if math.isfinite(bound):
                yield [*typical[:i], float(bound), *typical[i + 1 :]]


def _wrong_unit(
    law: Law, motion: Motion, function: Callable[..., Any], values: Sequence[float], scales: Scales, *, stored: bool
) -> str:
    """What does not come out in its unit, in a sentence; empty where all does.

    A law knows no unit, so counting in another one must change what it gives as much as that one's unit says.
    """
    random = np.random.default_rng(0)
    main = "X/s2" if law.force else "Q" if law.drive else "Y"
    inner = [state.unit for state in motion.states]
    for symbol, meaning in _COUNTED.items():

        def size(unit: str, symbol: str = symbol) -> float:
            return float(_OTHERWISE ** factors(unit).get(symbol, 0))

        by = np.array([size("X"), size("X/s"), size("s"), size("Q" if law.drive else "Y")])
        parameters, states = np.array([size(p.unit) for p in law.parameters]), np.array([size(u) for u in inner])
        wanted = np.array([size(main), *(states / size("s")), *([size("X2/s2")] if stored else [])])
        names = ["it", *(f"the rate of its state {state.name!r}" for state in motion.states), "what it has stored"]
        for _ in range(_POINTS):
            at = random.uniform(-1.0, 1.0, 4)
            at *= [scales.length, scales.length * scales.omega, scales.duration, scales.response]
            hidden = scales.length * random.uniform(-1.0, 1.0, len(inner))
            signs = random.choice([1.0, -1.0], len(motion.signs))
            given = np.array(function(at, values, hidden, signs)).ravel()[: wanted.size] * wanted
            counted = np.array(function(at * by, values * parameters, hidden * states, signs)).ravel()[: wanted.size]
            wrong = np.abs(counted - given) > _SAME * np.maximum(np.abs(counted), np.abs(given))
            if np.any(wrong & np.isfinite(counted) & np.isfinite(given)):
                return (
                    f"{names[int(np.argmax(wrong))]} does not come out in its unit: counted in another unit of the "
                    f"{meaning}, it is another law; check the parameters' units, and give each number that has a unit "
                    "a LawParameter"
                )
    return ""


def _typical(p: LawParameter, scales: Scales) -> float:
    probe = p.probes[len(p.probes) // 2] if p.probes and p.probes != "lines" else 1.0
    value = float(probe) * (scales.lines[0] if p.probes == "lines" else p.natural(scales))
    return min(max(value, p.lower), p.upper)


def _kink(function: Expression) -> str:
    """The first operation with a kink whose argument depends on the function's first input; empty: none."""
    import casadi as ca

    kinks = {getattr(ca, f"OP_{name}"): words for name, words in _KINKS.items() if hasattr(ca, f"OP_{name}")}
    moves: dict[int, bool] = {}
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        read, written = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            continue
        if operation == ca.OP_INPUT:
            moving = read[0] == 0
        else:
            moving = operation != ca.OP_CONST and any(moves.get(place, False) for place in read)
            if moving and operation in kinks:
                return kinks[operation]
        moves[written[0]] = moving
    return ""
