"""A recording in block means, in cells of a part of a cycle, with the models of all short runs of cells."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .damped_windows import Windows, fit_windows

#: Block means a cycle: a damped sine needs no more, and its harmonics do not enter.
_A_CYCLE = 16
#: Cycles that a model of what comes next looks back on.
LOOKS_BACK = 2
#: Cells a cycle, the more the fewer cycles there are, and cells in a recording: edges as fine as time allows.
_FINEST, _COARSEST, _CELLS, _MOST_CELLS = 4, 2, 120, 600
#: Means whose windows are fitted in seconds: those of 4,000 cycles.
_MOST_MEANS = 2**16
#: What a motion that begins anew touches of a recording at most; where more is rough, the blocks are too coarse.
_JUMPS = 0.1
#: Cycles from which on a constant may drift.
_DRIFTS = 1.5
#: Parameters of a damped sine about a constant, of a constant that may drift, and of a hand's way over a half cycle.
OF_FREE, OF_HELD, OF_MOVED = 5, 2, 4
#: Fewest block means of a cell: more than a damped sine has parameters.
FEWEST = 6


@dataclass(frozen=True, eq=False)
class Cells:
    """A recording in block means, cells of half a cycle, and the models of all short runs of cells.

    ``a_cycle`` cells are a cycle, at least one, and ``period`` block means. ``free[L - 1]`` has the fits of L cells
    from each cell on, ``rss_held`` what a constant leaves there, ``rss_moved`` the same of a cubic; ``within`` is how
    unlikely the samples are within their blocks.
    """

    means: np.ndarray
    block: int
    cell: int
    a_cycle: int
    period: float
    noise: float
    free: tuple[Windows, ...]
    rss_held: tuple[np.ndarray, ...]
    rss_moved: tuple[np.ndarray, ...]
    within: float

    @property
    def turned(self) -> Cells:
        """The block means the other way round, whose first is the last; the fits are not turned."""
        return replace(self, means=self.means[: self.count * self.cell][::-1])

    @property
    def count(self) -> int:
        """Number of cells."""
        return self.rss_held[0].size


def cells_of(x: np.ndarray, period: float, noise: float) -> Cells | None:
    """The cells of a response (n,) with so many samples a cycle and white noise; None for thousands of cycles."""
    a_cell = 2 ** int(np.clip(np.log2(_CELLS * period / x.size), np.log2(_COARSEST), np.log2(_FINEST)))
    block = max(1, int(period / max(_A_CYCLE, FEWEST * a_cell)))
    n = x.size // block
    a_cycle = period / block
    cell = max(FEWEST, round(a_cycle / a_cell), -(-n // _MOST_CELLS))
    count = n // cell
    cells_a_cycle = max(1, round(a_cycle / cell))
    if count < 1 or n > _MOST_MEANS:
        return None
    blocks = x[: n * block].reshape(n, block)
    means = blocks.mean(axis=1)
    noise = max(noise, 1e-9 * float(np.ptp(x)))
    free, held = [], []
    for length in range(1, min(LOOKS_BACK * cells_a_cycle + 1, count) + 1):
        windows = np.lib.stride_tricks.sliding_window_view(means, length * cell)[::cell][: count - length + 1]
        free.append(
            fit_windows(np.ascontiguousarray(windows), 2 * np.pi / a_cycle, slope=length >= _DRIFTS * cells_a_cycle)
        )
        still = np.linalg.qr(np.vander(np.linspace(-1, 1, length * cell), OF_HELD))[0]
        held.append(np.sum((windows - windows @ still @ still.T) ** 2, axis=1))
    for shorter, longer in zip(free[-2::-1], free[:0:-1], strict=True):  # where a search ended beside its best
        shorter.rss[:-1] = np.minimum(shorter.rss[:-1], longer.rss)
        shorter.rss[1:] = np.minimum(shorter.rss[1:], longer.rss)
    moved = []
    for length in range(1, min(max(1, cells_a_cycle // 2) + 1, count) + 1):
        windows = np.lib.stride_tricks.sliding_window_view(means, length * cell)[::cell][: count - length + 1]
        smooth = np.linalg.qr(np.vander(np.linspace(-1, 1, length * cell), OF_MOVED))[0]
        moved.append(np.sum((windows - windows @ smooth @ smooth.T) ** 2, axis=1))
    within = _within(blocks, means, noise)
    return Cells(
        means,
        block,
        cell,
        cells_a_cycle,
        a_cycle,
        noise / np.sqrt(block),
        tuple(free),
        tuple(held),
        tuple(moved),
        within,
    )


def _within(blocks: np.ndarray, means: np.ndarray, noise: float) -> float:
    """How unlikely the samples are within their blocks, where a polynomial runs through the means of five blocks.

    Where a motion jumps, two such polynomials and the place are what a block costs at most.
    """
    count, block = blocks.shape
    if block == 1 or count < 5:
        return 0.5 * blocks.size if block == 1 else 0.5 * float(np.sum((blocks - means[:, None]) ** 2)) / noise**2
    edges, powers = np.arange(-2.5, 3.0), np.arange(1, 6)
    averages = np.diff(edges[:, None] ** powers, axis=0) / powers
    inside = (np.arange(block) + 0.5) / block - 0.5
    runs = np.vander(inside, 5, increasing=True) @ np.linalg.inv(averages)
    smooth = np.lib.stride_tricks.sliding_window_view(means, 5) @ runs.T
    left = 0.5 * np.sum((blocks[2:-2] - smooth) ** 2, axis=1) / noise**2
    span = float(np.ptp(means)) + noise
    jumps = max(0.5 * block + 12 * np.log(np.sqrt(block) * span / noise), float(np.quantile(left, 1 - _JUMPS)))
    return float(np.sum(np.minimum(left, jumps))) * count / (count - 4)
