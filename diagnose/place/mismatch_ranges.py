"""Where along a coordinate the missing force lies: ranges that stand out of the noise, harmonic orders, one tone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...identify.signals.odds import DECISIVE, SIGNIFICANT
from ...identify.signals.registry import numerics
from ..limits import (
    FEWEST_IN_RANGE,
    LINE_CYCLES,
    NARROW,
    NOISE_DOUBT,
    NOTABLE,
    SAMPLES_A_RANGE,
    STEADY,
)
from .equation_error import Stretch
from .free_form import Rows

_SAME = numerics(1.5, "bins", why="one frequency in spectra of two lengths")
_AROUND = numerics(50, "bins", why="on either side of a line, whose median is the spectrum around it")
_BESIDE = numerics(6, "bins", why="a line under its window is no wider")
_FAR = numerics(12, "bins", why="as far again")

_BINS = numerics(20, "ranges of a coordinate", why="as many as a picture shows")
ORDERS = numerics(6, "harmonics", why="above the sixth nothing of a smooth force is left")


@dataclass(frozen=True)
class Line:
    """A line in the spectrum of the missing force.

    Attributes:
        frequency_hz, amplitude: where it is, and how strong (per unit mass).
        steady: whether it is as strong in all recordings, as a force from outside is; a second body rings the more
            the harder it is driven.
    """

    frequency_hz: float
    amplitude: float
    steady: bool


def excess_range(rows: Rows, values: np.ndarray) -> tuple[float, float] | None:
    """Lowest and highest value between which the missing force's power stands out; None where it does nowhere."""
    fine = np.isfinite(values)
    if np.count_nonzero(fine) < SAMPLES_A_RANGE * _BINS:
        return None
    values = values[fine]
    low, high = np.quantile(values, [0.002, 0.998])
    edges = np.linspace(low, high, _BINS + 1)
    cell = np.clip(np.searchsorted(edges, values) - 1, 0, _BINS - 1)
    left, silent = rows.left[fine] ** 2, rows.silent[fine] ** 2
    blocks = rows.block[fine]
    clear = np.zeros(_BINS, bool)
    mean = np.zeros(_BINS)
    for i in range(_BINS):
        here = cell == i
        if np.count_nonzero(here) >= FEWEST_IN_RANGE:
            clear[i], mean[i] = _beyond(left[here], silent[here], blocks[here])
    clear &= mean > NOTABLE * np.max(mean, initial=0.0, where=clear)
    if not np.any(clear):
        return None
    return float(edges[np.argmax(clear)]), float(edges[_BINS - np.argmax(clear[::-1])])


def where_it_is(rows: Rows) -> list[bool]:
    """For each stretch whether its missing force is beyond the noise, block by block."""
    beyond = []
    for i in range(len(rows.stretches)):
        left, silent = rows.part(rows.left, i), rows.part(rows.silent, i)
        beyond.append(_beyond(left**2, silent**2, rows.part(rows.block, i))[0])
    return beyond


def _beyond(left: np.ndarray, silent: np.ndarray, block: np.ndarray) -> tuple[bool, float]:
    """Whether power is beyond that of the noise by its own scatter from block to block, and how much a sample."""
    block = block - block.min()
    count = np.bincount(block)
    sums = np.bincount(block, silent)[count > 0]
    spread = np.sqrt(2.0 * np.sum((sums - np.mean(sums)) ** 2)) if sums.size > 2 else 2.0 * np.sum(sums)
    excess, noise = float(np.sum(left) - np.sum(silent)), float(np.sum(silent))
    return bool(excess > SIGNIFICANT * spread and excess > NOISE_DOUBT * noise), excess / left.size


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
            coefficients = 2 * ORDERS
            if np.count_nonzero(here) < 2 * coefficients:
                continue
            coefficients = np.linalg.lstsq(columns[here], signals[here], rcond=1e-6)[0]
            count = np.count_nonzero(here)
            cosine, sine = coefficients[1:ORDERS] ** 2 / 2, coefficients[ORDERS:] ** 2 / 2
            power += count * np.vstack([coefficients[0] ** 2, cosine + sine]).T
            first += count * np.vstack([cosine[0], sine[0]])
    excess = np.maximum(power[0] - power[1], 0.0)
    total = max(float(rows.left @ rows.left - rows.silent @ rows.silent), float(np.sum(excess)), 1e-300)
    parts = np.maximum(first[:, 0] - first[:, 1], 0.0) / total
    return {k: float(excess[k] / total) for k in range(ORDERS)}, (float(parts[0]), float(parts[1]))


def line_in(rows: Rows) -> Line | None:
    """The line that all long recordings have in common, or None."""
    spectra = [_spectrum(rows, i) for i, s in enumerate(rows.stretches) if _long(s)]
    if not spectra:
        return None
    frequency, standing, _ = max(spectra, key=lambda spectrum: float(np.max(spectrum[1])))
    best = int(np.argmax(standing))
    # of noise the powers are exponentially distributed, and their median is log 2 of their mean
    by_chance = DECISIVE / math.log(2.0)
    if standing[best] < by_chance + math.log2(standing.size):
        return None
    beside = np.r_[
        standing[max(best - _FAR, 0) : max(best - _BESIDE, 0)], standing[best + _BESIDE + 1 : best + _FAR + 1]
    ]
    if np.max(beside, initial=0.0) > NARROW * standing[best]:
        return None  # a resonance or a sweep's passage, not a line
    amplitudes = []
    for other, level, size in spectra:
        near = np.abs(other - frequency[best]) < _SAME * (other[2] - other[0])
        if not np.any(near) or np.max(level[near]) < by_chance:  # one frequency is asked for there, and not any
            return None
        amplitudes.append(float(np.max(size[near])))
    steady = min(amplitudes) > STEADY * max(amplitudes)
    return Line(float(frequency[best]), float(np.median(amplitudes)), steady)


def _long(s: Stretch) -> bool:
    finite = s.frequency_hz[np.isfinite(s.frequency_hz)]
    return bool(finite.size) and float(np.ptp(s.time)) * float(np.median(finite)) > LINE_CYCLES


def _spectrum(rows: Rows, index: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies in Hz, power in units of the median around, and amplitude of each line of one stretch."""
    from scipy.ndimage import median_filter

    s = rows.stretches[index]
    step = float(np.min(np.diff(s.time)))
    cell = np.round((s.time - s.time[0]) / step).astype(int)
    signal = np.zeros(cell[-1] + 1)
    window = np.zeros(cell[-1] + 1)
    window[cell] = np.hanning(cell[-1] + 3)[1:-1][cell]
    signal[cell] = rows.part(rows.left, index) / rows.part(rows.weight, index)
    transform = np.abs(np.fft.rfft(signal * window, 2 * signal.size))
    frequency = np.fft.rfftfreq(2 * signal.size, step)
    around = median_filter(transform**2, 2 * _AROUND + 1, mode="nearest")
    standing = np.where(np.arange(frequency.size) > _AROUND, transform**2 / np.maximum(around, 1e-300), 0.0)
    return frequency, standing, 2 * transform / float(np.sum(window))
