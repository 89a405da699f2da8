"""MDF files (ASAM MDF, version 3 and 4): each group of channels with times of its own is a record."""

from __future__ import annotations

import io

import numpy as np

from ..channels import Channel, passed_over, table_of
from ..content import too_large
from ..table import Table


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file, conversions applied; groups that bear the same times are channels of one record.

    Raises:
        BadInput: it holds more than ``most`` MB.
        ModuleNotFoundError: without asammdf.
    """
    from asammdf import MDF  # pyright: ignore[reportMissingImports]

    groups: dict[bytes, tuple[np.ndarray, str, list[Channel]]] = {}
    passed: dict[str, str] = {}
    with MDF(io.BytesIO(content)) as file:
        if sum(g.channel_group.cycles_nr * len(g.channels) for g in file.groups) * 8 > most * 1e6:
            raise too_large(where, most)
        for place, group in enumerate(file.groups):
            master = file.masters_db.get(place)
            if group.channel_group.cycles_nr < 2:
                continue
            for index, channel in enumerate(group.channels):
                if index == master:
                    continue
                signal = file.get(group=place, index=index)
                values = np.asarray(signal.samples)
                if values.ndim != 1 or values.dtype.kind not in "iuf":
                    passed[channel.name] = f"{values.ndim} dimensions" if values.ndim != 1 else "text"
                    continue
                times = np.asarray(signal.timestamps, float)
                label = str(getattr(group.channel_group, "acq_name", "") or f"group{place + 1}")
                into = groups.setdefault(times.tobytes(), (times, label, []))
                into[2].append(Channel(channel.name, values, str(signal.unit or "")))
    labels = [label for _, label, _ in groups.values()]
    tables = []
    for number, (times, label, channels) in enumerate(groups.values(), start=1):
        record = (label if labels.count(label) == 1 else f"{label}@{number}") if len(groups) > 1 else ""
        place_of = f"{where}#{record}" if record else where
        stamps = [Channel("time", times - times[0] if times[0] > 0 else times, "s")]
        tables.append(table_of(place_of, [*stamps, *channels], None, record, passed_over(place_of, passed)))
    return tables
