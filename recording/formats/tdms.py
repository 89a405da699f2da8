"""TDMS files of LabVIEW: each group is a record, wf_increment its sampling interval."""

from __future__ import annotations

import io

import numpy as np

from ...errors import BadInput
from ..channels import Channel, table_of
from ..content import too_large
from ..table import Table


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file: channels of one group and one rate.

    Raises:
        BadInput: it holds more than ``most`` MB, or its last segment is not whole.
        ModuleNotFoundError: without nptdms.
    """
    from nptdms import TdmsFile

    groups: list[tuple[str, float, list[Channel]]] = []
    with TdmsFile.open(io.BytesIO(content)) as file:
        if file.file_status.incomplete_final_segment:
            raise BadInput(f"{where} is cut short, its last segment is not whole; copy it again, or export it as CSV")
        channels = [(group.name, channel) for group in file.groups() for channel in group.channels()]
        numeric = [pair for pair in channels if pair[1].dtype is not None and pair[1].dtype.kind in "iuf"]
        if sum(len(channel) for _, channel in numeric) * 8 > most * 1e6:
            raise too_large(where, most)
        for group, channel in numeric:
            if len(channel) < 2:
                continue
            interval = float(channel.properties.get("wf_increment", 0.0))
            unit = str(channel.properties.get("unit_string", "") or "")
            made = Channel(channel.name, np.asarray(channel[:]), unit)
            key = (group, interval)
            into = next((known for name, dt, known in groups if (name, dt) == key), None)
            if into is None:
                groups.append((*key, [made]))
            else:
                into.append(made)
    names = [name for name, _, _ in groups]
    tables = []
    for i, (name, interval, channels_of) in enumerate(groups):
        record = name if names.count(name) == 1 else f"{name}@{1 / interval:g}Hz" if interval > 0 else f"{name}@{i + 1}"
        record = record if len(groups) > 1 else ""
        fs = 1.0 / interval if interval > 0 else None
        tables.append(table_of(f"{where}#{record}" if record else where, channels_of, fs, record))
    return tables
