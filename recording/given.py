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
from .beside import with_beside
from .by_amplitude import amplitudes_of, of_amplitude
from .channel import Channel, Stated, check_count, of_value, refuse_gaps, stated_channels
from .checks import not_a_number, out_of_range
from .content import MOST_MB
from .fact import changed
from .frequency import frequency_of
from .objects import is_sep5, is_series, series_of, tables_of_object
from .part import cut_out, part_of
from .plain_numbers import vector_of
from .read import parts_of, place_of, tables_at
from .recording import Recording

#: Lists within lists in which recordings are sought: rigs of tests of files, and as much again.
_DEEPEST = 6
#: Options that a recording can be given behind its reading.
_OF_A_RECORDING = ("part", "amplitude", "hold")


class Reading(TypedDict, total=False):
    """How recordings are to be read, as the options of the commands; all may be left out.

    ``time``, ``force``, ``response``: columns by name, pattern or number from 1, "none" for no force; several responses
    as a list; force, and times in s, that belong to one array as arrays (n,). ``quantity``: displacement, velocity or
    acceleration. ``unit``, ``force_unit``: such as "mm", "kN". ``calibration``: such as {"force": "22.4 N/V"}. ``fs``:
    sampling frequency in Hz, or such as "1 kHz". ``part``: seconds to use, "2:30" or (2.0, 30.0). ``amplitude``: of the
    motion to use, "5mm" (up to that), "1mm..5mm", "1mm..", or such in the SI unit of the response, 5e-3, (1e-3, 5e-3).
    ``hold``: zero,
    linear or smooth. ``base``: column of the motion of the rig's base, in place of a force; ``relative``: whether the
    response is relative to it; ``through``: spring or damper, whose one end the base moves. ``prescribed``: column of a
    motion that was imposed, the force being what it took. ``channels``: by name what the rig may depend on, such as
    {"current": "0.5 A"}, {"temperature": "T_oil_degC"} (a column), an array (n,) under "pressure_bar", or a list of
    these in the order of the recordings. ``max_size``: largest file, MB unpacked.
    """

    time: Any
    force: Any
    response: str | int | Sequence[str | int] | None
    quantity: str | None
    unit: str | None
    force_unit: str | None
    calibration: Mapping[str, str | float] | None
    fs: float | str | None
    part: str | tuple[float, float] | None
    amplitude: str | float | tuple[float, float] | None
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
        given: each a Recording (as it is, where all of it is numbers; ``part``, ``amplitude``, ``hold`` and a force of
            "none" apply to it, other options are refused where nothing else is read), a path (all records of the file),
            a DataFrame, an xarray Dataset or DataArray, SEP 5 dictionaries, arrays by name such as
            {"time_s": t, "force_N": f, "displacement_m": x}, one array (n,) with ``fs`` or ``time``, a Series, or any
            of these in a list.
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
            made += _again(_with_channels(one, own), how, alone=all(isinstance(each, Recording) for each in meant))
            continue
        for column in columns or [None]:
            for make in _read(one, next(number), how | {"response": column, "channels": own}):
                try:
                    parts = make()
                except TellsNothing as problem:
                    mute.append(problem)
                    continue
                named = f" ({column})" if len(columns) > 1 else ""
                made += [replace(recording, name=f"{recording.name}{named}") for recording in parts]
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
    if "fs" in how:
        how["fs"] = frequency_of(how["fs"])
    if "max_size" in how:
        how["max_size"] = number_of(how["max_size"], "max_size")
    if "calibration" in how:
        if not isinstance(how["calibration"], Mapping):
            raise BadInput(f'calibration is such as {{"force": "22.4 N/V"}}, not {shown(how["calibration"])}')
        for column, factor in how["calibration"].items():
            text_of(column, "a column of calibration")
            if not isinstance(factor, str):
                number_of(factor, f"the calibration of {shown(column)}")
    if "part" in how:
        how["part"] = part_of(how["part"])
    if "amplitude" in how:
        how["amplitude"] = amplitudes_of(how["amplitude"])
    if "channels" in how:
        how["channels"] = stated_channels(how["channels"])
    return how


def _called(one: Any, place: int) -> str:
    """What a thing is called where its channels are given by name."""
    if isinstance(one, Recording):
        return one.name
    return os.fspath(one) if isinstance(one, str | os.PathLike) else f"recording {place + 1}"


def _again(recording: Recording, how: Mapping[str, Any], *, alone: bool) -> list[Recording]:
    """What is wanted of a recording that was read already; options for reading belong to others beside it, if any."""
    useless = [name for name in how if name not in (*_OF_A_RECORDING, "max_size")]
    if how.get("force") == "none":
        useless.remove("force")
        recording = changed(recording, force=None)
    if useless and alone:
        raise BadInput(
            f"{recording.name}: was read already, and {useless[0]} says how to read; give it to read, or make the "
            "Recording with it"
        )
    if "part" in how:
        recording = cut_out(recording, how["part"])
    if "hold" in how:
        recording = changed(recording, hold=how["hold"])
    return of_amplitude(recording, how.get("amplitude"))


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
    if hasattr(given, "columns") or hasattr(given, "dims") or is_series(given):  # of pandas, polars, xarray
        return True
    return isinstance(given, Sequence) and len(given) > 0 and all(is_sep5(series) for series in given)


def _read(one: Any, number: int, how: dict[str, Any]) -> list[Callable[[], list[Recording]]]:
    """What makes the recordings of each record of it, once the file or object is open."""
    if isinstance(one, str | os.PathLike):
        _by_name(f"{one}: is a file", "its column", how)
        sha256, tables = tables_at(path_of(one), how.get("max_size", MOST_MB))
        how = {key: value for key, value in how.items() if key != "max_size"}
        how, told = with_beside(*place_of(path_of(one)), how)
        return [partial(told.each, partial(parts_of, table, how | {"sha256": sha256})) for table in tables]
    name, how = f"recording {number}", {key: value for key, value in how.items() if key != "max_size"}
    if isinstance(one, np.ndarray):
        one, how = _named({"response": one}, name, how)
    elif is_series(one):
        label, values, stamps = series_of(one)
        how = {"time": stamps} | how if stamps is not None and how.get("fs") is None else how
        one, how = _named({label: values}, name, how)
    else:
        _by_name(f"{name}: has columns of its own", "one of them", how)
    return [partial(parts_of, table, how) for table in tables_of_object(one, name)]


def _is_array(given: Any) -> bool:
    """Whether an option that may name a column holds its samples."""
    return given is not None and not isinstance(given, str | int | np.integer)


def _by_name(where: str, which: str, how: Mapping[str, Any]) -> None:
    """Raise BadInput where a force or times stand beside what has names for its columns."""
    for key, words in (("force", "forces"), ("time", "times")):
        if _is_array(how.get(key)):
            raise BadInput(f"{where}, so --{key} names {which}; an array of {words} belongs to an array")


def _named(
    arrays: dict[str, np.ndarray], name: str, how: dict[str, Any]
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """One array by its name as arrays by name, with the options that are left."""
    ((label, signal),) = arrays.items()
    if signal.ndim != 1:
        raise BadInput(
            f"{name}: an array of shape {signal.shape} does not say what its columns are; give arrays by name, such as "
            '{"time_s": t, "force_N": f, "displacement_m": x}'
        )
    if how.get("fs") is None and not _is_array(how.get("time")):
        raise BadInput(
            f"{name}: an array says nothing of time; give its sampling frequency with fs, in Hz, or its times with "
            "time, in s"
        )
    for key, words in (("force", "the force"), ("time", "the times")):
        if _is_array(how.get(key)):
            samples = vector_of(how[key], f"{name}: {words}")
            if samples.shape != signal.shape:
                raise BadInput(
                    f"{name}: the response has shape {signal.shape}, {words} {samples.shape}; give one for each sample"
                )
            arrays, how = arrays | {key: samples}, how | {key: key}
    return arrays, how | {"response": label}
