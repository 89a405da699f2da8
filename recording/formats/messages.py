"""Messages of a bag, nested as their definitions are, made into channels: one record a topic, over the messages' times.

Units are those of the Robot Operating System's conventions (REP 103: SI) where the type of a message says what a field
is. Topics whose messages bear the same times are channels of one record.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..channels import Channel, table_of
from ..columns import parse_column
from ..content import too_large
from ..table import Table

#: Fields by the last part of their message's type, with the unit of what they hold.
_UNITS = {
    ("Imu", "linear_acceleration"): "m/s2",
    ("Imu", "angular_velocity"): "rad/s",
    ("Wrench", "force"): "N",
    ("Wrench", "torque"): "N.m",
    ("Accel", "linear"): "m/s2",
    ("Accel", "angular"): "rad/s2",
    ("Twist", "linear"): "m/s",
    ("Twist", "angular"): "rad/s",
    ("Pose", "position"): "m",
}
_SECONDS, _NANOSECONDS = ("sec", "secs"), ("nanosec", "nsec", "nsecs")
#: Fields in which a message says when what it holds was measured.
_STAMPS = ("header", "stamp", "timestamp")
#: Of a list the elements that are channels at most, messages within messages, and what no signal is.
_LONGEST, _DEEPEST, _PASSED = 64, 8, "covariance"


@dataclass
class _Topic:
    """What one topic has said: its times in ns, and the numbers of each field with a unit, NaN where one is missing."""

    times: list[int] = field(default_factory=list)
    columns: dict[str, list[float]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    stamped: bool = True


def tables_of_messages(where: str, messages: Iterable[tuple[str, int, Any]], most: float) -> list[Table]:
    """The records of messages, at most ``most`` MB of numbers; none where no message holds two numbers in a row.

    Args:
        where: name of the file.
        messages: topic, time of writing in ns, and the message: a mapping, or an object with fields.
        most: MB.

    Raises:
        BadInput: they hold more.
    """
    topics: dict[str, _Topic] = {}
    count = 0
    for name, written, message in messages:
        topic = topics.setdefault(name, _Topic())
        stamp = _stamp(message)
        topic.stamped = topic.stamped and stamp is not None
        topic.times.append(written if stamp is None or not topic.stamped else stamp)
        numbers = dict(_numbers(message, "", "", 0, topic.units))
        for key, value in numbers.items():
            topic.columns.setdefault(key, [np.nan] * (len(topic.times) - 1)).append(value)
        for key, column in topic.columns.items():
            if key not in numbers:
                column.append(np.nan)
        count += len(topic.columns) + 1
        if count * 8 > most * 1e6:
            raise too_large(where, most)
    groups: dict[bytes, list[str]] = {}
    for name, topic in topics.items():
        if len(topic.times) > 1 and topic.columns:
            groups.setdefault(np.array(topic.times, np.int64).tobytes(), []).append(name)
    return [_table(where, names, topics, len(groups) > 1) for names in groups.values()]


def _table(where: str, names: Sequence[str], topics: Mapping[str, _Topic], several: bool) -> Table:
    """The record of topics that share their times."""
    first = topics[names[0]]
    record = names[0] if several else ""
    place = f"{where}#{record}" if record else where
    channels = []
    if not any(parse_column(key).kind == "time" for name in names for key in topics[name].columns):
        times = np.array(first.times, np.int64)
        channels.append(Channel("time", 1e-9 * (times - times[0]), "s"))
    for name in names:
        ahead = f"{name} " if len(names) > 1 else ""
        made = topics[name]
        channels += [Channel(f"{ahead}{key}", np.array(v), made.units.get(key, "")) for key, v in made.columns.items()]
    return table_of(place, channels, None, record)


def _parts(message: Any) -> Iterator[tuple[str, Any]] | None:
    """Name and value of each field; None of what has none."""
    if isinstance(message, Mapping):
        return ((str(name), value) for name, value in message.items())
    names = getattr(type(message), "__dataclass_fields__", None)
    return None if names is None else ((n, getattr(message, n)) for n in names if not n.startswith("__"))


def _ticks(value: Any) -> int | None:
    """A time as seconds and nanoseconds, in ns; None of anything else."""
    parts = dict(_parts(value) or ())
    whole = next((parts[name] for name in _SECONDS if name in parts), None)
    rest = next((parts[name] for name in _NANOSECONDS if name in parts), None)
    return int(whole) * 10**9 + int(rest) if isinstance(whole, int) and isinstance(rest, int) else None


def _stamp(message: Any) -> int | None:
    """When what a message holds was measured, in ns; None where it does not say, or says zero."""
    for name, value in _parts(message) or ():
        if name in _STAMPS:
            found = _ticks(value)
            return (found if found is not None else _stamp(value)) or None
    return None


def _numbers(value: Any, name: str, unit: str, depth: int, units: dict[str, str]) -> Iterator[tuple[str, float]]:
    """Each number in a message by the names of the fields that lead to it; units are noted where they are known."""
    if isinstance(value, bool | np.bool_ | str | bytes) or value is None or depth > _DEEPEST or _PASSED in name:
        return
    if isinstance(value, int | float | np.number):
        if unit:
            units[name] = unit
        yield name, float(value)
        return
    parts = _parts(value)
    if parts is not None:
        fields = dict(parts)
        kind = str(getattr(value, "__msgtype__", "")).rpartition("/")[2]
        if _ticks(value) is not None:
            return
        called = fields.get("name")  # of joints, which stand in lists beside it
        for key, inner in fields.items():
            of_list = called if isinstance(called, list) and _length(inner) == len(called) else None
            path = f"{name} {key}".strip()
            yield from _each(inner, path, _UNITS.get((kind, key), unit), depth + 1, units, of_list)
        return
    yield from _each(value, name, unit, depth, units, None)


def _each(
    value: Any, name: str, unit: str, depth: int, units: dict[str, str], called: list[Any] | None
) -> Iterator[tuple[str, float]]:
    """The numbers of a field, of a list those of each element by its place from 1, or by what it is called."""
    length = _length(value)
    if length is None:
        yield from _numbers(value, name, unit, depth, units)
    elif length <= _LONGEST:
        for place, element in enumerate(value):
            label = called[place] if called is not None else place + 1
            yield from _numbers(element, f"{name} {label}", unit, depth + 1, units)


def _length(value: Any) -> int | None:
    return len(value) if isinstance(value, list | tuple | np.ndarray) else None
