"""The picture of one recording: the whole of it and its largest motion, measured, simulated, and what is left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from dashpot.report.decimate import envelope
from dashpot.report.style import AFTER, BEFORE, FORCED, MEASURED, drawing, svg

from . import inputs
from .entry import Entry, Piece
from .examine import simulated_file

#: Cycles of the motion that are drawn one by one, and points that a line has at most.
_CYCLES = 8.0
_POINTS = 1500
_BINS = 500
#: File, legend, colour, line.
_RUNS = (
    ("plain", "plain linear fit", FORCED, ":"),
    ("before", "identified", BEFORE, "--"),
    ("after", "mended", AFTER, "-"),
)


def draw(entry: Entry, piece: Piece, work: Path) -> str:
    """The picture as SVG, from the files that the commands and the plain fit left in `work`."""
    with drawing(height=5.6) as figure:
        paint(figure, entry, piece, work)
        return svg(
            figure, f"{entry.name}-{piece.file.partition('.')[0]}".replace("_", "-"), f"{entry.title}: {piece.file}"
        )


def paint(figure: Any, entry: Entry, piece: Piece, work: Path) -> None:
    """Draw on a matplotlib figure: above the whole recording with what each run leaves, below the largest motion."""
    time, measured = _measured(entry, work / piece.file)
    runs = {name: _run(work / simulated_file(name, piece), time[0]) for name, *_ in _RUNS}
    whole, near = figure.subplots(2, 1)
    band = envelope(time, measured - np.median(measured), _BINS)
    whole.fill_between(band.time, band.low, band.high, color=MEASURED, alpha=0.35, linewidth=0, label="measured")
    limit = 1.3 * float(np.max(np.abs(measured - np.median(measured))))
    for name, words, colour, line in _RUNS:
        if (found := runs[name]) is not None:
            rest = envelope(found[0], found[2] - found[1], _BINS)
            whole.plot(rest.time, np.minimum(rest.rms, limit), line, color=colour, label=f"left by {words} (rms)")
    whole.set_ylim(-limit, limit)
    whole.set_xlabel("Time [s]")
    begin, end = _largest(time, measured, runs)
    for at, signal, words, colour, line in (
        (time, measured, "measured", MEASURED, "-"),
        *(
            (run[0], run[2], words, colour, line)
            for name, words, colour, line in _RUNS
            if (run := runs[name]) is not None
        ),
    ):
        seen = np.flatnonzero((at >= begin) & (at <= end))
        seen = seen[:: max(1, seen.size // _POINTS)]
        near.plot(
            at[seen],
            np.where(np.abs(signal[seen]) < 1e3 * limit, signal[seen], np.nan),
            line,
            color=colour,
            label=words,
        )
    centre = float(np.median(measured))
    near.set_ylim(centre - limit, centre + limit)
    near.set_xlabel("Time [s]")
    for axis in (whole, near):
        axis.legend(loc="upper right", ncols=4)


def _measured(entry: Entry, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Time in s and the response of a file; where motion is imposed, its second column."""
    if entry.columns is None:
        numbers = inputs.table(path)[1]
        return numbers[:, 0], numbers[:, 2]
    dt, response, _ = inputs.signals(entry.columns, path)
    return np.arange(response.size) * dt, response


def _run(path: Path, begin: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Time, measured and simulated of a free run; None where there is none or nothing simulates."""
    if not path.is_file():
        return None
    numbers = inputs.table(path)[1]
    if not np.all(np.isfinite(numbers[:, -1])):
        return None
    return numbers[:, 0] - begin, numbers[:, -2], numbers[:, -1]


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
    return float(begin), float(begin + span)
