"""Free decays by the force: from the sample after it went off to where it comes on again, or to the noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..signals.limits import CLEAR_OF_NOISE, DECAY_FLOOR, FEWEST_CYCLES, ROUNDING
from ..signals.noise_beside_edges import OF_MEDIAN
from ..signals.signals import drive_of
from .decay import Decay
from .envelope import Envelope
from .limits import FALLS, ON

if TYPE_CHECKING:
    from ...recording.recording import Recording


def force_is_silent(recording: Recording) -> bool:
    """Whether the force column, if there is one, holds nothing but an offset and the white noise of its sensor."""
    drive = drive_of(recording)
    return drive is not None and drive.is_silent


def zero_of(force: np.ndarray, period: int) -> tuple[float, float]:
    """What the force (n,) reads when nothing pushes, and its standard error.

    Of the levels at which it stands still that nearest to zero: a load cell has an offset, and a command in steps
    stands still at several levels, of which all but one push. Where it stands still on either side of zero alone, far
    from it, all of them push. Where it never does, the middle of its cycles.
    """
    mean, spread = _local(force, period)
    largest = float(np.ptp(force))
    if np.min(spread) > ON * np.max(spread):
        return float(np.median(mean)), _error_of_middle(force, period)
    still = spread <= max(DECAY_FLOOR * float(np.min(spread)), ROUNDING * largest)
    nearest = float(mean[still][np.argmin(np.abs(mean[still]))])
    if abs(nearest) > ON * largest and np.any(nearest * mean[still] < 0):
        return 0.0, abs(nearest)  # a command of two levels: between them lies a zero that is not met
    width = DECAY_FLOOR * float(np.max(spread[still])) + ROUNDING * largest
    at_it = still & (np.abs(mean - nearest) <= width)
    cycles = max(1.0, np.count_nonzero(at_it) / period)
    return float(np.median(mean[at_it])), float(np.sqrt(np.mean(spread[at_it] ** 2) / cycles))


def _error_of_middle(force: np.ndarray, period: int) -> float:
    """Standard error of the middle of a force (n,), from the scatter of its means over cycles."""
    count = force.size // period
    if count < FEWEST_CYCLES:
        return np.inf
    means = np.mean(force[: count * period].reshape(count, period), axis=1)
    return float(np.median(np.abs(means - np.median(means)))) * OF_MEDIAN / np.sqrt(count)


def force_off(force: np.ndarray, envelope: Envelope) -> list[Decay]:
    """Decays of a recording with a force (n,), given about its zero."""
    period, size, end_level = envelope.period, envelope.size, envelope.floor
    mean, spread = _local(force, period)
    level = np.hypot(mean, spread)
    floor, top = float(np.min(spread)), float(np.max(level))
    # off: as quiet as the quietest cycle (which is a little below the mean noise), and far below the force itself
    off = (spread <= min(max(DECAY_FLOOR * floor, ROUNDING * top), ON * top)) & (level <= ON * top)
    decays: list[Decay] = []
    for a, b in runs(off):
        if b - a < (FEWEST_CYCLES - 1) * period:
            continue
        quiet = force[a + period // 2 : b - period // 2]
        centre, reach = float(np.mean(quiet)), CLEAR_OF_NOISE * float(np.std(quiet)) + ROUNDING * top
        loud = np.abs(force - centre) > reach
        before = np.flatnonzero(loud[max(0, a - period) : a + period])
        start = max(0, a - period) + int(before[-1]) + 1 if before.size else a
        after = np.flatnonzero(loud[b - period : b + period])
        stop = b - period + int(after[0]) if after.size else b
        low = np.flatnonzero(size[start + period : stop] < end_level)
        fading = start + period + int(low[0]) if low.size else stop
        tail = max(start, fading - period)
        # a blow strikes within a cycle: the envelope is at its height a cycle later
        begin = float(np.max(size[start : start + period]))
        if begin > 2 * end_level and size[tail] < FALLS * begin:
            decays.append(Decay(start, fading))
    return decays


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Runs of True in a mask (n,), as slices."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _local(force: np.ndarray, period: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation (n,) over a cycle."""
    from scipy.ndimage import uniform_filter1d

    centre = float(np.median(force))
    mean = uniform_filter1d(force - centre, period, mode="nearest")
    square = uniform_filter1d((force - centre) ** 2, period, mode="nearest")
    return mean + centre, np.sqrt(np.maximum(square - mean**2, 0))
