"""What programs hold in memory, made into tables: pandas and xarray objects, SEP 5 dictionaries, arrays by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import BadInput
from .channels import Channel, passed_over, table_of, tables_of_tree, text_of_name
from .plain_numbers import Numbers, numbers_of, vector_of
from .table import Table


def tables_of_object(data: Any, name: str) -> list[Table]:
    """The records of an object.

    Args:
        data: a pandas DataFrame (a named or a floating-point index is the time); an xarray Dataset, or DataArray with
            one or two dimensions (the coordinate of the longest is the time); one SEP 5 dictionary or several; or a
            mapping of names to arrays and numbers such as fs, in groups for several records.
        name: for messages.

    Raises:
        BadInput: it is none of these, or holds no numbers.
    """
    if hasattr(data, "columns") and hasattr(data, "index"):
        tables = [_of_frame(data, name)]
    elif hasattr(data, "dims") and hasattr(data, "coords"):
        tables = [_of_xarray(data, name)]
    elif is_sep5(data):
        tables = [_of_sep5([data], name)]
    elif isinstance(data, Sequence) and data and all(is_sep5(series) for series in data):
        tables = [_of_sep5(data, name)]
    elif isinstance(data, Mapping):
        tables = tables_of_tree(name, data)
    else:
        raise BadInput(
            f"{name}: {type(data).__name__} is no kind of recording; give a path, a DataFrame, an xarray Dataset, "
            "SEP 5 dictionaries, or a dictionary of arrays by name"
        )
    if not tables:
        held = data.items() if isinstance(data, Mapping) else ()
        raise no_numbers(name, {text_of_name(k): numbers_of(v).kind for k, v in held if not isinstance(v, Mapping)})
    return tables


def no_numbers(name: str, kinds: Mapping[str, str]) -> BadInput:
    """That nothing in an object is a channel, with what its columns hold, by name."""
    held = passed_over(name, {label: kind for label, kind in kinds.items() if kind})
    what = held[0].removeprefix(f"{name}: passed over, as ") if held else "no vector of numbers"
    return BadInput(f"{name}: holds {what}; give arrays of numbers by name")


def is_sep5(data: Any) -> bool:
    """Whether it is a SEP 5 dictionary."""
    return isinstance(data, Mapping) and "data" in data and not isinstance(data["data"], Mapping) and "name" in data


def _of_frame(data: Any, name: str) -> Table:
    found = {text_of_name(label): numbers_of(data[label]) for label in dict.fromkeys(data.columns)}
    index = numbers_of(data.index)
    if index.values is not None and (index.unit or index.values.dtype.kind == "f" or data.index.name):
        found = {"time" if index.unit else str(data.index.name or "time"): _since_first(index), **found}
    return _of_numbers(name, found)


def series_of(data: Any) -> tuple[str, np.ndarray, np.ndarray | None]:
    """A series of pandas or polars: its name (``response`` where it has none), values (n,) and, by the index, times.

    The index is the time in s where it is one of times, durations or floats, or has a name; else there is None.
    """
    name, index = str(data.name or "response"), getattr(data, "index", None)
    values = vector_of(data, name)
    stamps = None if index is None or callable(index) else numbers_of(index)
    if stamps is None or stamps.values is None:
        return name, values, None
    told = stamps.unit or stamps.values.dtype.kind == "f" or getattr(index, "name", None)
    return name, values, np.asarray(_since_first(stamps).values, float) if told else None


def is_series(data: Any) -> bool:
    """Whether it is one column of pandas or polars."""
    return (
        hasattr(data, "to_numpy")
        and hasattr(data, "name")
        and not hasattr(data, "columns")
        and not hasattr(data, "dims")
    )


def _since_first(index: Numbers) -> Numbers:
    """An index of times or durations, from its first on."""
    values = index.values
    return index if values is None or not index.unit or not values.size else index._replace(values=values - values[0])


def _of_xarray(data: Any, name: str) -> Table:
    if not hasattr(data, "data_vars"):
        data = data.to_dataset(dim=min(data.dims, key=lambda d: data.sizes[d])) if data.ndim == 2 else {
            str(data.name or "response"): data
        }  # fmt: skip
    variables = dict(getattr(data, "data_vars", data))
    arrays = {**{str(k): v for variable in variables.values() for k, v in variable.coords.items()}, **variables}
    channels: dict[str, Numbers] = {}
    for key, array in arrays.items():
        if array.ndim != 1:
            continue
        unit = str(array.attrs.get("units") or array.attrs.get("unit") or "")
        numbers = numbers_of(array.values)
        channels[str(key)] = _since_first(numbers) if numbers.unit else numbers._replace(unit=unit)
    return _of_numbers(name, channels)


def _of_sep5(data: Sequence[Mapping[str, Any]], name: str) -> Table:
    made = [(str(series["name"]), numbers_of(series["data"]), str(series.get("unit_str") or "")) for series in data]
    shapes = {np.shape(numbers.values) for _, numbers, _ in made if numbers.values is not None}
    if any(len(shape) != 1 for shape in shapes) or len(shapes) > 1:
        raise BadInput(f"{name}: the SEP 5 'data' must be vectors of one length; give records one by one")
    rates = {_stated_rate(series["fs"], name) for series in data if series.get("fs") is not None}
    if len(rates) > 1:
        raise BadInput(f"{name}: the SEP 5 dictionaries have the rates {sorted(rates)} Hz; give records one by one")
    stamps = next((series[key] for series in data for key in ("time", "t") if series.get(key) is not None), None)
    channels = [Channel(label, numbers.values, unit) for label, numbers, unit in made if numbers.values is not None]
    passed = {label: numbers.kind for label, numbers, _ in made if numbers.values is None}
    if stamps is not None:
        times = numbers_of(stamps)
        if times.values is None or times.values.ndim != 1:
            raise BadInput(
                f"{name}: the time of the SEP 5 dictionaries holds {times.kind or 'no vector'}; give seconds"
            )
        channels.insert(0, Channel("time", times.values, "s"))
    if not channels or not shapes:
        raise no_numbers(name, passed)
    return table_of(name, channels, rates.pop() if rates else None, notes=passed_over(name, passed))


def _stated_rate(given: Any, name: str) -> float:
    numbers = numbers_of(given).values
    if numbers is None or numbers.size != 1 or not (np.isfinite(numbers) & (numbers > 0)).all():
        raise BadInput(f"{name}: 'fs' is {str(given)[:40]!r}, which is no sampling rate; give it in Hz")
    return float(numbers.reshape(()))


def _of_numbers(name: str, found: Mapping[str, Numbers]) -> Table:
    channels = [
        Channel(label, numbers.values, numbers.unit)
        for label, numbers in found.items()
        if numbers.values is not None and numbers.values.ndim == 1
    ]
    passed = {
        label: numbers.kind or "several dimensions"
        for label, numbers in found.items()
        if numbers.values is None or numbers.values.ndim != 1
    }
    if not channels:
        raise no_numbers(name, passed)
    return table_of(name, channels, notes=passed_over(name, passed))
