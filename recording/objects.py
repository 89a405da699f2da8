"""What programs hold in memory, made into tables: pandas and xarray objects, SEP 5 dictionaries, arrays by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import BadInput
from .channels import Channel, table_of, tables_of_tree
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
        raise BadInput(f"{name}: holds no vector of numbers; give arrays by name")
    return tables


def is_sep5(data: Any) -> bool:
    """Whether it is a SEP 5 dictionary."""
    return isinstance(data, Mapping) and "data" in data and not isinstance(data["data"], Mapping) and "name" in data


def _of_frame(data: Any, name: str) -> Table:
    channels = [Channel(str(label), np.asarray(data[label])) for label in dict.fromkeys(data.columns)]
    index = np.asarray(data.index)
    if index.dtype.kind in "mM":
        seconds = (index - index[0]) / np.timedelta64(1, "s")
        channels.insert(0, Channel("time", seconds.astype(float), "s"))
    elif index.dtype.kind == "f" or (index.dtype.kind in "iu" and data.index.name):
        channels.insert(0, Channel(str(data.index.name or "time"), index))
    return _of_numbers(name, channels)


def _of_xarray(data: Any, name: str) -> Table:
    if not hasattr(data, "data_vars"):
        data = data.to_dataset(dim=min(data.dims, key=lambda d: data.sizes[d])) if data.ndim == 2 else {
            str(data.name or "response"): data
        }  # fmt: skip
    variables = dict(getattr(data, "data_vars", data))
    arrays = {**{str(k): v for variable in variables.values() for k, v in variable.coords.items()}, **variables}
    channels = []
    for key, array in arrays.items():
        if array.ndim != 1:
            continue
        values, unit = np.asarray(array), str(array.attrs.get("units") or array.attrs.get("unit") or "")
        if values.dtype.kind in "mM":
            values, unit = ((values - values[0]) / np.timedelta64(1, "s")).astype(float), "s"
        channels.append(Channel(str(key), values, unit))
    return _of_numbers(name, channels)


def _of_sep5(data: Sequence[Mapping[str, Any]], name: str) -> Table:
    channels = [
        Channel(str(series["name"]), np.asarray(series["data"]), str(series.get("unit_str") or "")) for series in data
    ]
    if any(channel.values.ndim != 1 or channel.values.shape != channels[0].values.shape for channel in channels):
        raise BadInput(f"{name}: the SEP 5 'data' must be vectors of one length; give records one by one")
    rates = {float(series["fs"]) for series in data if series.get("fs") is not None}
    if len(rates) > 1:
        raise BadInput(f"{name}: the SEP 5 dictionaries have the rates {sorted(rates)} Hz; give records one by one")
    stamps = next((series[key] for series in data for key in ("time", "t") if series.get(key) is not None), None)
    if stamps is not None:
        channels.insert(0, Channel("time", np.asarray(stamps, float), "s"))
    return _of_numbers(name, channels, rates.pop() if rates else None)


def _of_numbers(name: str, channels: Sequence[Channel], fs: float | None = None) -> Table:
    numeric = [channel for channel in channels if channel.values.dtype.kind in "iuf" and channel.values.ndim == 1]
    if not numeric:
        raise BadInput(f"{name}: holds no vector of numbers; give arrays by name")
    return table_of(name, numeric, fs)
