"""Named arrays, as files and programs hold them, made into the tables of records."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from .table import Table

#: Names of numbers that are a sampling rate in Hz, or an interval in s, in lower case.
_RATES = ("fs", "fsample", "samplerate", "samplingrate", "samplingfrequency", "samplefrequency", "rate")
_INTERVALS = ("dt", "ts", "samplinginterval", "samplinginterval_s", "increment")
_MOST_COLUMNS = 1024  # of a matrix, whose longer side is the time
_DEEPEST = 16  # groups within groups


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
    others = [f"'{channel.name}' ({channel.values.size})" for channel in channels if channel.values.size != longest]
    if others:
        names = ", ".join(others[:5]) + (f" and {len(others) - 5} more" if len(others) > 5 else "")
        notes = (*notes, f"{where}: the record has {longest} samples; {names}, of other lengths, are left out")

    def numbers(indices: Sequence[int]) -> np.ndarray:
        return np.column_stack([np.asarray(used[i].values, float) for i in indices])

    names, units = tuple(channel.name for channel in used), tuple(channel.unit for channel in used)
    return Table(where, names, units, numbers, fs, record, tuple(notes))


def tables_of_tree(where: str, tree: Mapping[str, Any], units: Mapping[str, str] | None = None) -> list[Table]:
    """The records of named arrays, in groups within groups: the arrays of one group are the channels of one record.

    A single number named fs, dt or the like is the rate of its group and those below. A matrix is as many channels as
    its shorter side. What holds no real numbers is passed over.

    Args:
        where: name of the file.
        tree: arrays and groups by name.
        units: of arrays by their path, "group/name".

    Raises:
        BadInput: a rate is no positive number.
    """
    records = [
        (path, channels, fs) for path, channels, fs in _records(where, tree, units or {}, "", None, 0) if channels
    ]
    several = len(records) > 1
    made = []
    for path, channels, fs in records:
        name = (path or "top") if several else ""
        made.append(table_of(f"{where}#{name}" if name else where, channels, fs, name))
    return made


def _records(
    where: str, tree: Mapping[str, Any], units: Mapping[str, str], path: str, fs: float | None, depth: int
) -> Iterator[tuple[str, list[Channel], float | None]]:
    if depth > _DEEPEST:
        raise BadInput(f"{where}: has groups more than {_DEEPEST} deep at '{path[:80]}'; export the record as CSV")
    values = {str(name): value for name, value in tree.items() if not isinstance(value, Mapping)}
    fs = next((rate for name, value in values.items() if (rate := _rate(where, name, value)) is not None), fs)
    channels = [
        channel
        for name, value in values.items()
        for channel in _channels(name, value, units.get(f"{path}/{name}" if path else name, ""))
    ]
    yield path, channels, fs
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _records(where, value, units, f"{path}/{name}" if path else str(name), fs, depth + 1)


def _rate(where: str, name: str, value: Any) -> float | None:
    plain = name.lower().replace("_", "").removesuffix("hz")
    if plain not in (*_RATES, *_INTERVALS) or not _real(value) or np.size(value) != 1:
        return None
    number = float(np.asarray(value).reshape(()))
    if not (np.isfinite(number) and number > 0):
        raise BadInput(f"{where}: '{name}' is {number:g}, which is no sampling rate; mend it, or give --fs")
    return 1.0 / number if plain in _INTERVALS else number


def _real(value: Any) -> bool:
    return np.asarray(value).dtype.kind in "iuf"


def _channels(name: str, value: Any, unit: str) -> list[Channel]:
    array = np.asarray(value)
    if array.dtype.names:  # a table with named columns
        return [c for field in array.dtype.names for c in _channels(field, array[field], "")]
    if array.dtype.kind not in "iuf" or array.size < 2:
        return []
    array = array.squeeze()
    if array.ndim == 1:
        return [Channel(name, array, unit)]
    if array.ndim != 2 or min(array.shape) > _MOST_COLUMNS:
        return []
    columns = array if array.shape[0] >= array.shape[1] else array.T
    return [Channel(f"{name}_{i + 1}", columns[:, i], unit) for i in range(columns.shape[1])]
