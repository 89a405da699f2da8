"""Long signals with few points: of every stretch that is one dot wide, the least and the largest value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes and root mean square of a signal over stretches of equal length; all (bins,)."""

    time: np.ndarray
    low: np.ndarray
    high: np.ndarray
    rms: np.ndarray


def envelope(time: np.ndarray, signal: np.ndarray, bins: int) -> Envelope:
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


def thinned(x: np.ndarray, y: np.ndarray, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """A curve (n,), (n,) by so many stretches of points in a row, each by its extremes: what columns of pixels show.

    Of each stretch the least and the largest y stay, and the least and the largest x where x does not rise (a loop),
    in their order; so do the first and the last point. A stretch with a gap (NaN) keeps one. Short curves stay whole.
    Source: Jugel et al. 2014, M4, "A visualization-oriented time series data aggregation".
    """
    n = x.size
    if n <= 2 * columns:
        return x, y
    edges = np.linspace(0, n, columns + 1).astype(int)[:-1]
    there = np.isfinite(x) & np.isfinite(y)
    of = np.searchsorted(edges, np.arange(n), side="right") - 1
    known = x[np.isfinite(x)]
    keep = np.zeros(n, bool)
    keep[[0, n - 1]] = True
    for values in (y,) if np.all(np.diff(known) >= 0) else (y, x):
        for extreme, far in ((np.minimum, np.inf), (np.maximum, -np.inf)):
            best = extreme.reduceat(np.where(there, values, far), edges)
            hits = np.flatnonzero(there & (values == best[of]))
            keep[hits[np.unique(of[hits], return_index=True)[1]]] = True
    gaps = np.flatnonzero(~there)
    keep[gaps[np.unique(of[gaps], return_index=True)[1]]] = True
    return x[keep], y[keep]
