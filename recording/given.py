"""Whatever a person hands over as recordings, made into Recordings: files, arrays, data frames, SEP 5, Recordings."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from itertools import count
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from ..errors import BadInput
from .objects import is_sep5, tables_of_object
from .part import parse_part
from .read import read_records, recording_of
from .recording import Recording


class Reading(TypedDict, total=False):
    """How recordings are to be read, as the options of the commands; all may be left out.

    ``time``, ``force``, ``response``: columns by name, pattern or number from 1, "none" for no force; several responses
    as a list; the force that belongs to one array as an array (n,). ``quantity``: displacement, velocity or
    acceleration. ``unit``, ``force_unit``: such as "mm", "kN". ``calibration``: such as {"force": "22.4 N/V"}. ``fs``:
    sampling frequency, Hz. ``part``: seconds to use, "2:30" or (2.0, 30.0). ``hold``: zero, linear or smooth.
    ``max_size``: largest file, MB unpacked.
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
    max_size: float


def recordings_of(*given: Any, **options: Unpack[Reading]) -> list[Recording]:
    """The recordings that are meant, in order.

    Args:
        given: each a Recording (taken as it is, whatever the options), a path (all records of the file), a DataFrame,
            an xarray Dataset or DataArray, SEP 5 dictionaries, arrays by name such as
            {"time_s": t, "force_N": f, "displacement_m": x}, one array (n,) with ``fs``, or any of these in a list.
        options: see ``Reading``.

    Raises:
        BadInput: something is none of these, or is wrong; one sentence for each thing.
        TypeError: there is no such option.
    """
    if unknown := sorted(set(options) - set(Reading.__annotations__)):
        near = get_close_matches(unknown[0], Reading.__annotations__, 1)
        raise TypeError(
            f"there is no option '{unknown[0]}'; "
            + (f"did you mean {near[0]}?" if near else f"options of reading are {', '.join(Reading.__annotations__)}")
        )
    how: dict[str, Any] = dict(options)
    if isinstance(how.get("part"), str):
        how["part"] = parse_part(how["part"]) if how["part"] else None
    several = how.pop("response", None)
    columns = list(several) if isinstance(several, list | tuple) else [several]
    if len(columns) > 1 and (stated := next((name for name in ("quantity", "unit") if how.get(name)), None)):
        raise BadInput(f"--{stated} cannot be that of {len(columns)} responses; state the units in the columns' names")
    number, made = count(1), []
    for one in _each(given):
        if isinstance(one, Recording):
            made.append(one)
            continue
        for column in columns or [None]:
            for recording in _read(one, next(number), how | {"response": column}):
                named = f"{recording.name} ({column})" if len(columns) > 1 else recording.name
                made.append(replace(recording, name=named))
    return made


def _each(given: Iterable[Any]) -> Iterable[Any]:
    """What is given, lists of several taken apart."""
    for one in given:
        if isinstance(one, Mapping) and one and all(isinstance(v, str | os.PathLike | Recording) for v in one.values()):
            yield from _each(one.values())  # files by a name of their own
        elif isinstance(one, Sequence) and one and all(isinstance(v, int | float | np.number) for v in one):
            yield np.asarray(one, float)
        elif _is_one(one):
            yield one
        else:
            yield from _each(one)


def _is_one(given: Any) -> bool:
    """Whether something is not several things."""
    if isinstance(given, str | os.PathLike | Recording | Mapping | np.ndarray) or not isinstance(given, Iterable):
        return True
    if hasattr(given, "columns") or hasattr(given, "dims"):  # of pandas, of xarray
        return True
    return isinstance(given, Sequence) and len(given) > 0 and all(is_sep5(series) for series in given)


def _read(one: Any, number: int, how: dict[str, Any]) -> list[Recording]:
    if isinstance(one, str | os.PathLike):
        if isinstance(how.get("force"), np.ndarray):
            raise BadInput(f"{one}: is a file, so --force names its column; an array of forces belongs to an array")
        return read_records(Path(one), **how)
    name, how = f"recording {number}", {key: value for key, value in how.items() if key != "max_size"}
    if isinstance(one, np.ndarray):
        one, how = _named(one, name, how)
    return [recording_of(table, **how) for table in tables_of_object(one, name)]


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
        arrays["force"] = force if isinstance(force, np.ndarray) else np.asarray(force)
        how = how | {"force": "force"}
    return arrays, how | {"response": "response"}
