"""A recording without a force, divided into what is free, what is held or at rest, and what something else moves.

Each kind has a simple model: free motion is a damped mode about a constant, held is a constant, and what a hand moves
is a cubic for every half cycle. A division costs what the samples are unlikely under its models, what its parameters
take to state, and what it takes to say where it changes; the cheapest is found by dynamic programming over half
cycles (Bellman 1957; for change points Jackson et al. 2005). Frequency and damping of a free piece may glide: what
comes next is judged by a model of the two cycles before it alone, and by how much such models are off altogether
(``share``), which is chosen by likelihood too. A piece is judged by itself; what stands around it cannot refuse it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .cells import LOOKS_BACK, OF_FREE, OF_HELD, OF_MOVED, Cells, cells_of
from .pieces import FREE, HELD, MOVED, Piece, pieces_between, scale_of, variances_of

#: What a damped sine of two cycles may leave of the motion: none, to a third, where it glides or several modes ring.
_SHARES = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)


def segmented(x: np.ndarray, fs: float, noise: float, periods: Sequence[float]) -> tuple[tuple[Piece, ...], float]:
    """Divide a response (n,) into pieces, in order of time.

    Args:
        x: response, any unit.
        fs: Hz.
        noise: standard deviation of its white noise.
        periods: samples a cycle that it may have; the likeliest is taken.

    Returns:
        Pieces that follow one another, none where it is shorter than half a cycle of any period; and what one damped
        mode may leave of the motion within two cycles.
    """
    if not np.ptp(x) > 0:
        return (), 0.0
    best: tuple[float, Cells, float, list[tuple[int, int, str]]] | None = None
    for period in periods:
        cells = cells_of(np.asarray(x, float), period, noise)
        if cells is None:
            continue
        for share in _SHARES:
            cost, runs = _divided(cells, share)
            if best is None or cost + cells.within - 0.5 * cells.means.size < best[0]:
                best = (cost + cells.within - 0.5 * cells.means.size, cells, share, runs)
    if best is None:
        return (), 0.0
    _, cells, share, runs = best
    runs = _joined(cells, share, runs)
    return tuple(pieces_between(cells, share, runs, x.size, fs)), share


def _divided(cells: Cells, share: float) -> tuple[float, list[tuple[int, int, str]]]:
    """The cost in natural units of the cheapest division, and its runs of cells (first, end, kind)."""
    count, span = cells.count, float(np.ptp(cells.means)) + cells.noise
    free = [
        _cost(w.rss, h, L + 1, OF_FREE, cells, share, span)
        for L, (w, h) in enumerate(zip(cells.free, cells.rss_held, strict=True))
    ]
    held = [_cost(h, 0 * h, L + 1, OF_HELD, cells, 0.0, span) for L, h in enumerate(cells.rss_held)]
    moved = [_cost(m, 0 * m, L + 1, OF_MOVED, cells, 0.0, span) for L, m in enumerate(cells.rss_moved)]
    change = np.log(count + 1.0)
    ages = {FREE: free, HELD: held, MOVED: moved}
    oldest = {kind: max(1, min(count, len(table) - 1)) for kind, table in ages.items()}
    cost = {kind: np.full(most, np.inf) for kind, most in oldest.items()}
    back = {kind: np.zeros((count, most), int) for kind, most in oldest.items()}
    came: list[tuple[str, int]] = []  # of the cheapest before each cell
    for k in range(count):
        ends = {kind: float(np.min(values)) for kind, values in cost.items()}
        cheapest = min(ends, key=lambda kind: ends[kind])
        came.append((cheapest, int(np.argmin(cost[cheapest]))))
        begun = 0.0 if k == 0 else ends[cheapest] + change
        new: dict[str, np.ndarray] = {}
        for kind, table in ages.items():
            most, old = oldest[kind], cost[kind]
            values = np.full(most, np.inf)
            values[0], back[kind][k, 0] = begun + table[0][k], -1
            for age in range(1, min(most, k + 1)):  # from age - 1 of the cell before, indices from zero
                values[age] = old[age - 1] + table[age][k - age] - table[age - 1][k - age]
                back[kind][k, age] = age - 1
            if len(table) > most and k >= most:
                stays = old[most - 1] + table[most][k - most] - table[most - 1][k - most]
                if stays < values[most - 1]:
                    values[most - 1], back[kind][k, most - 1] = stays, most - 1
            new[kind] = values
        cost = new
    kind = min(cost, key=lambda name: float(np.min(cost[name])))
    total, age = float(np.min(cost[kind])), int(np.argmin(cost[kind]))
    runs: list[tuple[int, int, str]] = []
    end = count
    for k in range(count - 1, -1, -1):
        before = int(back[kind][k, age])
        if before < 0:
            runs.append((k, end, kind))
            end = k
            kind, age = came[k]
        else:
            age = before
    return total, runs[::-1]


def _joined(cells: Cells, share: float, runs: list[tuple[int, int, str]]) -> list[tuple[int, int, str]]:
    """Free runs that meet and tell one motion are one: its frequency glides faster than two cycles follow.

    The model of a cycle and a half across the edge is then off by no more than those of free motion are; one that is
    steady beside one that falls is driven.
    """
    joined = [runs[0]]
    for first, end, kind in runs[1:]:
        a, b, before = joined[-1]
        if kind == before == FREE and _one_motion(cells, share, (a, b), (first, end)):
            joined[-1] = (a, end, FREE)
        else:
            joined.append((first, end, kind))
    return joined


def _one_motion(cells: Cells, share: float, one: tuple[int, int], other: tuple[int, int]) -> bool:
    edge = other[0]
    for length in (cells.a_cycle, 3 * cells.a_cycle // 2):
        length = max(2, min(length, len(cells.free)))
        fit = cells.free[length - 1]
        for at in range(max(one[0], edge - length + 1), min(edge, other[1] - length + 1)):
            left = np.sqrt(fit.rss[at] / (length * cells.cell))
            if left > 2 * np.hypot(cells.noise, max(share, 0.01) * fit.amplitude(0.0)[at]):
                return False
    rates = []
    for (a, b), side in ((one, "end"), (other, "begin")):
        length = min(LOOKS_BACK * cells.a_cycle, b - a)
        rates.append(_rate(cells, share, length, b - length if side == "end" else a))
    (r1, e1), (r2, e2) = rates
    return not (abs(r1) + 3 * e1 < r2 / 3 or abs(r2) + 3 * e2 < r1 / 3)


def _rate(cells: Cells, share: float, length: int, at: int) -> tuple[float, float]:
    """Rate of fall of a window, and its standard error, per block mean."""
    fit = cells.free[length - 1]
    variance = variances_of(fit.information[at])[1]
    spread = max(scale_of(cells, share, fit, at), float(np.sqrt(fit.rss[at] / (length * cells.cell))))
    omega = float(fit.omega[at])
    return float(fit.zeta[at]) * omega, spread * float(np.sqrt(variance)) * omega


def _cost(
    rss: np.ndarray, varied: np.ndarray, length: int, parameters: int, cells: Cells, share: float, span: float
) -> np.ndarray:
    """Negative log-likelihood of runs of cells, with what stating the parameters costs (Rissanen 1983)."""
    n = length * cells.cell
    variance = cells.noise**2 + share**2 * varied / n
    stated = parameters * np.log(np.sqrt(n) * span / np.sqrt(variance))
    return 0.5 * n * np.log(variance / cells.noise**2) + 0.5 * rss / variance + np.maximum(stated, 0.0)
