"""The library of laws: those of the package, of installed packages and of users' files, found by their names.

A package says in its pyproject.toml where its laws are, as entry points of the group ``dashpot.laws``, and whoever
installs it has them by name everywhere: in model files, ``--with`` and diagnoses. They are loaded when a law is asked
for that is not known yet, or when all are.

Laws hold functions without a name, which Python cannot pickle. A law that the library knows is pickled by its name.
"""

from __future__ import annotations

import copyreg
import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.arguments import text_of
from .law import Law
from .law_trial import problems, trial, wrong_types
from .laws import BASE, FURTHER, LIBRARY
from .oscillator import Oscillator, Response

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "dashpot.laws"
#: Every further law by its name; ``take`` adds to it.
KNOWN: dict[str, Law] = dict(LIBRARY)


def find(effect: str) -> Law:
    """The law of that name, of the library or of an installed package; raises BadInput with the closest known names."""
    text_of(effect, "the name of a law")
    if effect in KNOWN or effect in FURTHER:
        return KNOWN.get(effect) or FURTHER[effect]
    wrong = take_installed_laws()
    if effect in KNOWN:
        return KNOWN[effect]
    close = difflib.get_close_matches(effect, [*KNOWN, *FURTHER], n=3, cutoff=0.4)
    known = f"did you mean {', '.join(close)}?" if close else f"known: {', '.join(sorted(KNOWN)) or 'none yet'}"
    raise BadInput("\n".join([f"effect {effect!r} is not in the library of laws; {known}", *wrong]))


def oscillator_with(
    values: Mapping[str, float],
    effects: Sequence[str],
    *,
    name: str = "oscillator",
    response: Response | None = None,
    force_unit: str = "N",
) -> Oscillator:
    """An oscillator from plain numbers as ``Oscillator.from_values``, its further effects by the names of their laws.

    Raises:
        BadInput: an effect is not in the library, or a parameter is missing or unknown.
    """
    laws = tuple(find(effect) for effect in effects)
    return Oscillator.from_values(values, name=name, response=response, force_unit=force_unit, laws=laws)


def take(laws: Sequence[Law], where: str) -> None:
    """Check laws and take them into the library.

    Args:
        laws: of one file or package.
        where: they come from, for messages.

    Raises:
        BadInput: a law's name is taken, a law lacks something, or its expression cannot be made; none is then taken.
    """
    taken = {law.name for law in BASE} | set(KNOWN) | set(FURTHER)
    for law in laws:
        if wrong := next(wrong_types(law), None):
            raise BadInput(f"{where}: law {law.name!r:.60}: {wrong}")
        if law.name in taken:
            raise BadInput(f"{where}: law {law.name!r}: there is one of that name already; choose another name")
        taken.add(law.name)
        faults = list(problems(law))
        if faults:
            raise BadInput(f"{where}: law {law.name!r}: {faults[0]}")
    for law in laws:
        trial(law, where)
    KNOWN.update({law.name: law for law in laws})


def installed_laws() -> Iterator[tuple[str, Callable[[], tuple[Law, ...]]]]:
    """Of every entry point its name for messages, and what loads its laws: those taken into the library before too.

    What loads them raises BadInput where the package cannot be imported, or does not name a law or laws.
    """
    from importlib.metadata import entry_points

    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        package = "" if point.dist is None else f"{point.dist.name} "
        where = f"{package}({GROUP}: {point.name})"
        yield where, lambda point=point, where=where: _loaded(point, where)


@cache
def take_installed_laws() -> tuple[str, ...]:
    """Take the laws of all installed packages into the library, once; returns what is wrong with any, in sentences."""
    wrong = []
    for where, load in installed_laws():
        try:
            load()
        except BadInput as problem:
            wrong.append(f"{problem} (correct the package of {where}, or uninstall it)")
    return tuple(wrong)


@cache
def _loaded(point: EntryPoint, where: str) -> tuple[Law, ...]:
    try:
        named = point.load()
    except Exception as problem:  # another's program
        raise BadInput(f"{where}: cannot be imported ({type(problem).__name__}: {problem})") from problem
    laws = tuple(_laws_of(named))
    if not laws:
        raise BadInput(f"{where}: is a {type(named).__name__} without a Law; name a Law, several, or their module")
    take(laws, where)
    return laws


def _laws_of(named: Any) -> Iterator[Law]:
    if isinstance(named, Law):
        yield named
    elif isinstance(named, ModuleType):
        ours = {id(law) for law in KNOWN.values()}  # which it may have imported
        laws = {id(value): value for value in vars(named).values() if isinstance(value, Law)}
        yield from (law for key, law in laws.items() if key not in ours)
    elif isinstance(named, list | tuple):
        yield from (value for value in named if isinstance(value, Law))


def _pickled(law: Law) -> str | tuple[Any, ...]:
    """By its name where the library knows it, else as any other value."""
    known = law in (KNOWN.get(law.name), FURTHER.get(law.name))
    return (find, (law.name,)) if known else law.__reduce_ex__(2)


copyreg.pickle(Law, _pickled)  # pyright: ignore[reportArgumentType]
