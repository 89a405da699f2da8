"""The picture of one recording: the whole of it and its largest motion, measured, simulated, and what is left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from dashpot.report.chart import Chart, Panel
from dashpot.report.decimate import envelope
from dashpot.report.style import AFTER, BEFORE, FORCED, MEASURED

from . import inputs
from .entry import Entry, Piece
from .examine import simulated_file

#: Cycles of the motion that are drawn one by one.
_CYCLES = 8.0
_BINS = 500
#: File, legend, colour, line.
_RUNS = (
    ("plain", "plain linear fit", FORCED, ":"),
    ("before", "identified", BEFORE, "--"),
    ("after", "mended", AFTER, "-"),
)


def draw(entry: Entry, piece: Piece, work: Path) -> Chart:
    """The whole recording, what each run leaves of it, and the largest motion: from what stands in `work`."""
    key = f"{entry.name}-{piece.file.partition('.')[0]}".replace("_", "-")
    chart = Chart(key, f"{entry.title}: {piece.file}")
    time, measured = _measured(entry, work / piece.file)
    runs = {name: _run(work / simulated_file(name, piece), time, measured) for name, *_ in _RUNS}
    (whole,), (rest,), (near,) = (chart.row(1, height=190) for _ in range(3))
    band = envelope(time, measured - np.median(measured), _BINS)
    whole.band(band.time, band.low, band.high, MEASURED, "measured", alpha=0.35)
    limit = 1.3 * float(np.max(np.abs(measured - np.median(measured))))
    _line(rest, band.time, band.rms, limit, color=MEASURED, alpha=0.5, label="measured")
    for name, words, colour, dash in _RUNS:
        if (run := runs[name]) is not None:
            remainder = envelope(run[0], run[2] - run[1], _BINS)
            _line(rest, remainder.time, remainder.rms, limit, dash=dash, color=colour, label=f"left by: {words}")
    rest.y.set(log=True)
    low, high = whole.limits("x")
    rest.x.set(low=low, high=high)
    whole.x.label, rest.x.label, near.x.label = "Time [s]", "Time [s] (rms)", "Time [s]"
    begin, end = _largest(time, measured, runs)
    drawn: list[tuple[np.ndarray, np.ndarray, str, str, Any]] = [(time, measured, "measured", MEASURED, "-")]
    drawn += [(run[0], run[2], *words) for name, *words in _RUNS if (run := runs[name]) is not None]
    for at, signal, words, colour, dash in drawn:
        seen = np.flatnonzero((at >= begin) & (at <= end))
        shown = np.where(np.abs(signal[seen]) < 1e3 * limit, signal[seen], np.nan)
        near.line(at[seen], shown, colour, words, dash=dash)
    centre = float(np.median(measured))
    near.y.set(low=centre - limit, high=centre + limit)
    return chart


def _measured(entry: Entry, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Time in s and the response of a file; where motion is imposed, its second column."""
    if entry.columns is None:
        numbers = inputs.table(path)[1]
        return numbers[:, 0], numbers[:, 2]
    dt, response, _ = inputs.signals(entry.columns, path)
    return np.arange(response.size) * dt, response


def _line(panel: Panel, time: np.ndarray, rms: np.ndarray, limit: float, **look: Any) -> None:
    """A rms on a logarithmic axis: what is zero or has run away is left out."""
    panel.line(time, np.where((rms > 0) & (rms < 1e3 * limit), rms, np.nan), **look)


def _run(path: Path, time: np.ndarray, measured: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Time, measured and simulated of a free run, in the unit of the file; None where nothing simulates.

    The commands write SI whatever the file holds, and keep its measured response beside: the ratio of both is the unit.
    """
    if not path.is_file():
        return None
    numbers = inputs.table(path)[1]
    if not np.all(np.isfinite(numbers[:, -1])):
        return None
    at = numbers[:, 0] - time[0]
    seen = (time - time[0] >= at[0] - 1e-9) & (time - time[0] <= at[-1] + 1e-9)
    unit = float(np.std(measured[seen]) / np.std(numbers[:, -2]))
    return at, unit * numbers[:, -2], unit * numbers[:, -1]


def _largest(time: np.ndarray, measured: np.ndarray, runs: dict[str, Any]) -> tuple[float, float]:
    """Seconds from and to which some cycles about the largest motion last, within what was simulated."""
    known = next((run for run in runs.values() if run is not None), None)
    at, signal = (time, measured) if known is None else known[:2]
    moved = signal - np.median(signal)
    # from the number of crossings: for a picture a rough period will do
    crossings = max(1, int(np.sum(np.diff(np.signbit(moved)))))
    span = _CYCLES * 2 * (at[-1] - at[0]) / crossings
    middle = at[int(np.argmax(np.abs(moved)))]
    begin = max(at[0], min(middle - 0.3 * span, at[-1] - span))
    return float(begin), float(min(begin + span, at[-1]))
