"""What a hand that holds a mass, or moves it from one place to another, leaves of a piece of a recording."""

from __future__ import annotations

import numpy as np

from ..signals.registry import budget, numerics

_STOPS = budget(24, "places", why="at which a hand may have stopped or begun")
OF_MOVED = numerics(6, "parameters", why="of a polynomial that joins two positions, speeds and accelerations")
_OF_HELD = numerics(2, "parameters", why="of a sensor that drifts where the rig is held")


def hand_leaves(piece: np.ndarray) -> float:
    """What a hand leaves of a piece (n,) in units of its noise, with what it costs to state its parameters.

    It holds still while the sensor drifts, or goes a smooth way, before or after which it may hold still: polynomials,
    of as few parameters as suffice. What one leaves of all samples before a place follows from the triangular factors
    of the parts up to there.
    """
    n, price = piece.size, to_state(piece)
    rows = np.column_stack([np.vander(np.linspace(-1, 1, n), OF_MOVED, increasing=True), piece])
    whole = _factors(rows[None])[0]
    best = float(_cost(whole, OF_MOVED, n, price))
    low, high, before, after = 1, n - 1, _factors(rows[None, :1])[0], _factors(rows[None, n - 1 :])[0]
    while high > low:  # where it stopped or began, ever finer about the best
        edges = np.unique(np.linspace(low, high, _STOPS).astype(int))
        upto, beyond = _to_edges(rows, edges, before, after)
        stopped = _cost(upto, OF_MOVED, edges, price) + _cost(beyond, _OF_HELD, n - edges, price)
        began = _cost(upto, _OF_HELD, edges, price) + _cost(beyond, OF_MOVED, n - edges, price)
        costs = np.minimum(stopped, began) + 2.0 * np.log(n)
        k = int(np.argmin(costs))
        best = min(best, float(costs[k]))
        if edges.size < _STOPS:
            break
        first, last = max(k - 1, 0), min(k + 1, edges.size - 1)
        low, high, before, after = int(edges[first]), int(edges[last]), upto[first], beyond[last]
    return best


def to_state(piece: np.ndarray) -> float:
    """What a parameter of a piece (n,) in units of its noise costs to state: how finely the motion tells it.

    Twice the logarithm of how many standard errors a parameter has that is as large as all of the motion (the factor of
    Occam; MacKay 2003, chapter 28). A piece far above its noise that few parameters explain owes it to no chance.
    """
    return float(np.log(max(piece.size, np.sum((piece - np.mean(piece)) ** 2))))


def to_place(n: int) -> float:
    """What it costs to say where among n samples a piece ends; where it begins, a hand's way changes as well."""
    return float(np.log(n))


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


def _cost(factor: np.ndarray, most: int, n: int | np.ndarray, price: float) -> np.ndarray:
    """Least of what polynomials of up to so many parameters leave of n samples (..., 7, 7) and cost to state."""
    squares = factor[..., -1] ** 2
    left = np.sum(squares, axis=-1)[..., None] - np.cumsum(squares[..., :most], axis=-1)
    costs = left + np.minimum(np.arange(1, most + 1), np.asarray(n)[..., None]) * price
    return np.asarray(np.min(costs, axis=-1))
