"""A simulated response beside the measured one, as CSV."""

from __future__ import annotations

import gzip
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..files.writing import write
from .recording import Recording


def write_response(path: Path, recording: Recording, simulated: np.ndarray) -> None:
    """Write time, force, measured and simulated response, units in the header; gzipped where the name ends in .gz.

    Args:
        path: file to write, whole or not at all.
        recording: what was measured, (n,).
        simulated: (n,), in the unit of the recording's response.
    """
    unit = recording.unit.replace("/", "_")
    columns = {"time_s": recording.time}
    if recording.force is not None:
        columns[f"force_{recording.force_unit}"] = recording.force
    columns[f"{recording.quantity}_{unit}"] = recording.response
    columns[f"simulated_{recording.quantity}_{unit}"] = simulated
    write_columns(path, columns)


def write_columns(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    """Write columns (n,) under their names as CSV; gzipped where the name ends in .gz."""
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(columns), comments="")
    content = text.getvalue().encode("utf-8")
    write(path, gzip.compress(content, mtime=0) if path.suffix == ".gz" else content)
