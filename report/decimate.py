"""Long signals drawn with few points: of every stretch that is one dot wide, the least and the largest value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: Stretches across a picture: more than a screen or a printer shows, few enough for a small file.
_BINS = 900
#: So few cycles can be seen one by one.
_FEW_CYCLES = 60


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes and root mean square of a signal over stretches of equal length; all (bins,)."""

    time: np.ndarray
    low: np.ndarray
    high: np.ndarray
    rms: np.ndarray


def envelope(time: np.ndarray, signal: np.ndarray, bins: int = _BINS) -> Envelope:
    """Stretches of ``signal`` (n,) at ``time`` (n,); values that are not finite are passed over, NaN where all are."""
    count = max(1, min(bins, signal.size))
    edges = np.linspace(0, signal.size, count + 1).astype(int)[:-1]
    there = np.isfinite(signal)
    low = np.minimum.reduceat(np.where(there, signal, np.inf), edges)
    high = np.maximum.reduceat(np.where(there, signal, -np.inf), edges)
    seen = np.add.reduceat(there.astype(float), edges)
    square = np.add.reduceat(np.where(there, signal, 0.0) ** 2, edges)
    empty = seen == 0
    low, high = np.where(empty, np.nan, low), np.where(empty, np.nan, high)
    rms = np.where(empty, np.nan, np.sqrt(square / np.maximum(seen, 1)))
    stop = np.append(edges[1:], signal.size) - 1
    return Envelope(0.5 * (time[edges] + time[stop]), low, high, rms)


def draw_signal(axes: Any, time: np.ndarray, signal: np.ndarray, color: str) -> None:
    """Draw a signal on matplotlib axes: as a line where it is short, as the band between its extremes where long."""
    if signal.size <= 2 * _BINS:
        axes.plot(time, signal, color=color, linewidth=0.9)
    else:
        e = _smooth_band(time, signal)
        # its outline, lightly filled: a solid block hides the grid, and what is laid over it
        axes.fill_between(e.time, e.low, e.high, color=color, alpha=0.25, linewidth=0)
        for edge in (e.low, e.high):
            axes.plot(e.time, edge, color=color, linewidth=0.8)
    axes.set_xlim(time[0], 2 * time[-1] - time[-2])  # a sample lasts until the next


def _smooth_band(time: np.ndarray, signal: np.ndarray) -> Envelope:
    """Stretches so long that each holds a whole cycle: shorter ones would show a beat that is not in the signal.

    Where there are few cycles to a picture they are shown one by one, in the shortest stretches.
    """
    shortest = envelope(time, signal)
    centred = signal - np.median(signal)
    cycles = np.count_nonzero(np.diff(np.sign(centred[np.abs(centred) > 0.05 * np.max(np.abs(centred))]))) / 2
    if cycles < _FEW_CYCLES:
        return shortest
    for bins in (_BINS, _BINS // 2, _BINS // 3, _BINS // 4):
        e = envelope(time, signal, bins)
        around = _neighbours(e.high, np.maximum) - _neighbours(e.low, np.minimum)
        whole = (e.high - e.low) >= 0.8 * around
        if np.mean(whole) > 0.95:
            return e
    return shortest


def _neighbours(values: np.ndarray, extreme: np.ufunc) -> np.ndarray:
    padded = np.pad(values, 1, mode="edge")
    return extreme(extreme(padded[:-2], padded[1:-1]), padded[2:])
