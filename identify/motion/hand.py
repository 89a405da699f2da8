"""What a hand that holds a mass, or moves it from one place to another, leaves of a piece of a recording."""

from __future__ import annotations

import numpy as np

from ..signals.registry import budget, numerics

_STOPS = budget(24, "places", why="at which a hand may have stopped or begun")
OF_MOVED = numerics(6, "parameters", why="of a polynomial that joins two positions, speeds and accelerations")
_OF_HELD = numerics(2, "parameters", why="of a sensor that drifts where the rig is held")


def hand_leaves(piece: np.ndarray) -> float:
    """What a hand leaves of a piece (n,) in units of its noise, with what it costs to state its parameters.

    It holds still while the sensor drifts, or goes a smooth way, before or after which it may hold still. What a
    polynomial leaves of all samples before a place follows from the triangular factors of the parts up to there.
    """
    n = piece.size
    rows = np.column_stack([np.vander(np.linspace(-1, 1, n), OF_MOVED, increasing=True), piece])
    whole = _factors(rows[None])[0]
    best = min(float(_cost(whole, _OF_HELD, n)), float(_cost(whole, OF_MOVED, n)))
    low, high, before, after = 1, n - 1, _factors(rows[None, :1])[0], _factors(rows[None, n - 1 :])[0]
    while high > low:  # where it stopped or began, ever finer about the best
        edges = np.unique(np.linspace(low, high, _STOPS).astype(int))
        upto, beyond = _to_edges(rows, edges, before, after)
        stopped = _cost(upto, OF_MOVED, edges) + _cost(beyond, _OF_HELD, n - edges)
        began = _cost(upto, _OF_HELD, edges) + _cost(beyond, OF_MOVED, n - edges)
        costs = np.minimum(stopped, began) + np.log(n)
        k = int(np.argmin(costs))
        best = min(best, float(costs[k]))
        if edges.size < _STOPS:
            break
        first, last = max(k - 1, 0), min(k + 1, edges.size - 1)
        low, high, before, after = int(edges[first]), int(edges[last]), upto[first], beyond[last]
    return best


def _to_edges(
    rows: np.ndarray, edges: np.ndarray, before: np.ndarray, after: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Factors of all rows before each edge, and of all from there on: known before the first and after the last."""
    lengths = np.diff(edges)
    parts = np.zeros((lengths.size, int(np.max(lengths)), rows.shape[1]))
    for part, a, b in zip(parts, edges, edges[1:], strict=False):
        part[: b - a] = rows[a:b]
    parts = _factors(parts)
    both = np.empty((2, edges.size, *before.shape))
    both[:, 0] = before, after
    for k in range(lengths.size):
        both[:, k + 1] = _factors(np.concatenate([both[:, k], parts[[k, -1 - k]]], axis=1))
    return both[0], both[1, ::-1]


def _factors(parts: np.ndarray) -> np.ndarray:
    """(B, 7, 7) triangular factors of powers of time and samples, (B, n, 7); rows of zeros change nothing."""
    width = parts.shape[2]
    short = max(width - parts.shape[1], 0)
    return np.asarray(np.linalg.qr(np.pad(parts, [(0, 0), (0, short), (0, 0)]) if short else parts, mode="r"))


def _cost(factor: np.ndarray, parameters: int, n: int | np.ndarray) -> np.ndarray:
    """What a polynomial of so many parameters leaves of n samples (..., 7, 7), and what these cost to state."""
    return np.asarray(np.sum(factor[..., parameters:, -1] ** 2, axis=-1) + np.minimum(parameters, n) * np.log(n))
