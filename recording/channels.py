"""Named arrays, as files and programs hold them, made into the tables of records."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from .plain_numbers import numbers_of
from .table import Table

#: Names of numbers that are a sampling rate in Hz, or an interval in s, in lower case.
_RATES = ("fs", "fsample", "samplerate", "samplingrate", "samplingfrequency", "samplefrequency", "rate")
_INTERVALS = ("dt", "ts", "samplinginterval", "samplinginterval_s", "increment")
_MOST_COLUMNS = 1024  # of a matrix, whose longer side is the time
_DEEPEST = 16  # groups within groups
_ALIKE = 1e-4  # relative: an interval of four digits says a rate no better


@dataclass(frozen=True)
class Channel:
    """Samples (n,) of one quantity, with the unit that the file states, "" where it does not."""

    name: str
    values: np.ndarray
    unit: str = ""


def table_of(
    where: str, channels: Sequence[Channel], fs: float | None = None, record: str = "", notes: Sequence[str] = ()
) -> Table:
    """The table of channels, of which those of the greatest length are taken and the others named in a note.

    Args:
        where: name for messages.
        channels: at least one.
        fs: sampling rate, Hz, where it is known.
        record: name of the record in its file.
        notes: what is to be said of it.
    """
    longest = max(channel.values.size for channel in channels)
    used = [channel for channel in channels if channel.values.size == longest]
    others = tuple((c.name, c.unit, c.values.size) for c in channels if c.values.size != longest)
    if others:
        names = ", ".join(f"'{name}' ({size})" for name, _, size in others[:5])
        names += f" and {len(others) - 5} more" if len(others) > 5 else ""
        notes = (*notes, f"{where}: the record has {longest} samples; {names}, of other lengths, are left out")

    def numbers(indices: Sequence[int]) -> np.ndarray:
        return np.column_stack([np.asarray(used[i].values, float) for i in indices])

    names, units = tuple(channel.name for channel in used), tuple(channel.unit for channel in used)
    return Table(where, names, units, numbers, fs, record, tuple(notes), others)


def tables_of_tree(where: str, tree: Mapping[str, Any], units: Mapping[str, str] | None = None) -> list[Table]:
    """The records of named arrays, in groups within groups: the arrays of one group are the channels of one record.

    A single number named fs, dt or the like is the rate of its group and those below. A matrix is as many channels as
    its shorter side. What is masked is missing. What holds no real numbers is passed over; where it is as long as the
    record, that is said.

    Args:
        where: name of the file.
        tree: arrays and groups by name.
        units: of arrays by their path, "group/name".

    Raises:
        BadInput: a rate is no positive number.
    """
    records = [found for found in _records(where, tree, units or {}, "", None, 0) if found[1]]
    several = len(records) > 1
    made = []
    for path, channels, passed, fs in records:
        name = (path or "top") if several else ""
        place = f"{where}#{name}" if name else where
        made.append(table_of(place, channels, fs, name, passed_over(place, passed)))
    return made


def passed_over(where: str, passed: Mapping[str, str]) -> list[str]:
    """The sentence on columns that are no channels, by what they hold; none where there are none."""
    if not passed:
        return []
    named = [f"'{name[:80]}' ({kind})" for name, kind in passed.items()]
    names = ", ".join(named[:5]) + (f" and {len(named) - 5} more" if len(named) > 5 else "")
    return [f"{where}: passed over, as no real numbers: {names}"]


def text_of_name(name: Any) -> str:
    """A channel's name as text: of bytes what they spell, for a unit stands in it."""
    return name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)


def _records(
    where: str, tree: Mapping[str, Any], units: Mapping[str, str], path: str, fs: float | None, depth: int
) -> Iterator[tuple[str, list[Channel], dict[str, str], float | None]]:
    if depth > _DEEPEST:
        raise BadInput(f"{where}: has groups more than {_DEEPEST} deep at '{path[:80]}'; export the record as CSV")
    values = {text_of_name(name): value for name, value in tree.items() if not isinstance(value, Mapping)}
    fs = _one_rate(where, values) or fs
    channels, others = [], {}
    for name, value in values.items():
        found = _channels(name, value, units.get(f"{path}/{name}" if path else name, ""))
        if isinstance(found, list):
            channels += found
        else:
            others[name] = found
    longest = max((channel.values.size for channel in channels), default=0)
    passed = {name: kind for name, (kind, shape) in others.items() if longest in shape}
    yield path, channels, passed, fs
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _records(
                where, value, units, f"{path}/{text_of_name(name)}" if path else text_of_name(name), fs, depth + 1
            )


def _one_rate(where: str, values: Mapping[str, Any]) -> float | None:
    """The rate that numbers of one group state, Hz; raises BadInput where two state rates that differ."""
    stated = {name: rate for name, value in values.items() if (rate := _rate(where, name, value)) is not None}
    if stated and max(stated.values()) > min(stated.values()) * (1.0 + _ALIKE):
        rates = ", ".join(f"'{name}' {rate:.6g} Hz" for name, rate in stated.items())
        raise BadInput(f"{where}: states several sampling rates: {rates}; take out those that are wrong")
    return next(iter(stated.values()), None)


def _rate(where: str, name: str, value: Any) -> float | None:
    plain = name.lower().replace("_", "").removesuffix("hz")
    if plain not in (*_RATES, *_INTERVALS) or np.size(value) != 1:
        return None
    numbers = numbers_of(value).values
    if numbers is None:
        return None
    number = float(numbers.reshape(()))
    if not (np.isfinite(number) and number > 0):
        raise BadInput(f"{where}: '{name}' is {number:g}, which is no sampling rate; mend it, or give --fs")
    return 1.0 / number if plain in _INTERVALS else number


def _channels(name: str, value: Any, unit: str) -> list[Channel] | tuple[str, tuple[int, ...]]:
    """The channels of an array, or of what cannot be one the kind and the shape."""
    array = value if isinstance(value, np.ndarray) else None
    if array is not None and array.dtype.names:  # a table with named columns
        fields = [(field, _channels(field, array[field], "")) for field in array.dtype.names]
        made = [channel for _, found in fields if isinstance(found, list) for channel in found]
        return made or ("records of several values", array.shape)
    numbers = numbers_of(value)
    if numbers.values is None:
        return numbers.kind, np.shape(array) if array is not None else _shape(value)
    if numbers.values.size < 2:
        return []
    unit, array = unit or numbers.unit, numbers.values.squeeze()
    if array.ndim == 1:
        return [Channel(name, array, unit)]
    if array.ndim != 2 or min(array.shape) > _MOST_COLUMNS:
        return f"{array.ndim} dimensions" if array.ndim != 2 else f"more than {_MOST_COLUMNS} columns", array.shape
    columns = array if array.shape[0] >= array.shape[1] else array.T
    return [Channel(f"{name}_{i + 1}", columns[:, i], unit) for i in range(columns.shape[1])]


def _shape(value: Any) -> tuple[int, ...]:
    """The length of a list; of text, none."""
    return () if isinstance(value, str | bytes) else (len(value),) if hasattr(value, "__len__") else ()
