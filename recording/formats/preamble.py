"""Where the numbers of a text file begin, below what a logger writes above them: prose, names, units, sensitivities."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from ..columns import parse_column
from ..units import find_unit

_NUMBER = re.compile("[-+]?[0-9.,'\u2019\u00a0\u202f\u2009]*[0-9][0-9.,'\u2019\u00a0\u202f\u2009]*([eE][-+]?[0-9]+)?")
_NOT_A_NUMBER = {"nan", "inf", "-inf", "+inf"}
_MOST_LINES = 1000  # of a preamble
_IN_A_ROW = 3  # rows of numbers that make the beginning of data


def below_preamble(
    lines: Sequence[str], sample: int, cells: Callable[[str], list[str]]
) -> tuple[int, int | None, int | None]:
    """The index of the first row of data, and those of the lines with the names and the units, None where there are
    none; 0 where an ordinary header, of names and units at most, stands above.

    Args:
        lines: of the file that are not empty and no comments.
        sample: index of a line that is data.
        cells: takes a line apart.
    """
    width = len(cells(lines[sample]))
    head = [cells(line) for line in lines[: min(_MOST_LINES, len(lines))]]
    begin = next((i for i in range(len(head)) if _is_data(head[i : i + _IN_A_ROW], width)), None)
    if not begin or begin == 1:
        return 0, None, None
    above = head[:begin]
    if any(len(row) == width and all(_is_number(cell) for cell in row) for row in above):
        return 0, None, None  # what stands between rows of numbers is a fault, which the reader names
    rows = [i for i, row in enumerate(above) if len(row) == width and not any(_is_number(cell) for cell in row)]
    after = rows[-1] + 1 if rows else 0
    if any(len(row) == width and _is_number(row[0]) for row in above[after:]):
        return 0, None, None  # a row of data with a cell that is no number
    if begin == 2 and rows == [0, 1] and is_unit_row(above[1]):
        return 0, None, None
    if len(above[-1]) != width and len(above[-1]) > 1 and not rows:
        return 0, None, None  # a header that does not fit the data
    units = next((i for i in reversed(rows) if is_unit_row(above[i])), None)
    names = [i for i in rows if i != units]
    # of several rows of words the one with names that say what a column is; the lowest of those that say as much
    name = max(names, key=lambda i: (sum(bool(parse_column(cell).kind) for cell in above[i]), i), default=None)
    return begin, name, units


def is_unit_row(cells: Sequence[str]) -> bool:
    """Whether all cells are units, or empty, or a dash."""
    words = [cell.strip("[]() ") for cell in cells]
    return any(words) and all(not word or word == "-" or find_unit(word) is not None for word in words)


def _is_data(rows: Sequence[Sequence[str]], width: int) -> bool:
    return all(len(row) == width and any(row) and all(not c or _is_number(c) for c in row) for row in rows)


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None or cell.lower() in _NOT_A_NUMBER
