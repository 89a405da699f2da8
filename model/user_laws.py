"""Laws of a user's own: a Python file that defines one or more ``Law`` objects, taken into the library.

The file is a program and is run. What it defines is checked as strictly as the laws that come with the package, so that
a slip is said here with its line and not met in the middle of a fit.
"""

from __future__ import annotations

import math
import os
import re
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from ..errors import BadInput
from ..files.reading import content_of
from .law import Law, LawParameter, Motion, Scales
from .law_trial import fault, wrong_types
from .laws import BASE, LIBRARY

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
#: No file of laws is longer.
_MOST_BYTES = 4_000_000
_NAME = re.compile(r"[a-z][a-z0-9-]*(/[a-z0-9-]+)?")
#: Words that can stand in a list, with the law's name in brackets behind them; empty where the sentence is to serve.
_PHRASE = r"(?:[^\s.,;:()]+(?: [^\s.,;:()]+)*)?"
_PARAMETER = re.compile(r"[a-z][a-z0-9-]*")
_SYMBOLS = {"X", "Q", "Y", "s", "rad", "1"}
_SCALES = Scales(length=1e-2, omega=50.0, force=1.0, response=1e-2, duration=10.0, mass=1.0, lines=(30.0,))
#: The laws that were loaded, by the file they came from, with the text it had.
_loaded: dict[str, tuple[str, tuple[Law, ...]]] = {}


def load_law_file(path: str | os.PathLike[str]) -> tuple[Law, ...]:
    """Run a file that defines laws, and take them into the library.

    A file that was loaded before is not run again.

    Args:
        path: of a Python file; every ``Law`` among its module's names counts.

    Returns:
        The laws, in the order of definition.

    Raises:
        BadInput: the file cannot be read or run, defines no law, or one whose name is taken, that lacks something, or
            whose expression cannot be made; nothing is then taken into the library.
    """
    where = os.fspath(path)
    try:
        text = content_of(path, _MOST_BYTES).decode("utf-8-sig")
        key = os.fspath(Path(path).resolve())
    except UnicodeDecodeError:
        raise BadInput(f"{where}: is not UTF-8 text, so no Python file; give one that defines a Law") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise BadInput(f"{where}: cannot be read ({reason}); check the path") from None
    if key in _loaded:
        before, laws = _loaded[key]
        if before != text:
            raise BadInput(f"{where}: was loaded before with another text; start Python again to use the new one")
        return laws
    laws = tuple(_defined(_run(text, where)))
    if not laws:
        raise BadInput(f"{where}: defines no Law; write LAW = Law(name=..., ...) as docs/laws.md shows")
    take(laws, where)
    _loaded[key] = (text, laws)
    return laws


def take(laws: tuple[Law, ...], where: str) -> None:
    """Take laws into the library; raises BadInput as above, ``where`` in it, and then takes none."""
    taken = {law.name for law in BASE} | set(LIBRARY)
    for law in laws:
        if wrong := next(wrong_types(law), None):
            raise BadInput(f"{where}: law {law.name!r:.60}: {wrong}")
        if law.name in taken:
            raise BadInput(f"{where}: law {law.name!r}: there is one of that name already; choose another name")
        taken.add(law.name)
        faults = list(problems(law))
        if faults:
            raise BadInput(f"{where}: law {law.name!r}: {faults[0]}")
    LIBRARY.update({law.name: law for law in laws})
    try:
        for law in laws:
            _try(law, where)
    except BadInput:
        for law in laws:
            del LIBRARY[law.name]
        raise


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
    from .units import factors

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
        yield f"its size cannot be computed ({_said(error)}); give a function of the scales, or leave it out"
        return
    if not (math.isfinite(size) and size > 0):
        yield f"its natural size comes out as {size:g}; it must be a positive number"


def _run(text: str, where: str) -> ModuleType:
    module = ModuleType(f"dashpot_law_{re.sub(r'[^A-Za-z0-9_]', '_', Path(where).stem)}")
    module.__file__ = where
    try:
        code = compile(text, where, "exec")
    except (SyntaxError, ValueError) as error:  # ValueError: null bytes
        line = getattr(error, "lineno", None)
        said = getattr(error, "msg", None) or str(error)
        raise BadInput(f"{where}{f', line {line}' if line else ''}: not Python ({said}); correct it") from None
    try:
        exec(code, module.__dict__)  # the user's own program, named on the command line
    except (Exception, SystemExit) as error:
        raise BadInput(f"{where}{_line(error, where)}: {_said(error)}; correct the file") from error
    return module


def _defined(module: ModuleType) -> Iterator[Law]:
    """Every law among the module's names, once, but those of the library."""
    seen = {id(law) for law in (*BASE, *LIBRARY.values())}
    for value in list(vars(module).values()):
        if isinstance(value, Law) and id(value) not in seen:
            seen.add(id(value))
            yield value


def _try(law: Law, where: str) -> None:
    """Make the expression once, alone and with everything that stands around it."""
    import casadi as ca

    from .equations import equations
    from .oscillator import Oscillator

    own = {p.name: ca.SX.sym(p.name) for p in law.parameters}
    motion = Motion(x=ca.SX.sym("x"), v=ca.SX.sym("v"), t=ca.SX.sym("t"))
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
        equations(Oscillator.from_values(values, effects=(law.name,)))
    except BadInput as problem:
        raise BadInput(f"{where}: law {law.name!r}: {problem}") from None
    except Exception as error:
        raise BadInput(f"{where}{_line(error, where)}: law {law.name!r}: {_said(error)}; correct the file") from error


def _line(error: BaseException, where: str) -> str:
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == where]
    return f", line {lines[-1]}" if lines else ""


def _said(error: BaseException) -> str:
    words = " ".join(str(error).split()).rstrip(".")
    return f"{type(error).__name__}: {words[:200]}" if words else type(error).__name__
