"""Readers of other packages, by entry points of the group ``dashpot.readers``: the name is a suffix without its dot.

An entry point names a function ``read(name: str, content: bytes)``. It gives what a program may hand over as a
recording (see ``tables_of_object``): arrays by name with ``fs`` or a time, in groups for several records, a pandas
DataFrame, an xarray Dataset, SEP 5 dictionaries; or a mapping of names to DataFrames or Datasets, one a record. What it
raises is said in a sentence. It is a program that its user has installed, and runs in this process.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...errors import BadInput
from ..objects import tables_of_object
from ..table import Table

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "dashpot.readers"
Read = Callable[[str, bytes], Any]


def installed_readers() -> Iterator[tuple[str, str, Callable[[], Read]]]:
    """Of every entry point the suffix, ``.wdq``, its name for messages, and what loads it.

    What loads it raises BadInput where the package cannot be imported, or names no function.
    """
    from importlib.metadata import entry_points

    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        package = "" if point.dist is None else f"{point.dist.name} "
        where = f"{package}({GROUP}: {point.name})"
        yield f".{point.name.lower().lstrip('.')}", where, lambda point=point, where=where: _loaded(point, where)


def installed_tables(name: str, suffix: str, content: bytes) -> list[Table] | None:
    """The records of a file that a reader of an installed package reads; None where none is for its suffix.

    Args:
        name: of the file.
        suffix: with its dot, in lower case.
        content: its bytes, unpacked.

    Raises:
        BadInput: the reader cannot be loaded, refuses the file, or gives what is no recording.
    """
    found = next(((where, load) for known, where, load in installed_readers() if known == suffix), None)
    if found is None:
        return None
    where, load = found
    read = load()
    try:
        given = read(name, content)
    except Exception as problem:  # another's program
        said = str(problem).strip().partition("\n")[0][:200] or type(problem).__name__
        raise BadInput(f"{name} cannot be read by {where}: {said}; export the file as CSV") from problem
    try:
        return _tables(name, given)
    except BadInput as problem:
        raise BadInput(f"{problem} (given by {where})") from None


def _tables(name: str, given: Any) -> list[Table]:
    several = isinstance(given, Mapping) and bool(given) and all(hasattr(one, "columns") for one in given.values())
    several = several or (
        isinstance(given, Mapping) and bool(given) and all(hasattr(v, "dims") for v in given.values())
    )
    if not several:
        return tables_of_object(given, name)
    return [
        replace(table, record=str(record))
        for record, one in given.items()
        for table in tables_of_object(one, f"{name}#{record}")
    ]


def _loaded(point: EntryPoint, where: str) -> Read:
    try:
        read = point.load()
    except Exception as problem:  # another's program
        said = f"{type(problem).__name__}: {problem}".partition("\n")[0][:200]
        raise BadInput(f"{where}: cannot be imported ({said}); correct the package, or uninstall it") from problem
    if not callable(read):
        raise BadInput(f"{where}: is a {type(read).__name__} and no function; name what reads (name, content)")
    return read
