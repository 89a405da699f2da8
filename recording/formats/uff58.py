"""Universal files with data sets 58, as modal analysis exchanges them: each time history is a channel."""

from __future__ import annotations

import contextlib
import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import BadInput
from ..channels import Channel, passed_over, table_of
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
    """The records of a file; a channel that comes a second time, or at another rate, begins a further record.

    Raises:
        BadInput: a data set holds another number of values, or of bytes, than it declares, or is not closed.
        ModuleNotFoundError: without pyuff.
    """
    import pyuff

    _check_closed(where, content)

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        path = Path(folder) / "content.uff"  # the library reads files by name
        path.write_bytes(content)
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in np.atleast_1d(file.get_set_types())]
        sets: list[Any] = [file.read_sets(i) for i, kind in enumerate(kinds) if kind == 58]
    groups: list[tuple[tuple[int, float, bytes], list[Channel]]] = []
    passed: dict[str, str] = {}
    for number, data in enumerate(sets, start=1):
        values = np.asarray(data["data"])
        _check_size(f"{where}, data set {number} of kind 58", data, values.size)
        name, unit = _named(data)
        if int(data["func_type"]) != _TIME_RESPONSE or values.dtype.kind not in "iuf":
            passed[name] = "complex numbers" if values.dtype.kind == "c" else f"function type {int(data['func_type'])}"
            continue
        channel = Channel(name, values, unit)
        interval = _interval(data)
        stamps = np.asarray(data["x"], float) if not interval else np.empty(0)
        key = (values.size, interval, stamps.tobytes())
        if groups and groups[-1][0] == key and channel.name not in [other.name for other in groups[-1][1]]:
            groups[-1][1].append(channel)
        else:
            groups.append((key, [Channel("time", stamps, "s"), channel] if stamps.size else [channel]))
    tables = []
    for number, ((_, interval, _), channels) in enumerate(groups, start=1):
        record = str(number) if len(groups) > 1 else ""
        fs = 1.0 / interval if interval > 0 else None
        place = f"{where}#{record}" if record else where
        tables.append(table_of(place, channels, fs, record, passed_over(place, passed)))
    return tables


def _check_closed(where: str, content: bytes) -> None:
    """Raises BadInput where a data set begins before the one before it has ended, or the last one has no end.

    A line of -1 stands before and behind each; between two there is nothing.
    """
    lines = [line.strip() for line in content.split(b"\n")]
    open_, cut = False, False
    for line in lines:
        if line == b"-1":
            open_ = not open_
        elif line.strip(b"\x1a\0") and not open_:
            cut = True
    if open_ or cut:
        raise BadInput(f"{where} is cut short or damaged, a data set in it has no end (-1); copy it again")


def _check_size(where: str, data: dict[str, Any], count: int) -> None:
    """Raises BadInput where the values read are not as many as the data set declares."""
    declared = int(data["num_pts"])
    if count != declared:
        raise BadInput(
            f"{where}: holds {count} values and declares {declared}: it is cut short or damaged; copy it again"
        )
    if not data.get("binary") or not data.get("n_bytes") or int(data["abscissa_spacing"]) == 0:
        return  # as text, not stated, or with abscissas of a width that writers do not agree in
    kind = int(data["ord_data_type"])
    size = declared * (8 if kind in (4, 6) else 4) * (2 if kind in (5, 6) else 1)
    if int(data["n_bytes"]) != size:
        raise BadInput(
            f"{where}: declares {int(data['n_bytes'])} bytes where its {declared} values take {size}: it is damaged; "
            "export it again"
        )


def _interval(data: dict[str, Any]) -> float:
    """Of the samples, s: as stated, or of the stamps that a set with uneven abscissa has, 0 where those are uneven."""
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
