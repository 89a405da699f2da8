"""Where along a coordinate the missing force lies: ranges that stand out of the noise, harmonic orders, one tone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .equation_error import Stretch
from .explanations import Rows, hats, nodes_of, solve

#: A range is reported where the excess is beyond this many of its standard errors ...
SIGNIFICANT = 3.0
#: ... and at least this part of the largest.
_NOTABLE = 0.05
_BINS = 20
#: The noise's own power is known no better than to this part.
_DOUBT = 0.2
ORDERS = 6
#: A line stands out of the spectrum around it by this factor of power: by chance once in 10,000 recordings.
_LINE = 25.0
#: In the other recordings the same frequency is asked for, not any.
_SAME_LINE = 8.0
_LONG_CYCLES = 80.0


@dataclass(frozen=True, eq=False)
class Curve:
    """The missing force as a function of one coordinate, less what the family's own terms can tell of it.

    Attributes:
        at: (m,) values of the coordinate.
        force: (m,) per unit mass.
        std: (m,) from block to block.
    """

    at: np.ndarray
    force: np.ndarray
    std: np.ndarray

    @property
    def notable(self) -> np.ndarray:
        """(m,) where the force stands out of its errors and is not small beside its largest."""
        clear = np.abs(self.force) > SIGNIFICANT * self.std
        largest = np.max(np.abs(self.force), initial=0.0, where=clear)
        return clear & (np.abs(self.force) > 3 * _NOTABLE * largest)


def curve_of(rows: Rows, values: np.ndarray, own: tuple[int, ...]) -> Curve:
    """The missing force over a coordinate.

    The family's terms in that coordinate can be added at will, since a fit bends them. Those are taken that leave the
    force small at most places (least absolute deviations), so that a force with an onset stays where it acts.

    Args:
        rows: the regression.
        values: (n,) coordinate.
        own: columns of ``rows.base`` that are functions of it.
    """
    nodes = nodes_of(values, _BINS)
    free = hats(values, nodes)
    count = free.sum(axis=0)
    other = [i for i in range(rows.base.shape[1]) if i not in own]
    columns = np.hstack([rows.base[:, other], free * rows.weight[:, None]])
    size = np.linalg.norm(columns, axis=0)
    columns = columns / np.where(size > 0, size, 1.0)
    solution = solve(columns, rows.target)
    left = rows.target - columns @ solution
    scores = np.zeros((int(rows.block.max()) + 1, columns.shape[1]))
    np.add.at(scores, rows.block, columns * left[:, None])
    bread = np.linalg.pinv(columns.T @ columns, rcond=1e-8)
    spread = np.sqrt(np.maximum(np.diag(bread @ (scores.T @ scores) @ bread), 0.0))
    scale = np.where(size > 0, size, 1.0)[len(other) :]
    force, std = solution[len(other) :] / scale, spread[len(other) :] / scale
    kept = (count > 20) & (std > 0)
    if np.count_nonzero(kept) < 8:
        return Curve(nodes[kept], np.zeros(np.count_nonzero(kept)), np.ones(np.count_nonzero(kept)))
    shapes = []
    for i in own:
        plain = rows.base[:, i] / rows.weight
        shapes.append(np.linalg.lstsq(free[:, kept], plain, rcond=None)[0])
    at, force, std = nodes[kept], force[kept], std[kept]
    return Curve(at, force - _least_absolute(np.array(shapes).T, force, std), std)


def _least_absolute(shapes: np.ndarray, force: np.ndarray, std: np.ndarray) -> np.ndarray:
    """(m,) combination of the shapes that leaves the smallest sum of absolute deviations, reweighted least squares."""
    floor = max(float(np.median(std)), 1e-300)
    size = np.maximum(np.linalg.norm(shapes, axis=0), 1e-300)
    weight = 1.0 / np.maximum(std, 0.2 * floor)
    fitted = np.zeros_like(force)
    for _ in range(60):
        root = np.sqrt(weight)
        part = np.linalg.lstsq(shapes / size * root[:, None], force * root, rcond=1e-8)[0]
        fitted = shapes / size @ part
        weight = 1.0 / np.maximum(std, 0.2 * floor) / np.maximum(np.abs(force - fitted) / np.maximum(std, floor), 1.0)
    return fitted


def excess_range(rows: Rows, values: np.ndarray, use: np.ndarray | None = None) -> tuple[float, float] | None:
    """Lowest and highest value between which the missing force's power stands out; None where it does nowhere."""
    fine = np.isfinite(values) if use is None else np.isfinite(values) & use
    if np.count_nonzero(fine) < 3 * _BINS:
        return None
    values = values[fine]
    low, high = np.quantile(values, [0.002, 0.998])
    edges = np.linspace(low, high, _BINS + 1)
    place = np.clip(np.searchsorted(edges, values) - 1, 0, _BINS - 1)
    left, silent = rows.left[fine] ** 2, rows.silent[fine] ** 2
    blocks = rows.block[fine]
    clear = np.zeros(_BINS, bool)
    mean = np.zeros(_BINS)
    for i in range(_BINS):
        here = place == i
        if np.count_nonzero(here) >= 10:
            clear[i], mean[i] = _beyond(left[here], silent[here], blocks[here])
    clear &= mean > _NOTABLE * np.max(mean, initial=0.0, where=clear)
    if not np.any(clear):
        return None
    return float(edges[np.argmax(clear)]), float(edges[_BINS - np.argmax(clear[::-1])])


def where_it_is(rows: Rows) -> list[bool]:
    """For each stretch whether its missing force is beyond the noise, block by block."""
    found = []
    for i in range(len(rows.stretches)):
        left, silent = rows.part(rows.left, i), rows.part(rows.silent, i)
        found.append(_beyond(left**2, silent**2, rows.part(rows.block, i))[0])
    return found


def _beyond(left: np.ndarray, silent: np.ndarray, block: np.ndarray) -> tuple[bool, float]:
    """Whether power is beyond that of the noise by its own scatter from block to block, and how much a sample."""
    block = block - block.min()
    count = np.bincount(block)
    sums = np.bincount(block, silent)[count > 0]
    spread = np.sqrt(2.0 * np.sum((sums - np.mean(sums)) ** 2)) if sums.size > 2 else 2.0 * np.sum(sums)
    excess, noise = float(np.sum(left) - np.sum(silent)), float(np.sum(silent))
    return bool(excess > SIGNIFICANT * spread and excess > _DOUBT * noise), excess / left.size


def orders(rows: Rows) -> tuple[dict[int, float], tuple[float, float]]:
    """Shares of the missing force's power that are locked to the motion's phase, by harmonic order; the rest is not.

    Returns:
        Order to share, and the parts of the first order that are in phase with displacement and with velocity.
    """
    power = np.zeros((2, ORDERS))
    first = np.zeros((2, 2))
    for i, s in enumerate(rows.stretches):
        if not np.all(np.isfinite(s.phase)):
            continue
        blocks = rows.part(rows.block, i)
        turns = np.arange(1, ORDERS) * s.phase[:, None]
        columns = np.column_stack([np.ones(s.n), np.cos(turns), np.sin(turns)])
        signals = np.column_stack([rows.part(rows.left, i), rows.part(rows.silent, i)])
        for block in np.unique(blocks):
            here = blocks == block
            if np.count_nonzero(here) < 4 * ORDERS:
                continue
            found = np.linalg.lstsq(columns[here], signals[here], rcond=1e-6)[0]
            count = np.count_nonzero(here)
            cosine, sine = found[1:ORDERS] ** 2 / 2, found[ORDERS:] ** 2 / 2
            power += count * np.vstack([found[0] ** 2, cosine + sine]).T
            first += count * np.vstack([cosine[0], sine[0]])
    excess = np.maximum(power[0] - power[1], 0.0)
    total = max(float(rows.left @ rows.left - rows.silent @ rows.silent), float(np.sum(excess)), 1e-300)
    parts = np.maximum(first[:, 0] - first[:, 1], 0.0) / total
    return {k: float(excess[k] / total) for k in range(ORDERS)}, (float(parts[0]), float(parts[1]))


def tone(rows: Rows) -> tuple[float, float] | None:
    """Frequency in Hz and amplitude (per unit mass) of a line that all long recordings have in common, or None."""
    spectra = [_spectrum(rows, i) for i, s in enumerate(rows.stretches) if _long(s)]
    if not spectra:
        return None
    frequency, standing, _ = max(spectra, key=lambda one: float(np.max(one[1])))
    best = int(np.argmax(standing))
    if standing[best] < _LINE:
        return None
    beside = np.r_[standing[max(best - 12, 0) : max(best - 6, 0)], standing[best + 7 : best + 13]]
    if np.max(beside, initial=0.0) > 0.2 * standing[best]:
        return None  # a resonance or a sweep's passage, not a line
    amplitudes = []
    for other, level, size in spectra:
        near = np.abs(other - frequency[best]) < 1.5 * (other[2] - other[0])
        if not np.any(near) or np.max(level[near]) < _SAME_LINE:
            return None
        amplitudes.append(float(np.max(size[near])))
    return float(frequency[best]), float(np.median(amplitudes))


def _long(s: Stretch) -> bool:
    finite = s.frequency_hz[np.isfinite(s.frequency_hz)]
    return bool(finite.size) and float(np.ptp(s.time)) * float(np.median(finite)) > _LONG_CYCLES


def _spectrum(rows: Rows, index: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies in Hz, power in units of the median around, and amplitude of each line of one stretch."""
    from scipy.ndimage import median_filter

    s = rows.stretches[index]
    step = float(np.min(np.diff(s.time)))
    place = np.round((s.time - s.time[0]) / step).astype(int)
    signal = np.zeros(place[-1] + 1)
    window = np.zeros(place[-1] + 1)
    window[place] = np.hanning(place[-1] + 3)[1:-1][place]
    signal[place] = rows.part(rows.left, index) / rows.part(rows.weight, index)
    transform = np.abs(np.fft.rfft(signal * window, 2 * signal.size))
    frequency = np.fft.rfftfreq(2 * signal.size, step)
    around = median_filter(transform**2, 101, mode="nearest")
    standing = np.where(np.arange(frequency.size) > 50, transform**2 / np.maximum(around, 1e-300), 0.0)
    return frequency, standing, 2 * transform / float(np.sum(window))
