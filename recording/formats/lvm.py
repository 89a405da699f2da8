"""LabVIEW measurements (LVM): text whose headers say separator, units and interval; each block of channels a record."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...errors import BadInput
from ..channels import Channel, table_of
from ..table import Table
from .delimited import text_of

#: What the software calls a column of times, and that of remarks.
_TIMES, _REMARKS = "X_Value", "Comment"


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a LabVIEW measurement.

    Raises:
        BadInput: it is none, or its channels have times of their own.
        ModuleNotFoundError: lvm_read is not there.
    """
    import lvm_read

    text = text_of(where, content, most)
    if not text.startswith("LabVIEW Measurement"):
        raise BadInput(f"{where} is no LabVIEW measurement; name it .txt or .csv where it is a table")
    read = lvm_read.read_str(text.replace("\r\n", "\n"))
    blocks = [read[number] for number in range(read["Segments"])]
    records = [f"block{number}" if len(blocks) > 1 else "" for number in range(1, len(blocks) + 1)]
    return [
        _table(f"{where}#{name}" if name else where, name, block) for name, block in zip(records, blocks, strict=True)
    ]


def _table(where: str, record: str, block: dict[str, Any]) -> Table:
    """The record of one block."""
    times: np.ndarray | None = None
    channels = []
    units = iter(block.get("Y_Unit_Label", []))
    for name, values in zip(
        (name.strip() for name in block["Channel names"]), np.asarray(block["data"]).T, strict=False
    ):
        if name == _REMARKS or np.all(np.isnan(values)):
            continue
        if name != _TIMES:
            channels.append(Channel(name, values, next(units, "").strip()))
        elif times is None:
            times = values
        elif not np.array_equal(values, times, equal_nan=True):
            raise BadInput(f"{where}: its channels have times of their own; export each as a file of its own")
    if not channels:
        raise BadInput(f"{where} has no channel of numbers; record or copy it again")
    stated, there = next(iter(block.get("Samples", [])), np.nan), channels[0].values.size
    notes = [f"{where}: {there} of the {stated:.0f} samples are there that its header states"] if stated > there else []
    if times is not None:
        return table_of(where, [Channel("time", times, "s"), *channels], None, record, notes)
    interval = float(next(iter(block.get("Delta_X", [])), 0.0))
    return table_of(where, channels, 1.0 / interval if interval > 0 else None, record, notes)
