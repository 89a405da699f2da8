"""Comma, semicolon, tab or blank separated text, plain or gzipped, as loggers and spreadsheets write it."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from ...errors import BadInput
from ..content import MOST_MB, unpacked
from ..table import Table
from .loggers import header_of
from .preamble import below_preamble, is_unit_row

_COMMENT = ("#", "%")
#: What programs write where there is no number, as pandas reads it too.
_ABSENT = frozenset(
    ("", "na", "n/a", "#na", "#n/a", "<na>", "null", "none", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan")
)
_GROUPED = re.compile("[-+]?[0-9.,'\u2019\u00a0\u202f\u2009]+([eE][-+]?[0-9]+)?")
#: Lines that a cell of a header may go on over.
_CELL_LINES = 4
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The one record of a text file: see ``read_delimited``."""
    return [read_delimited(where, content, most)]


def read_delimited(where: str, content: bytes, most: float = MOST_MB) -> Table:
    """Return the table that the bytes of a text file hold, at most `most` MB; `where` names the file in messages.

    Delimiter and decimal comma are found from the data; lines that begin with # or % are comments, of which the last
    one above the data may hold the column names; a second header row may hold units, and what a logger writes above
    and between these is passed over. Raises BadInput for a file that
    is empty, binary, a broken gzip, without numbers, or whose rows differ in length.
    """
    numbered = [(i, line) for i, line in _logical(text_of(where, content, most).splitlines()) if line.strip()]
    lines = [(i, line) for i, line in numbered if not line.lstrip().startswith(_COMMENT)]
    if not lines:
        raise BadInput(f"{where} has no rows of numbers; it needs a header line and one row for each sample")
    sample = min(len(lines) - 1, max(19, len(lines) // 2))
    delimiter = _delimiter([lines[0][1], lines[sample][1]])
    if delimiter is not None:  # what a spreadsheet or a logger puts behind the last column is no column
        width = len(_cells(lines[sample][1], delimiter)) - min(_spare(line, delimiter) for _, line in lines[sample:])
        width = max(width, _named(lines[: sample + 1], delimiter))
        numbered, lines = ([(i, _within(line, delimiter, width)) for i, line in rows] for rows in (numbered, lines))
    begin, names_of, units_of = below_preamble([line for _, line in lines], sample, lambda x: _cells(x, delimiter))
    above, lines = lines[:begin], lines[begin:]
    numerals = Numerals()
    if delimiter != "," and any("," in line for _, line in lines[1:20]):
        numerals = numerals_of(where, "\n".join(line for _, line in lines[2:]) or lines[-1][1])
    header, units = [], []
    if begin:
        header = [] if names_of is None else _cells(above[names_of][1], delimiter)
        units = [] if units_of is None else [cell.strip("[]() ") for cell in _cells(above[units_of][1], delimiter)]
    elif not _numeric(_cells(lines[0][1], delimiter), numerals):
        header = _cells(lines.pop(0)[1], delimiter)
        if lines and is_unit_row(_cells(lines[0][1], delimiter)):
            units = [cell.strip("[]() ") for cell in _cells(lines.pop(0)[1], delimiter)]
    if not lines:
        raise BadInput(f"{where} has a header and no rows of numbers below it; write one row for each sample")
    width = len(_cells(lines[0][1], delimiter))
    commented = not header
    if commented:
        header = _commented_header([line for i, line in numbered if i < lines[0][0]], delimiter, width)
    while len(header) > width and not header[-1]:
        header.pop()
    if header and len(header) != width:
        raise BadInput(
            f"{where}: the header names {len(header)} columns but line {lines[0][0]} has {width}; "
            "give every column one name"
        )
    _reject_unequal_rows(where, lines, delimiter, width)
    names = tuple(header) or ("",) * width
    known = header_of(where, names, [*units, *[""] * width][:width], commented=commented)

    def numbers(indices: Sequence[int]) -> np.ndarray:
        return _numbers(where, lines, delimiter, numerals, names, [known.taken[i] for i in indices])

    return Table(where, known.names, known.units, numbers, notes=known.notes)


def _logical(lines: list[str]) -> list[tuple[int, str]]:
    """Lines with their numbers, from 1; those that a cell in quotes goes on over are one (RFC 4180), with blanks.

    A quote that no other closes within a few lines is a sign like any other, such as that of inches.
    """
    made: list[tuple[int, str]] = []
    i = 0
    while i < len(lines):
        last = i
        if lines[i].count('"') % 2:
            closing = range(i + 1, min(i + 1 + _CELL_LINES, len(lines)))
            last = next((k for k in closing if lines[k].count('"') % 2), i)
        made.append((i + 1, " ".join(line.strip() for line in lines[i : last + 1]) if last > i else lines[i]))
        i = last + 1
    return made


def text_of(where: str, content: bytes, most: float) -> str:
    """The text of a file, of at most so many MB; raises BadInput for one that is empty or binary."""
    if content and content[:2] != b"\x1f\x8b" and where.lower().endswith(".gz"):
        raise BadInput(f"{where} ends in .gz but is not a gzip file; rename it or compress it")
    content = unpacked(where, content, most)
    if not content.strip():
        raise BadInput(f"{where} is empty; record or copy it again")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        raise BadInput(f"{where} is a binary file, not text; export it as CSV")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # older loggers write µ and ° so
    head = text[:4096]
    if sum(not (c.isprintable() or c.isspace()) for c in head) > 0.05 * len(head):
        raise BadInput(f"{where} is a binary file, not text; export it as CSV")
    return text


def _delimiter(lines: list[str]) -> str | None:
    """Return the delimiter, None for blanks, from the last lines given: the first ones may be headers."""
    sample = lines[-1]
    for delimiter in ("\t", ";"):
        if delimiter in sample:
            return delimiter
    words = sample.split()
    if len(words) > 1 and all(_DECIMAL_COMMA.fullmatch(word) or _is_number(word) for word in words):
        return None
    return "," if "," in sample or "," in lines[0] else None


def _spare(line: str, delimiter: str) -> int:
    """How many delimiters stand at the end of a line with nothing between or behind them."""
    line = line.rstrip(" ")
    return len(line) - len(line.rstrip(delimiter))


def _within(line: str, delimiter: str, width: int) -> str:
    """A line less the delimiters at its end that are more than so many columns need."""
    if not (spare := _spare(line, delimiter)):
        return line
    more = len(_cells(line, delimiter)) - width
    return line.rstrip(" ")[: -min(spare, more)] if more > 0 else line


def _named(lines: list[tuple[int, str]], delimiter: str) -> int:
    """How many columns the header has that stands above the first numbers, less what is empty at its end."""
    above = list(takewhile(lambda pair: not _numeric(_cells(pair[1], delimiter), Numerals()), lines))
    if len(above) > 1 and is_unit_row(_cells(above[-1][1], delimiter)):
        above.pop()
    return len(_cells(above[-1][1], delimiter)) - _spare(above[-1][1], delimiter) if above else 0


def _cells(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return [word.strip('"') for word in re.sub(r"\s+(?=[\[(])", "", line).split()]  # "x [mm]" is one name
    cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return [cell.strip() for cell in cells] or [""]  # csv takes no text for no cell


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _numeric(cells: list[str], numerals: Numerals) -> bool:
    """Whether this is a row of data: a header has no number in it."""
    return any(_is_number(numerals.plain(cell)) for cell in cells)


def _commented_header(above: list[str], delimiter: str | None, width: int) -> list[str]:
    """Return the names in the last comment above the data if it has as many words as there are columns."""
    for line in reversed(above):
        cells = _cells(line.strip().lstrip("".join(_COMMENT)).strip(), delimiter)
        if len(cells) == width and not any(_is_number(cell) for cell in cells):
            return cells
        break
    return []


def _reject_unequal_rows(where: str, lines: list[tuple[int, str]], delimiter: str | None, width: int) -> None:
    joining = '"' if delimiter else '"[('  # what may make one cell of several pieces
    for number, line in lines:
        count = line.count(delimiter) + 1 if delimiter else len(line.split())
        joined = count != width or any(mark in line for mark in joining)
        if joined and (count := len(_cells(line, delimiter))) != width:
            raise BadInput(
                f"{where}: line {number} has {count} column(s) where the lines before have {width}; "
                "mend or remove that line"
            )


def _clock(lines: list[tuple[int, str]], delimiter: str | None, index: int) -> np.ndarray | None:
    """A column of times of day in seconds; None where it is none."""
    first = _cells(lines[0][1], delimiter)[index]
    return None if seconds_of([first]) is None else seconds_of([_cells(line, delimiter)[index] for _, line in lines])


def _numbers(
    where: str,
    lines: list[tuple[int, str]],
    delimiter: str | None,
    numerals: Numerals,
    names: Sequence[str],
    indices: Sequence[int],
) -> np.ndarray:
    rows = [line if numerals == Numerals() else numerals.plain(line) for _, line in lines]
    try:
        return np.loadtxt(rows, delimiter=delimiter, usecols=list(indices), ndmin=2, comments=None, quotechar='"')
    except ValueError:
        pass  # numpy's message does not know our line numbers and names
    clocks = {i: times for i in indices if (times := _clock(lines, delimiter, i)) is not None}
    if clocks:
        others = [i for i in indices if i not in clocks]
        columns = _numbers(where, lines, delimiter, numerals, names, others) if others else None
        made = clocks | ({} if columns is None else dict(zip(others, columns.T, strict=True)))
        return np.column_stack([made[i] for i in indices])
    if numerals == Numerals() and delimiter is not None:  # digits in groups, in quotes where the delimiter is a comma
        cells = [[_cells(line, delimiter)[i] for i in indices] for _, line in lines]
        if all(_GROUPED.fullmatch(cell) for row in cells for cell in row):
            grouped = numerals_of(where, "\n".join(cell for row in cells for cell in row))
            cells = [[grouped.plain(cell) for cell in row] for row in cells]
            if all(_is_number(cell) for row in cells for cell in row):
                return np.array(cells, float)
    cells = [[numerals.plain(_cells(line, delimiter)[i]) for i in indices] for _, line in lines]
    if any(cell.lower() in _ABSENT for row in cells for cell in row):
        for place, i in enumerate(indices):
            if all(row[place].lower() in _ABSENT for row in cells):
                label = f"column '{names[i]}'" if names[i] else f"column {i + 1}"
                raise BadInput(f"{where}: {label} is empty; choose another, or record that channel")
        # what is no number must not be read as more cells or fewer once more: it is told by its line
        bare = str.maketrans({'"': "'", "\t": " "})
        there = [["nan" if cell.lower() in _ABSENT else cell.translate(bare) for cell in row] for row in cells]
        written = [(number, "\t".join(row)) for (number, _), row in zip(lines, there, strict=True)]
        return _numbers(where, written, "\t", Numerals(), [names[i] for i in indices], range(len(indices)))
    dated = [i for i in indices if seconds_of([_cells(lines[0][1], delimiter)[i]]) is not None]
    for (number, _), row in zip(lines, cells, strict=True):
        for i, cell in zip(indices, row, strict=True):
            if not _is_number(cell) and (i not in dated or seconds_of([cell]) is None):
                label = f"column '{names[i]}'" if names[i] else f"column {i + 1}"
                raise BadInput(
                    f"{where}: line {number}, {label} holds '{cell[:40]}', which is not a number; mend or remove "
                    "that line"
                )
    raise BadInput(f"{where} cannot be read as columns of numbers; export it as plain CSV")


# Times of day as loggers write them, with or without a date: 2021-05-07 11:02:42.10, 5/7/2021 11:02:42, 2:42:07 PM.

_DAY = 86400.0
_STAMP = re.compile(
    r"(?:\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}[T\s]\s*)?(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d*|:\d{3})?)\s*([AaPp][Mm])?"
    r"\s*(?:Z|UTC|[+-]\d{2}:?\d{2})?"
)


def seconds_of(cells: Sequence[str]) -> np.ndarray | None:
    """(n,) seconds since the midnight before the first stamp; None where a cell is no time of day.

    The date is not read: writers differ in its order, and no step of a recorder is half a day long. Where the time
    goes back by more than that, it is the next day.
    """
    found = [_STAMP.fullmatch(cell.strip()) for cell in cells]
    times = []
    for match in found:
        if match is None:
            return None
        hours, minutes, seconds = int(match[1]), int(match[2]), float(match[3].replace(",", ".").replace(":", "."))
        if match[4]:
            hours = hours % 12 + (12 if match[4].lower() == "pm" else 0)
        if hours > 23 or minutes > 59 or seconds >= 61:
            return None
        times.append(3600.0 * hours + 60.0 * minutes + seconds)
    made = np.array(times)
    return made + _DAY * np.concatenate([[0], np.cumsum(np.diff(made) < -0.5 * _DAY)])


# How a file writes its numbers: which sign is the decimal one, and which only groups the digits of thousands.

_ALONE = r"(?<![\d.,'])(?:0|\d{4,})?{0}\d"  # 0,5 and 1234,5: no group of thousands begins so
_DECIMAL = _ALONE + r"|{0}\d{{1,2}}(?![\d.,])|{0}\d{{4}}|{0}\d+[eE]"
_GROUPS = r"\d{0}\d{{3}}(?:{1}\d|{0}\d{{3}}(?!\d))"
_COMMA_DECIMAL, _DOT_DECIMAL = (re.compile(_DECIMAL.replace("\\d{4,}", "\\d{{4,}}").format(s)) for s in (",", r"\."))
_COMMA_GROUPS, _DOT_GROUPS = (re.compile(_GROUPS.format(*s)) for s in ((",", r"\."), (r"\.", ",")))
_SINGLE = re.compile(r"(?<![\d.,'])[+-]?\d{1,3},\d{3}(?![\d.,])")
#: Signs that only ever group digits: apostrophe and the spaces that do not break a line.
_SPACES = re.compile("(?<=\\d)['\u2019\u00a0\u202f\u2009](?=\\d{3})")


@dataclass(frozen=True)
class Numerals:
    """How numbers are written: the sign that groups digits, "" for none, and whether the comma is the decimal sign."""

    grouping: str = ""
    decimal_comma: bool = False

    def plain(self, text: str) -> str:
        """The text with numbers as programs write them."""
        if self.grouping:
            text = text.replace(self.grouping, "")
        text = _SPACES.sub("", text)
        return text.replace(",", ".") if self.decimal_comma else text


def numerals_of(where: str, text: str) -> Numerals:
    """How the numbers in ``text`` are written, in which no comma and no dot stands for anything else.

    Raises:
        BadInput: where two ways are mixed, or it is unclear which one it is.
    """
    comma, groups = bool(_COMMA_DECIMAL.search(text)), bool(_COMMA_GROUPS.search(text))
    dots = "." in text
    dot, dot_groups = dots and bool(_DOT_DECIMAL.search(text)), dots and bool(_DOT_GROUPS.search(text))
    if "," not in text:
        comma = dot_groups
    elif not comma and not groups:
        shown = found[0] if (found := _SINGLE.search(text)) else ","
        raise BadInput(
            f"{where}: cannot tell whether {shown} has a decimal comma or a sign that groups thousands; write the "
            "numbers with a decimal point and without groups"
        )
    if (comma and (groups or dot)) or (dot and dot_groups):
        raise BadInput(
            f"{where}: comma and point are each used as the decimal sign; write all numbers with a decimal point and "
            "without groups"
        )
    if comma:
        return Numerals("." if dots else "", decimal_comma=True)
    return Numerals("," if groups else "")
