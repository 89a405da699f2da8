"""A channel: what a rig was recorded under and no force tells, as a number of a recording or as a column of it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import shown
from .channel_units import channel_unit, find_channel_unit
from .columns import find_column, parse_column
from .plain_numbers import vector_of
from .table import Table

_NUMBER = re.compile(r"^\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>\S.*)?$")
_NAME = re.compile(r"^[A-Za-z][A-Za-z0-9_]*$")
_COLUMN = re.compile(r"^(?P<column>.*?)\s*\[(?P<unit>[^\]]+)\]$")
_HOW = "write --channel current=0.5A, --channel current=0A,0.5A in order of the files, or --channel temperature_degC"


@dataclass(frozen=True, eq=False)
class Channel:
    """A further signal of a recording.

    Attributes:
        name: a word, by which models know it.
        unit: SI, degC of a temperature.
        values: the same number throughout, or (n,) of each sample.
    """

    name: str
    unit: str
    values: float | np.ndarray

    def over(self, n: int) -> np.ndarray:
        """(n,) of each sample."""
        return self.values if isinstance(self.values, np.ndarray) else np.full(n, float(self.values))

    def slice(self, first: int, last: int) -> Channel:
        """Of the samples from one to another."""
        cut = self.values[first:last] if isinstance(self.values, np.ndarray) else self.values
        return Channel(self.name, self.unit, cut)


@dataclass(frozen=True, eq=False)
class Stated:
    """What is said of a channel: a column of each recording, or numbers.

    Attributes:
        name: empty where the column's name says it.
        column: by name, pattern or number; None for numbers.
        unit: empty where column or number says it.
        values: a text, number or array (n,) for all recordings, or one for each in their order.
        by_file: pattern of a file's name, and its text or number.
    """

    name: str
    column: str | int | None = None
    unit: str = ""
    values: tuple[Any, ...] = ()
    by_file: tuple[tuple[str, Any], ...] = ()

    def of(self, place: int, where: str) -> Stated:
        """What is said of the recording in that place, whose file or name is ``where``; raises BadInput for none."""
        if self.column is not None:
            return self
        if self.by_file:
            names = (where, Path(where).name, Path(where).name.partition("#")[0])
            fits = [value for pattern, value in self.by_file if any(fnmatchcase(name, pattern) for name in names)]
            if len(fits) != 1:
                said = "nobody says" if not fits else "several numbers are given for"
                raise BadInput(
                    f"{where}: {said} the channel {self.name} of it; write --channel {self.name}={where}:NUMBER"
                )
            return Stated(self.name, None, self.unit, (fits[0],))
        if len(self.values) > 1 and place >= len(self.values):
            raise BadInput(
                f"{where}: the channel {self.name} has {len(self.values)} values, and none for it; give one more"
            )
        return self if len(self.values) == 1 else Stated(self.name, None, self.unit, (self.values[place],))


def stated_channels(given: Any) -> tuple[Stated, ...]:
    """What is said of channels, as texts ``NAME=VALUE`` or ``COLUMN``, or by name.

    Args:
        given: texts of ``--channel``, in a sequence; or by name numbers, texts with a unit, names of columns, arrays
            (n,), one of these for each recording in a list, or by the name of the file.

    Raises:
        BadInput: it is none of these, or a channel is said twice in ways that do not fit.
    """
    if isinstance(given, str):
        given = (given,)
    made: dict[str, Stated] = {}
    if isinstance(given, Mapping):
        pairs = [(str(name), value) for name, value in given.items()]
    else:
        pairs = []
        for text in given or ():
            if isinstance(text, Stated):
                made[text.name or str(text.column)] = text
                continue
            if not isinstance(text, str) or not text.strip():
                raise BadInput(f"a channel is not {shown(text)}; {_HOW}")
            name, sign, value = text.partition("=")
            if sign and not name.strip():
                raise BadInput(f"'{text}' does not say which channel it is; {_HOW}")
            pairs.append((name.strip(), value.strip()) if sign else ("", text.strip()))
    for name, value in pairs:
        one = _stated(name, value)
        known = made.get(one.name or str(one.column))
        if known is not None and not (known.by_file and one.by_file):
            raise BadInput(
                f"the channel {one.name or one.column} is said twice; say it once, or by file (NAME=FILE:NUMBER)"
            )
        if known is not None:
            one = Stated(one.name, None, one.unit or known.unit, (), (*known.by_file, *one.by_file))
        made[one.name or str(one.column)] = one
    return tuple(made.values())


def of_part(stated: Sequence[Stated], first: int, last: int | None, whole: int) -> tuple[Stated, ...]:
    """What is said of some of ``whole`` files, in their order; raises BadInput where there are not as many numbers."""
    made = []
    for one in stated:
        if len(one.values) > 1:
            check_count(one, whole)
            one = Stated(one.name, None, one.unit, one.values[first:last])
        made.append(one)
    return tuple(made)


def check_count(stated: Stated, count: int) -> None:
    """Raises BadInput where a channel has several numbers, and not one for each recording."""
    if len(stated.values) > 1 and len(stated.values) != count:
        raise BadInput(
            f"the channel {stated.name} has {len(stated.values)} values, and {count} recordings were given; give one "
            "for each in their order, or one for all"
        )


def _stated(name: str, value: Any) -> Stated:
    """One channel, the unit that its name may hold taken off."""
    if not name:
        return Stated("", value)
    column = parse_column(name)
    unit = column.unit_text
    if not unit and "_" in name and (tail := name.rpartition("_")[2]) and find_channel_unit(tail) is not None:
        unit = tail
    own = name if not unit else name.removesuffix(unit).rstrip("_ [(/")
    if not _NAME.match(own):
        raise BadInput(f"'{own}' is no name of a channel; take a word of letters, digits and underscores; {_HOW}")
    if isinstance(value, Mapping):
        return Stated(own, None, unit, (), tuple((str(file), one) for file, one in value.items()))
    if isinstance(value, str):
        parts = [part.strip() for part in value.split(",")]
        if all(":" in part for part in parts):
            return Stated(
                own, None, unit, (), tuple((f.strip(), v.strip()) for f, _, v in (p.rpartition(":") for p in parts))
            )
        if all(_NUMBER.match(part) for part in parts):
            return Stated(own, None, unit, tuple(parts))
        if len(parts) > 1 or not value:
            raise BadInput(f"the channel {own} is '{value}', which is neither numbers nor a column; {_HOW}")
        match = _COLUMN.match(value)
        return Stated(own, match["column"], match["unit"]) if match else Stated(own, value, unit)
    if isinstance(value, list | tuple):
        return Stated(own, None, unit, tuple(value))
    return Stated(own, None, unit, (value,))


@dataclass(frozen=True, eq=False)
class Sought:
    """A channel of one record before it is sampled: a number, or the values of its rows, of a column or given."""

    name: str
    unit: str
    number: float | None
    rows: np.ndarray | None = None
    index: int | None = None


def sought(table: Table, stated: Sequence[Stated]) -> list[Sought]:
    """The channels of a table; raises BadInput for a column that is not there, and for what is no number."""
    made = []
    for one in stated:
        if one.column is None:
            made.append(of_value(one, table.where))
            continue
        index = find_column(table, "channel", one.column)
        column = parse_column(table.names[index], table.units[index])
        name, unit_text = one.name or column.base.strip(), one.unit or column.unit_text
        head, _, tail = column.name.rpartition("_")
        if not unit_text and head and find_channel_unit(tail) is not None:
            name, unit_text = one.name or head, tail
        name = re.sub(r"\W+", "_", name).strip("_")
        if not _NAME.match(name):
            raise BadInput(
                f"{table.where}: the column {table.label(index)} has no name for a channel; give it one, such as "
                f"--channel temperature={one.column}"
            )
        if not unit_text:
            raise BadInput(
                f"{table.where}: nobody says the unit of the channel {name}; write "
                f"--channel '{name}={one.column} [UNIT]'"
            )
        unit = channel_unit(name, unit_text, table.where)
        rows = unit.factor * table.numbers([index])[:, 0] + unit.offset
        made.append(Sought(name, unit.si, None, rows, index))
    names = [one.name for one in made]
    if doubled := next((name for name in names if names.count(name) > 1), None):
        raise BadInput(f"{table.where}: two channels are called {doubled}; give one of them another name (NAME=COLUMN)")
    return made


def of_value(stated: Stated, where: str) -> Sought:
    """A channel that is no column; raises BadInput where it is no number, or its unit does not fit."""
    (value,) = stated.values
    unit_text, rows = stated.unit, None
    if isinstance(value, str):
        match = _NUMBER.match(value)
        if match is None:
            raise BadInput(f"{where}: the channel {stated.name} is '{value}', which is no number; {_HOW}")
        number, written = float(match["number"]), (match["unit"] or "").strip()
        if written and unit_text and find_channel_unit(written) != find_channel_unit(unit_text):
            raise BadInput(
                f"{where}: the channel {stated.name} is in '{unit_text}' and in '{written}'; drop one of them"
            )
        unit_text = written or unit_text
    elif isinstance(value, np.ndarray) and value.ndim:
        number, rows = 0.0, vector_of(value, f"{where}: the channel {stated.name}")
        if rows.ndim != 1:
            raise BadInput(f"{where}: the channel {stated.name} has shape {rows.shape}; it must be one column")
    else:
        number = float(vector_of([value], f"{where}: the channel {stated.name}")[0])
    unit = channel_unit(stated.name, unit_text, where)
    if rows is not None:
        return Sought(stated.name, unit.si, None, unit.factor * rows + unit.offset)
    if not math.isfinite(number):
        raise BadInput(f"{where}: the channel {stated.name} is {number}; give a number")
    return Sought(stated.name, unit.si, unit.factor * number + unit.offset)


def refuse_gaps(where: str, name: str, rows: np.ndarray) -> None:
    """Raises BadInput where a channel's rows (n,) are not all numbers: nobody knows how the rig was then."""
    bad = np.flatnonzero(~np.isfinite(rows))
    if bad.size:
        raise BadInput(
            f"{where}: the channel {name} has {bad.size} sample(s) that are no number, the first in row {bad[0] + 1} "
            "of the data; fill them, or keep a part without them (--part)"
        )
