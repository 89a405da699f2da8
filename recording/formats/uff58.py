"""Universal files with data sets 58, as modal analysis exchanges them: each time history is a channel."""

from __future__ import annotations

import contextlib
import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ..channels import Channel, table_of
from ..table import Table

_TIME_RESPONSE = 1  # function type of data set 58
#: Kind of the ordinate by its specific data type, and its unit in the SI that data sets 58 are in where they name none.
_ORDINATES = {
    8: ("displacement", "m"),
    9: ("force", "N"),
    11: ("velocity", "m/s"),
    12: ("acceleration", "m/s2"),
    13: ("force", "N"),
}
_DIRECTIONS = {1: "+X", 2: "+Y", 3: "+Z", -1: "-X", -2: "-Y", -3: "-Z", 4: "+RX", 5: "+RY", 6: "+RZ"}


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file; a channel that comes a second time, or at another rate, begins a further record."""
    import pyuff

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        path = Path(folder) / "content.uff"  # the library reads files by name
        path.write_bytes(content)
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in np.atleast_1d(file.get_set_types())]
        sets: list[Any] = [file.read_sets(i) for i, kind in enumerate(kinds) if kind == 58]
    groups: list[tuple[tuple[int, float], list[Channel]]] = []
    for data in sets:
        values = np.asarray(data["data"])
        if int(data["func_type"]) != _TIME_RESPONSE or values.dtype.kind not in "iuf":
            continue
        name, unit = _named(data)
        channel = Channel(name, values, unit)
        key = (values.size, _interval(data))
        if groups and groups[-1][0] == key and channel.name not in [other.name for other in groups[-1][1]]:
            groups[-1][1].append(channel)
        else:
            groups.append((key, [channel]))
    tables = []
    for number, ((_, interval), channels) in enumerate(groups, start=1):
        record = str(number) if len(groups) > 1 else ""
        fs = 1.0 / interval if interval > 0 else None
        tables.append(table_of(f"{where}#{record}" if record else where, channels, fs, record))
    return tables


def _interval(data: dict[str, Any]) -> float:
    """Of the samples, s: as stated, or between the first two stamps of a set with uneven abscissa."""
    if int(data.get("abscissa_spacing", 1)) == 1:
        return float(data["abscissa_inc"])
    stamps = np.asarray(data["x"], float)
    steps = np.diff(stamps)
    uniform = steps.size and np.allclose(steps, steps.mean(), rtol=1e-3)
    return float(steps.mean()) if uniform else 0.0


def _named(data: dict[str, Any]) -> tuple[str, str]:
    """Name and unit of a channel: the kind of its ordinate, node and direction, or what the first line calls it."""
    kind, si = _ORDINATES.get(int(data.get("ordinate_spec_data_type", 0)), ("", ""))
    label = str(data.get("ordinate_axis_units_lab", "")).strip()
    unit = "" if label.upper() in ("", "NONE", "NULL") else label
    direction = _DIRECTIONS.get(int(data.get("rsp_dir", 0)), "")
    place = f"{int(data.get('rsp_node', 0))}{direction}"
    title = str(data.get("id1", "")).strip()
    name = f"{kind} {place}" if kind else title if title.upper() not in ("", "NONE") else f"channel {place}"
    return name, unit or si
