"""Where a recording lies: a file, and behind # the name of one of the records in it, ``runs.mat#run3``."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path

from ..errors import BadInput
from .table import Table


def parse_address(path: str | Path) -> tuple[Path, str]:
    """The file and the name of the record, "" where none is named; a file whose own name has a # is that file."""
    path = Path(path)
    try:
        there = path.exists()
    except (OSError, ValueError):
        there = False
    file, _, record = str(path).partition("#")  # a record's name may hold slashes: groups within groups
    return (path, "") if there or not file or not record else (Path(file), record)


def addressed(file: str, tables: Sequence[Table], record: str) -> list[Table]:
    """The records that an address means: all, or the one of that name or number from 1.

    Raises:
        BadInput: there is none of that name.
    """
    if not record:
        return list(tables)
    if found := [table for table in tables if table.record == record]:
        return found
    if record.isascii() and record.isdigit() and len(record) < 9 and 1 <= int(record) <= len(tables):
        return [tables[int(record) - 1]]
    names = [table.record for table in tables if table.record]
    if not names:
        raise BadInput(f"{file} holds one record, which has no name; leave out '#{record}'")
    near = difflib.get_close_matches(record, names, n=1)
    advice = f"did you mean '{near[0]}'?" if near else f"it has {listed(names)}"
    raise BadInput(f"{file} holds no record '{record}'; {advice}")


def single(file: str, tables: Sequence[Table]) -> Table:
    """The only record; raises BadInput where there are several."""
    if len(tables) == 1:
        return tables[0]
    names = [table.record for table in tables]
    raise BadInput(f"{file} holds {len(tables)} records, {listed(names)}; name one: {file}#{names[0]}")


def listed(names: Sequence[str]) -> str:
    """Names in a sentence, the first ten of them."""
    return ", ".join(names[:10]) + (f" and {len(names) - 10} more" if len(names) > 10 else "")
