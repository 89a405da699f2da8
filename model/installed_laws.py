"""Laws that other installed packages bring: entry points of the group ``dashpot.laws``.

A package says in its pyproject.toml where its laws are, and whoever installs it has them by name everywhere: in model
files, ``--with`` and diagnoses. They are loaded when a law is asked for that the library does not have, or all are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from importlib import metadata
from types import ModuleType
from typing import Any

from ..errors import BadInput
from .law import Law
from .laws import LIBRARY

GROUP = "dashpot.laws"


def installed_laws() -> Iterator[tuple[str, Callable[[], tuple[Law, ...]]]]:
    """Of every entry point its name for messages, and what loads its laws: those taken into the library before too.

    What loads them raises BadInput where the package cannot be imported, or does not name a law or laws.
    """
    for point in sorted(metadata.entry_points(group=GROUP), key=lambda point: point.name):
        package = "" if point.dist is None else f"{point.dist.name} "
        where = f"{package}({GROUP}: {point.name})"
        yield where, lambda point=point, where=where: _loaded(point, where)


@cache
def take_installed_laws() -> tuple[str, ...]:
    """Take the laws of all installed packages into the library, once; returns what is wrong with any, in sentences."""
    problems = []
    for where, load in installed_laws():
        try:
            load()
        except BadInput as problem:
            problems.append(f"{problem} (correct the package of {where}, or uninstall it)")
    return tuple(problems)


@cache
def _loaded(point: metadata.EntryPoint, where: str) -> tuple[Law, ...]:
    from .user_laws import take

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
        ours = {id(law) for law in LIBRARY.values()}  # which it may have imported
        laws = {id(value): value for value in vars(named).values() if isinstance(value, Law)}
        yield from (law for key, law in laws.items() if key not in ours)
    elif isinstance(named, list | tuple):
        yield from (value for value in named if isinstance(value, Law))
