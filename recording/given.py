"""Whatever a person hands over as recordings, made into Recordings: files, arrays, data frames, SEP 5, Recordings."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any, TypedDict, Unpack

import numpy as np

from ..errors import BadInput, TellsNothing
from ..files.arguments import known_options, number_of, path_of, shown, text_of
from .channel import Channel, Stated, check_count, of_value, refuse_gaps, stated_channels
from .checks import not_a_number, out_of_range
from .content import MOST_MB
from .objects import is_sep5, tables_of_object
from .part import part_of
from .plain_numbers import vector_of
from .read import recording_of, tables_at
from .recording import Recording

#: Lists within lists in which recordings are sought: rigs of tests of files, and as much again.
_DEEPEST = 6


class Reading(TypedDict, total=False):
    """How recordings are to be read, as the options of the commands; all may be left out.

    ``time``, ``force``, ``response``: columns by name, pattern or number from 1, "none" for no force; several responses
    as a list; the force that belongs to one array as an array (n,). ``quantity``: displacement, velocity or
    acceleration. ``unit``, ``force_unit``: such as "mm", "kN". ``calibration``: such as {"force": "22.4 N/V"}. ``fs``:
    sampling frequency, Hz. ``part``: seconds to use, "2:30" or (2.0, 30.0). ``hold``: zero, linear or smooth.
    ``base``: column of the motion of the rig's base, in place of a force; ``relative``: whether the response is
    relative to it; ``through``: spring or damper, whose one end the base moves. ``prescribed``: column of a motion that
    was imposed, the force being what it took. ``channels``: by name what the rig may depend on, such as
    {"current": "0.5 A"}, {"temperature": "T_oil_degC"} (a column), an array (n,) under "pressure_bar", or a list of
    these in the order of the recordings. ``max_size``: largest file, MB unpacked.
    """

    time: str | int | None
    force: Any
    response: str | int | Sequence[str | int] | None
    quantity: str | None
    unit: str | None
    force_unit: str | None
    calibration: Mapping[str, str | float] | None
    fs: float | None
    part: str | tuple[float, float] | None
    hold: str | None
    base: str | int | None
    relative: bool | None
    through: str | None
    prescribed: str | int | None
    channels: Any
    max_size: float


def recordings_of(*given: Any, **options: Unpack[Reading]) -> list[Recording]:
    """The recordings that are meant, in order.

    Args:
        given: each a Recording (as it is, where all of it is numbers), a path (all records of the file), a DataFrame,
            an xarray Dataset or DataArray, SEP 5 dictionaries, arrays by name such as
            {"time_s": t, "force_N": f, "displacement_m": x}, one array (n,) with ``fs``, or any of these in a list.
        options: see ``Reading``.

    Raises:
        BadInput: something is none of these, or is wrong; one sentence for each thing. Of several recordings one that
            tells nothing of its rig (at rest, held, too short) is left out, and a note of the first one says so.
        TypeError: there is no such option.
    """
    known_options(options, Reading.__annotations__)
    how = _checked(options)
    several = how.pop("response", None)
    columns = list(several) if isinstance(several, list | tuple) else [several]
    if len(columns) > 1 and (stated := next((name for name in ("quantity", "unit") if how.get(name)), None)):
        raise BadInput(f"--{stated} cannot be that of {len(columns)} responses; state the units in the columns' names")
    number, made, mute = count(1), [], []
    stated, meant = how.pop("channels", ()), list(_each(given))
    for channel in stated:
        check_count(channel, len(meant))
    for place, one in enumerate(meant):
        own = [channel.of(place, _called(one, place)) for channel in stated]
        if isinstance(one, Recording):
            for problem in not_a_number(one) or out_of_range(one):
                raise BadInput(problem.sentence)
            made.append(_with_channels(one, own))
            continue
        for column in columns or [None]:
            for make in _read(one, next(number), how | {"response": column, "channels": own}):
                try:
                    recording = make()
                except TellsNothing as problem:
                    mute.append(problem)
                    continue
                named = f"{recording.name} ({column})" if len(columns) > 1 else recording.name
                made.append(replace(recording, name=named))
    if mute and not made:
        raise mute[0] if len(mute) == 1 else TellsNothing("\n".join(map(str, mute)))
    if mute:
        left_out = [f"{problem}; it was left out, as others were recorded" for problem in mute]
        made[0] = replace(made[0], notes=(*made[0].notes, *left_out))
    return made


def _checked(options: Mapping[str, Any]) -> dict[str, Any]:
    """The options with a part in seconds, each of its type; raises BadInput for the first that is not."""
    how = {name: value for name, value in options.items() if value is not None}
    for name in ("quantity", "unit", "force_unit", "hold"):
        if name in how:
            text_of(how[name], name)
    for name in ("fs", "max_size"):
        if name in how:
            how[name] = number_of(how[name], name)
    if "calibration" in how:
        if not isinstance(how["calibration"], Mapping):
            raise BadInput(f'calibration is such as {{"force": "22.4 N/V"}}, not {shown(how["calibration"])}')
        for column, factor in how["calibration"].items():
            text_of(column, "a column of calibration")
            if not isinstance(factor, str):
                number_of(factor, f"the calibration of {shown(column)}")
    if "part" in how:
        how["part"] = part_of(how["part"])
    if "channels" in how:
        how["channels"] = stated_channels(how["channels"])
    return how


def _called(one: Any, place: int) -> str:
    """What a thing is called where its channels are given by name."""
    if isinstance(one, Recording):
        return one.name
    return os.fspath(one) if isinstance(one, str | os.PathLike) else f"recording {place + 1}"


def _with_channels(recording: Recording, stated: Sequence[Stated]) -> Recording:
    """A recording as it is, with further channels; one that it has already is taken by its name."""
    known = {channel.name: channel for channel in recording.channels}
    for one in stated:
        if one.column is not None:
            if str(one.column) not in known:
                raise BadInput(
                    f"{recording.name}: is no file, and has no channel {one.column}; give the channel as an array"
                )
            continue
        found = of_value(one, recording.name)
        if found.rows is not None:
            refuse_gaps(recording.name, found.name, found.rows)
        values = found.rows if found.rows is not None else float(found.number or 0.0)
        known[found.name] = Channel(found.name, found.unit, values)
    return replace(recording, channels=tuple(known.values())) if stated else recording


def _each(given: Iterable[Any], depth: int = 0) -> Iterable[Any]:
    """What is given, lists of several taken apart."""
    if depth > _DEEPEST:
        raise BadInput(f"lists within lists, more than {_DEEPEST} deep, hold no recordings; give them in one list")
    for one in given:
        if isinstance(one, Mapping) and one and all(isinstance(v, str | os.PathLike | Recording) for v in one.values()):
            yield from _each(one.values(), depth + 1)  # files by a name of their own
        elif _is_one(one):
            yield one
        elif isinstance(one, range) or _is_of_numbers(one):
            yield vector_of(one, shown(one))
        else:
            yield from _each(one, depth + 1)


def _is_of_numbers(given: Any) -> bool:
    return isinstance(given, Sequence) and len(given) > 0 and all(isinstance(v, int | float | np.number) for v in given)


def _is_one(given: Any) -> bool:
    """Whether something is not several things."""
    if isinstance(given, str | bytes | bytearray | os.PathLike | Recording | Mapping | np.ndarray) or not isinstance(
        given, Iterable
    ):
        return True
    if hasattr(given, "columns") or hasattr(given, "dims"):  # of pandas, of xarray
        return True
    return isinstance(given, Sequence) and len(given) > 0 and all(is_sep5(series) for series in given)


def _read(one: Any, number: int, how: dict[str, Any]) -> list[Callable[[], Recording]]:
    """What makes each recording of it, once the file or object is open."""
    if isinstance(one, str | os.PathLike):
        if isinstance(how.get("force"), np.ndarray):
            raise BadInput(f"{one}: is a file, so --force names its column; an array of forces belongs to an array")
        sha256, tables = tables_at(path_of(one), how.get("max_size", MOST_MB))
        how = {key: value for key, value in how.items() if key != "max_size"}
        return [partial(recording_of, table, sha256=sha256, **how) for table in tables]
    name, how = f"recording {number}", {key: value for key, value in how.items() if key != "max_size"}
    if isinstance(one, np.ndarray):
        one, how = _named(one, name, how)
    return [partial(recording_of, table, **how) for table in tables_of_object(one, name)]


def _named(signal: np.ndarray, name: str, how: dict[str, Any]) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """One array as arrays by name, with the options that are left."""
    if signal.ndim != 1:
        raise BadInput(
            f"{name}: an array of shape {signal.shape} does not say what its columns are; give arrays by name, such as "
            '{"time_s": t, "force_N": f, "displacement_m": x}'
        )
    if how.get("fs") is None:
        raise BadInput(f"{name}: an array says nothing of time; give its sampling frequency with fs, in Hz")
    arrays, force = {"response": signal}, how.get("force")
    if force is not None and not isinstance(force, str | int):
        arrays["force"] = vector_of(force, f"{name}: the force")
        how = how | {"force": "force"}
    return arrays, how | {"response": "response"}
