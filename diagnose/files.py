"""A diagnosis as files in one folder: all of them or none."""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..files.writing import check_ours, remove, together, writable, write
from ..identify.signals.registry import budget
from ..model.file import dumps
from .result import Diagnosis, Experiment

_HEAD = budget(100_000, "bytes", why="of a model description: who made it stands in its first lines")

DIAGNOSIS, MODEL, FMU, EXPERIMENT, REPORT = (
    "diagnosis.json",
    "model.yaml",
    "model.fmu",
    "next_experiment.csv",
    "report.html",
)


def check_folder(folder: Path) -> None:
    """Make sure that the files can be written, before long work is done for them.

    Raises:
        BadInput: where they cannot be, or one of them is there and no diagnosis made it.
    """
    if folder.exists() and not folder.is_dir():
        raise BadInput(f"{folder}: is a file; name a folder for the diagnosis")
    check_ours(folder / DIAGNOSIS, b'"dashpot-diagnosis/', "a diagnosis")
    before = (folder / DIAGNOSIS).exists()
    for name in (DIAGNOSIS, MODEL, FMU, EXPERIMENT, REPORT):
        writable(folder / name)
        if (folder / name).exists() and not (before and (name != FMU or _is_ours(folder / name))):
            raise BadInput(f"{folder / name}: is there and was not made by a diagnosis; choose another folder")


def _is_ours(fmu: Path) -> bool:
    """Whether an FMU says that dashpot made it."""
    try:
        with zipfile.ZipFile(fmu) as archive, archive.open("modelDescription.xml") as description:
            return b'generationTool="dashpot' in description.read(_HEAD)
    except (OSError, KeyError, ValueError, RuntimeError, EOFError, zlib.error, zipfile.BadZipFile):
        return False


def write_folder(folder: Path, diagnosis: Diagnosis, report: str, fmu: bytes | None) -> list[Path]:
    """Write what a diagnosis says; returns the paths written.

    Args:
        folder: made where it is missing.
        diagnosis: the outcome.
        report: the HTML page.
        fmu: the mended model as an FMU; None where nothing was mended or nothing could be compiled.
    """
    texts: Mapping[str, str | bytes | None] = {
        DIAGNOSIS: json.dumps(diagnosis.as_json(), indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        MODEL: dumps(diagnosis.model),
        FMU: fmu,
        EXPERIMENT: experiment_csv(diagnosis.experiment),
        REPORT: report,
    }
    written = []
    with together():
        for name, text in texts.items():
            if text is None:
                remove(folder / name)  # that of an earlier diagnosis would not belong to this one
                continue
            write(folder / name, text)
            written.append(folder / name)
    return written


def experiment_csv(experiment: Experiment | None) -> str | None:
    """The force to play as CSV with the columns time_s and force; None where there is none."""
    if experiment is None or experiment.signal is None:
        return None
    time = np.arange(experiment.signal.size) / experiment.fs
    rows = (f"{t:.9g},{f:.9g}\n" for t, f in zip(time, experiment.signal, strict=True))
    return "time_s,force\n" + "".join(rows)
