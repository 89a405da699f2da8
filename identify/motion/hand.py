"""What a hand that holds a mass, or moves it from one place to another, leaves of a piece of a recording."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..signals.registry import budget, numerics

_STOPS = budget(24, "places", why="at which a hand may have stopped or begun")
OF_MOVED = numerics(6, "parameters", why="of a polynomial that joins two positions, speeds and accelerations")
_OF_HELD = numerics(2, "parameters", why="of a sensor that drifts where the rig is held")


def hand_leaves(piece: np.ndarray) -> float:
    """What a hand leaves of a piece (n,) in units of its noise, with what it costs to state its parameters.

    It holds still while the sensor drifts, or goes a smooth way, before or after which it may hold still.
    """
    n = piece.size
    best = min(_smooth(piece, _OF_HELD), _smooth(piece, OF_MOVED))
    low, high = 1, n - 1
    while high > low:  # where it stopped or began, ever finer about the best
        edges = np.unique(np.linspace(low, high, _STOPS).astype(int))
        costs = [min(_way(piece[:edge], piece[edge:]), _way(piece[edge:], piece[:edge])) for edge in edges]
        best, k = min(best, *costs), int(np.argmin(costs))
        if edges.size < _STOPS:
            break
        low, high = int(edges[max(k - 1, 0)]), int(edges[min(k + 1, edges.size - 1)])
    return best


def _way(way: np.ndarray, rest: np.ndarray) -> float:
    return _smooth(way, OF_MOVED) + _smooth(rest, _OF_HELD) + np.log(way.size + rest.size)


def _smooth(way: np.ndarray, parameters: int) -> float:
    count = min(parameters, way.size)
    smooth = _polynomials(way.size, count)
    return float(np.sum((way - smooth @ (smooth.T @ way)) ** 2)) + count * np.log(way.size)


@lru_cache(maxsize=512)
def _polynomials(n: int, count: int) -> np.ndarray:
    return np.linalg.qr(np.vander(np.linspace(-1, 1, n), count))[0]
