"""The files that the commands get: recordings as they lie in the data folder, or a part of one, written as CSV."""

from __future__ import annotations

import gzip
import importlib.util
import os
import shutil
from pathlib import Path

import numpy as np

from .entry import Columns, Entry, Piece

#: Of the camera above the magnet's pendulum and of the pendulum itself, as its authors have them.
_MM_PER_PIXEL = 148 / 654
_PLATE_TO_MAGNET_MM = 110.0


def data_folder() -> Path:
    """Where the recordings are: $DASHPOT_DATA, or shared/data beside the checkout."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    return Path(os.environ.get("DASHPOT_DATA") or beside)


def source(piece: Piece, folder: Path) -> Path:
    """The file that a piece is taken from, whether or not it is there."""
    if not piece.source.startswith("stand/"):
        return folder / piece.source
    package = importlib.util.find_spec("dashpot.examples")
    if package is None or package.origin is None:
        raise FileNotFoundError("the package dashpot.examples is not installed; run `make setup`")
    name = piece.source.removeprefix("stand/")
    return Path(package.origin).parent / "recordings" / "paper-stand-backlash" / name


def absent(entry: Entry, folder: Path) -> list[str]:
    """Files of an entry that are not in the folder."""
    return sorted({piece.source for piece in entry.pieces if not source(piece, folder).is_file()})


def table(path: Path) -> tuple[list[str], np.ndarray]:
    """Header and (n, columns) numbers of a CSV file, gzipped or not."""
    opener = gzip.open if path.suffix == ".gz" else open
    with opener(path, "rt", encoding="utf-8") as file:
        head = file.readline().strip().split(",")
        return head, np.loadtxt(file, delimiter=",", ndmin=2)


def prepare(entry: Entry, folder: Path, work: Path) -> None:
    """Put the pieces of an entry into the folder `work`, under the names that the commands see."""
    work.mkdir(parents=True, exist_ok=True)
    for piece in entry.pieces:
        if piece.rows is None and not piece.made:
            shutil.copyfile(source(piece, folder), work / piece.file)
            continue
        head, numbers = table(source(piece, folder))
        first, last = piece.rows or (0, len(numbers))
        numbers = numbers[first:last]
        if piece.made == "plate-angle":
            head, numbers = _plate_angle(head, numbers)
        np.savetxt(work / piece.file, numbers, "%.9g", ",", header=",".join(head), comments="")


def _plate_angle(head: list[str], numbers: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Angle in the plane of x, rad, of a pendulum that is filmed along its axis: its height follows from both."""
    time, x, y = (numbers[:, head.index(name)] for name in ("time_s", "x_px", "y_px"))
    x, y = _MM_PER_PIXEL * x, _MM_PER_PIXEL * y
    height = np.sqrt(np.maximum(_PLATE_TO_MAGNET_MM**2 - x**2 - y**2, 0.0))
    return ["time_s", "phi_rad"], np.column_stack([time, np.arctan2(x, height)])


def signals(columns: Columns, path: Path) -> tuple[float, np.ndarray, np.ndarray | None]:
    """Sampling interval in s, response (n,) and force (n,) or None of a piece, for the plain fit."""
    head, numbers = table(path)
    response = numbers[:, head.index(columns.response)]
    force = None if columns.force is None else numbers[:, head.index(columns.force)]
    if columns.fs is not None:
        return 1 / columns.fs, response, force
    time = numbers[:, head.index(columns.time)] if columns.time else np.arange(len(numbers))
    return float((time[-1] - time[0]) / (time.size - 1)), response, force
