"""TDMS files of LabVIEW: each group is a record, wf_increment its sampling interval."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...errors import BadInput
from ..channels import Channel, passed_over, table_of
from ..content import too_large
from ..plain_numbers import numbers_of
from ..table import Table

#: Scales that nptdms applies.
_SCALES = frozenset(("Polynomial", "Linear", "RTD", "Strain", "Table", "Thermistor", "Thermocouple", "Add", "Subtract"))
_SCALE = re.compile(r"NI_Scale\[\d+\]_Scale_Type")


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file: channels of one group and one rate.

    Raises:
        BadInput: it holds more than ``most`` MB, its last segment is not whole, or a scale is of a kind not known.
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
        others = [channel for _, channel in channels if channel.dtype is None or channel.dtype.kind not in "iuf"]
        passed = {
            channel.name: ("" if channel.dtype is None else numbers_of(np.empty(0, channel.dtype)).kind) or "times"
            for channel in others
            if len(channel) >= 2
        }
        for group, channel in numeric:
            if len(channel) < 2:
                continue
            _check_scales(where, channel.name, (channel.properties, file[group].properties, file.properties))
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
        place = f"{where}#{record}" if record else where
        tables.append(table_of(place, channels_of, fs, record, passed_over(place, passed)))
    return tables


def _check_scales(where: str, name: str, levels: Sequence[Mapping[str, Any]]) -> None:
    """Raises BadInput for a scale that the library does not know: it would give back what the converter stored.

    Args:
        where, name: of the file and the channel.
        levels: properties of the channel, its group and its file; the first that states scales counts.
    """
    for properties in levels:
        scales = {key: str(value) for key, value in properties.items() if _SCALE.fullmatch(key)}
        if not scales:
            continue
        unknown = sorted(set(scales.values()) - _SCALES)
        if unknown and properties.get("NI_Scaling_Status", "unscaled") != "scaled":
            raise BadInput(
                f"{where}: the channel '{name}' has a scale of the kind '{unknown[0][:40]}', which cannot be applied; "
                "export it as CSV in its own units"
            )
        return
