"""Gauss quadrature over an angle, with the intervals split where a force law switches.

A law is smooth between two switches, so Gauss-Legendre on the pieces keeps its order, steps and kinks or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

ORDER = 8
_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(ORDER)


def _running_weights() -> np.ndarray:
    """Row i: weights on the Gauss nodes of the integral from -1 to node i, exact for polynomials of degree 7."""
    legendre = np.polynomial.legendre
    values = legendre.legvander(_GAUSS_NODES, ORDER - 1)
    integrals = np.stack(
        [legendre.legval(_GAUSS_NODES, legendre.legint(basis, lbnd=-1.0)) for basis in np.eye(ORDER)], axis=1
    )
    return integrals @ np.linalg.inv(values)


_RUNNING = _running_weights()


@dataclass(frozen=True)
class Panels:
    """Quadrature nodes of several rows (one an amplitude); each row has its own split intervals.

    Attributes:
        angle: nodes, (rows, intervals, ORDER), rad.
        width: of the intervals, (rows, intervals), rad; zero where a row needs no split.
    """

    angle: np.ndarray
    width: np.ndarray

    def integral(self, values: np.ndarray) -> np.ndarray:
        """Integral (rows,) of the values at the nodes (rows, intervals, ORDER)."""
        return np.einsum("rio,ri,o->r", values, self.width / 2, _GAUSS_WEIGHTS)

    def from_start(self, values: np.ndarray) -> np.ndarray:
        """Integral from the first angle to every node (rows, intervals, ORDER)."""
        whole = np.einsum("rio,ri,o->ri", values, self.width / 2, _GAUSS_WEIGHTS)
        before = np.cumsum(whole, axis=1) - whole
        return before[..., None] + np.einsum("rij,oj,ri->rio", values, _RUNNING, self.width / 2)

    def to_end(self, values: np.ndarray) -> np.ndarray:
        """Integral from every node to the last angle, as exact near that end as ``from_start`` is near its own."""
        mirrored = Panels(self.angle[:, ::-1, ::-1], self.width[:, ::-1])
        return mirrored.from_start(values[:, ::-1, ::-1])[:, ::-1, ::-1]


Surfaces = Callable[[np.ndarray, np.ndarray], np.ndarray]


def split_panels(surfaces: Surfaces, rows: int, span: float, count: int) -> Panels:
    """Nodes on ``[0, span]`` for every row, the ``count`` equal intervals split where a surface changes its sign.

    Args:
        surfaces: ``surfaces(angle (m,), row (m,)) -> (surfaces, m)``: the switching functions.
        rows: how many rows.
        span: last angle, rad. A multiple of pi with ``count`` a multiple of 4 puts nodes where x or v is largest, so
            that a contact however short is seen.
        count: intervals before splitting.
    """
    edges = np.linspace(0.0, span, count + 1)
    row = np.repeat(np.arange(rows), count + 1)
    g = surfaces(np.tile(edges, rows), row).reshape(-1, rows, count + 1)
    low, high = g[..., :-1], g[..., 1:]
    surface, at, interval = np.nonzero(np.sign(low) * np.sign(high) < 0)  # a product may be beyond any number
    roots = np.broadcast_to(edges[1:], low.shape).copy()
    roots[surface, at, interval] = _roots(surfaces, surface, at, edges[interval], edges[interval + 1])
    split = np.zeros(low.shape[::2], dtype=bool)  # a split that no row needs is left out
    split[surface, interval] = True

    bounds = [np.zeros((rows, 1))]
    for i in range(count):
        inner = np.sort(roots[split[:, i], :, i].T, axis=1)
        bounds += [inner, np.full((rows, 1), edges[i + 1])]
    edge = np.concatenate(bounds, axis=1)
    width = np.diff(edge, axis=1)
    angle = edge[:, :-1, None] + width[..., None] * (_GAUSS_NODES + 1) / 2
    return Panels(angle, width)


def _roots(surfaces: Surfaces, surface: np.ndarray, row: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where the surfaces change their sign between two angles each, (m,); Chandrupatla 1997, for all at once.

    Inverse quadratic interpolation where it may be trusted, halving elsewhere.
    """
    if not surface.size:
        return low
    pick = np.arange(surface.size)

    def value(at: np.ndarray) -> np.ndarray:
        return surfaces(at, row)[surface, pick]

    a, b, fa, fb = low, high, value(low), value(high)
    t = np.full(low.shape, 0.5)
    best, found = low, np.zeros(low.shape, bool)
    for _ in range(_TURNS):
        at = a + t * (b - a)
        f = value(at)
        same = np.sign(f) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = at, f
        best = np.where(found, best, np.where(np.abs(fa) < np.abs(fb), a, b))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            least = _CLOSE * np.abs(best) / np.abs(b - a)
            found |= (least > 0.5) | (f == 0)
            if np.all(found):
                break
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            step = fa / (fb - fa) * (fc / (fb - fc)) + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
        t = np.where((phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi) & np.isfinite(step), step, 0.5)
        t = np.where(found, 0.5, np.clip(t, np.minimum(least, 0.5), np.maximum(1 - least, 0.5)))
    return best


#: Steps after which a root has been halved down to the last digit anyway, and how far apart its ends may stay.
_TURNS, _CLOSE = 100, 4e-16
