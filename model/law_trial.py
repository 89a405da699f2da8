"""What a law of a user or a package must keep to: words, types, given symbols, located kinks, finite values, units."""

from __future__ import annotations

import math
import re
import traceback
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Any

from ..errors import BadInput
from .equations import equations
from .law import Expression, Law, LawParameter, Motion, Scales
from .laws import BASE
from .oscillator import Oscillator
from .units import factors

#: Where in the rig a law may live.
PATHS = (
    "restoring",
    "dissipation",
    "memory",
    "inertia",
    "excitation",
    "measurement",
    "either",
    "environment",
)
_NAME = re.compile(r"[a-z][a-z0-9-]*(/[a-z0-9-]+){0,2}")
#: Words that can stand in a list, with the law's name in brackets behind them; empty where the sentence is to serve.
_PHRASE = r"(?:[^\s.,;:()]+(?: [^\s.,;:()]+)*)?"
_PARAMETER = re.compile(r"[a-z][a-z0-9-]*")
_SYMBOLS = {"X", "Q", "Y", "s", "rad", "1"}
_SCALES = Scales(length=1e-2, omega=50.0, force=1.0, response=1e-2, duration=10.0, mass=1.0, lines=(30.0,))
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


def problems(law: Law) -> Iterator[str]:
    """What a law lacks to be found, fitted and shown, one sentence each."""
    if not isinstance(law.name, str) or not _NAME.fullmatch(law.name):
        yield "name must be of small letters, digits and hyphens, like my-effect or my-effect/variant"
    if law.path not in PATHS:
        yield f"path {law.path!r} is not known; use one of {', '.join(PATHS)}"
    if sum(made is not None for made in (law.force, law.drive, law.record)) != 1:
        yield "give one of force, drive and record"
    elif law.stored is not None and law.force is None:
        yield "stored is the energy of a force, which it has none of; leave it out"
    for field in ("equation", "sentence", "source"):
        if not isinstance(text := getattr(law, field), str) or not text.strip():
            yield f"{field} is empty; write what a reader of the report needs"
    if not isinstance(law.phrase, str) or not re.fullmatch(_PHRASE, law.phrase):
        yield (
            f'phrase {law.phrase!r} cannot stand in a list; write a few words such as "a stop on one side", in one '
            "line without comma, semicolon, colon, brackets and full stop, or leave it out"
        )
    names = [p.name for p in law.parameters]
    if not names:
        yield "it has no parameters; give a LawParameter for each number that is to be identified"
    for name in names:
        if names.count(name) > 1:
            yield f"two parameters are called {name!r}; choose another name"
    for name in dict.fromkeys(re.findall(r"\{([^{}]*)\}", str(law.equation))):
        if name not in names:
            yield f"equation has {{{name}}}, which is no parameter; put parameters' names in braces, and nothing else"
    for p in law.parameters:
        yield from (f"parameter {p.name!r}: {sentence}" for sentence in _parameter_problems(p, str(law.equation)))


def _parameter_problems(p: LawParameter, equation: str) -> Iterator[str]:
    if not _PARAMETER.fullmatch(p.name):
        yield "its name must be of small letters, digits and hyphens"
    if f"{{{p.name}}}" not in equation:
        yield f"equation does not show it; write {{{p.name}}} where it stands"
    if not p.description.strip():
        yield "description is empty; say what it is"
    try:
        unknown = set(factors(p.unit)) - _SYMBOLS
        if unknown:
            yield (
                f"unit {p.unit!r} has {', '.join(sorted(unknown))}; write it with X for the displacement's unit, "
                "Q for the force's, Y for the recorded signal's, s and rad"
            )
            return
    except BadInput as problem:
        yield str(problem)
        return
    if not p.lower < p.upper:
        yield f"its bounds {p.lower:g} and {p.upper:g} hold nothing; give lower below upper"
    if not (p.strength or p.probes):
        yield "give probes, the values at which to look for it first, or strength=True"
    try:
        size = float(p.natural(_SCALES))
    except Exception as error:  # the user's own function
        yield f"its size cannot be computed ({said(error)}); give a function of the scales, or leave it out"
        return
    if not (math.isfinite(size) and size > 0):
        yield f"its natural size comes out as {size:g}; it must be a positive number"


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

    given = [motion.x, motion.v, motion.t, signal, motion.a if isinstance(motion.a, ca.SX) else ca.SX.sym("a")]
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
            at.append(-x * scales.length * scales.omega**2)
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
    import numpy as np

    random = np.random.default_rng(0)
    main = "X/s2" if law.force else "Q" if law.drive else "Y"
    inner = [state.unit for state in motion.states]
    for symbol, meaning in _COUNTED.items():

        def size(unit: str, symbol: str = symbol) -> float:
            return float(_OTHERWISE ** factors(unit).get(symbol, 0))

        by = np.array([size("X"), size("X/s"), size("s"), size("Q" if law.drive else "Y"), size("X/s2")])
        parameters, states = np.array([size(p.unit) for p in law.parameters]), np.array([size(u) for u in inner])
        wanted = np.array([size(main), *(states / size("s")), *([size("X2/s2")] if stored else [])])
        names = ["it", *(f"the rate of its state {state.name!r}" for state in motion.states), "what it has stored"]
        for _ in range(_POINTS):
            at = random.uniform(-1.0, 1.0, 5)
            at *= [scales.length, scales.length * scales.omega, scales.duration, scales.response, 1.0]
            at[4] *= scales.length * scales.omega**2
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


def trial(law: Law, where: str) -> None:
    """Make the expression alone and within Eq. 17; raises BadInput with ``where`` and its line there if that fails."""
    import casadi as ca

    own = {p.name: ca.SX.sym(p.name) for p in law.parameters}
    motion = Motion(x=ca.SX.sym("x"), v=ca.SX.sym("v"), t=ca.SX.sym("t"), a=ca.SX.sym("a"))
    values = {p.name: 1.0 for base in BASE for p in base.parameters}
    values |= {"mass": 1.0, **{f"{law.name}.{p.name}": p.natural(_SCALES) for p in law.parameters}}
    try:
        made: Any = law.force or law.drive or law.record
        signal = ca.SX.sym("signal")
        results = [ca.SX(made(motion, own) if law.force else made(motion, own, signal))]
        rateless = [s.name for s, rate in zip(motion.states, motion.rates, strict=True) if rate is None]
        results += [ca.SX(law.stored(motion, own))] if law.stored else []
        for result in results:
            if not result.is_scalar():
                raise BadInput(f"it gives {result.shape[0]} by {result.shape[1]} numbers; return a single expression")
        if rateless:
            raise BadInput(f"its state {rateless[0]!r} has no rate; call motion.rate(state, expression)")
        stored = results[1] if law.stored else None
        if wrong := fault(law, motion, own, signal, results[0], _SCALES, stored):
            raise BadInput(wrong)
        equations(Oscillator.from_values(values, laws=(law,)))
    except BadInput as problem:
        raise BadInput(f"{where}: law {law.name!r}: {problem}") from None
    except Exception as error:
        raise BadInput(f"{where}{line_of(error, where)}: law {law.name!r}: {said(error)}; correct the file") from error


def line_of(error: BaseException, where: str) -> str:
    """``, line N`` of the file ``where`` that an error came from; empty where none is known."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == where]
    return f", line {lines[-1]}" if lines else ""


def said(error: BaseException) -> str:
    """An error of another's program for a sentence: its kind and its first 200 characters."""
    words = " ".join(str(error).split()).rstrip(".")
    return f"{type(error).__name__}: {words[:200]}" if words else type(error).__name__
