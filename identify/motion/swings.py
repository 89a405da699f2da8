"""Turning points of a motion, and what they say: where it was let go, where it was caught.

The energy of what swings freely only falls. Each swing, from one turning point to the next, is therefore no larger than
the one before it, whatever the spring's law, the amplitude and the pace; and the loss of a swing does not grow as
the swings become smaller (viscous friction takes a part of them, dry friction the same from each, drag their square).
Swings are compared with those in the same direction, so that a drift of the sensor adds alike to both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...recording.oscillation import LEAST_FALL
from ..signals.limits import CLEAR_OF_NOISE, DECAY_PART, SEVERAL
from ..signals.registry import numerics
from .decay import Decay
from .envelope import Envelope
from .force_off import runs
from .hand import OF_MOVED
from .limits import FALLS, KNOWN

_SAMPLES_A_CYCLE = numerics(32, "samples a cycle", why="in which turning points are sought, if there are as many")


@dataclass(frozen=True, eq=False)
class Swings:
    """Turning points: samples ``at`` (m,) of ``n``, the motion there ``value`` (m,) with white noise ``noise``."""

    at: np.ndarray
    value: np.ndarray
    noise: float
    n: int

    @property
    def size(self) -> np.ndarray:
        """(m - 1,) from one turning point to the next."""
        return np.abs(np.diff(self.value))


def swings_of(x: np.ndarray, envelope: Envelope) -> Swings:
    """Turning points of the motion (n,): where it turns back by half its local amplitude."""
    from scipy.ndimage import maximum_filter1d, uniform_filter1d

    step = max(1, envelope.period // _SAMPLES_A_CYCLE)
    noise = envelope.noise / np.sqrt(step)
    local = maximum_filter1d(envelope.size, 2 * envelope.period + 1)[::step]
    turn = np.maximum(local / 2, max(CLEAR_OF_NOISE * noise, envelope.floor / 2))
    smoothed = uniform_filter1d(x, step)[::step] if step > 1 else x
    at = np.array(_zigzag(smoothed.tolist(), turn.tolist()), int)
    return Swings(at * step, smoothed[at], noise, x.size)


def _zigzag(x: list[float], turn: list[float]) -> list[int]:
    """Indices at which the samples turn back by more than `turn`."""
    low = high = 0
    rising = 0
    turns: list[int] = []
    for i, value in enumerate(x):
        if value > x[high]:
            high = i
        if value < x[low]:
            low = i
        if rising >= 0 and x[high] - value > turn[i]:
            turns.append(high)
            rising, low, high = -1, i, i
        elif rising <= 0 and value - x[low] > turn[i]:
            turns.append(low)
            rising, low, high = 1, i, i
    if turns:
        turns.append(high if rising > 0 else low)
    return turns


def release(x: np.ndarray, swings: Swings, start: int) -> int | None:
    """The turning point from which the motion is free, where it was let go, pushed or struck by something unrecorded.

    From the sample ``start`` on the motion is known to be free. Going back, each swing must be larger than the next;
    the first that is not is the hand's. Where the motion begins from a hold, its first swing is left out too: nobody
    knows when the hand was gone. None where no release is seen, as after a drive that was switched off.
    """
    at, size = swings.at, swings.size
    known = int(np.searchsorted(at, start))
    if known + 2 > size.size:
        return None
    k = known
    while k > 0 and _precedes(swings, k - 1):
        k -= 1
    if _still_before(x, swings, k):
        return int(at[min(k + 1, known) if k < known else k + 1])
    if k == 0 or k + 1 >= size.size:
        return None
    held = at[k] - at[k - 1] > 2 * (at[k + 1] - at[k])
    # what swelled little by little may have been driven, and a drive may let it sink
    return int(at[k]) if held or size[k - 1] < FALLS * size[k + 1] else None


def _precedes(swings: Swings, j: int) -> bool:
    """Whether swing j may have been free, as the one after it was."""
    size, lasts = swings.size, np.diff(swings.at)
    if j + 2 >= size.size:
        return False
    grows = size[j] >= size[j + 2] - 2 * swings.noise and size[j] < 2 * size[j + 1]
    return bool(grows and lasts[j] <= 2 * lasts[j + 1])


def _still_before(x: np.ndarray, swings: Swings, k: int) -> bool:
    """Whether the motion stands still before it leaves the turning point k."""
    swing, lasts = swings.size[k], swings.at[k + 1] - swings.at[k]
    after = lasts if k + 2 >= swings.at.size else min(lasts, swings.at[k + 2] - swings.at[k + 1])
    first = max(0, swings.at[k] - after)
    near = np.abs(x[first : swings.at[k + 1]] - swings.value[k]) < max(
        DECAY_PART * swing, CLEAR_OF_NOISE * swings.noise
    )
    leaves = int(np.flatnonzero(near)[-1]) + 1 if near.any() else 0
    away = np.flatnonzero(~near[:leaves])
    dwell = leaves - (int(away[-1]) + 1 if away.size else 0)
    # a turning point is reached and left: it dwells on both sides of it, and a held mass on each for half a swing
    return dwell > after if first < swings.at[k] - 1 else 2 * dwell > after


def caught(swings: Swings, start: int, stop: int) -> int | None:
    """The last turning point between two samples after which the motion was still free, where it was stopped then."""
    inside = np.flatnonzero((swings.at >= start) & (swings.at < stop))
    several = 2 * SEVERAL  # in either direction
    if inside.size < several:
        return None
    size, lasts = swings.size, np.diff(swings.at)
    last = size.size  # the record may end within its last swing
    if swings.n - swings.at[-1] < lasts[-2]:
        last -= 1
    for k in range(int(inside[0]) + several, min(int(inside[-1]) + 1, last)):
        before = slice(max(int(inside[0]), k - several), k)
        # a loss is a difference of two swings, each of two turning points
        usual = np.max(np.abs(size[before][:-2] - size[before][2:])) + CLEAR_OF_NOISE * 2 * swings.noise
        loss = size[k - 2] - size[k]
        if loss > 2 * usual and 2 * loss > size[k - 2]:
            return int(swings.at[k])
        # dry friction holds the mass by itself once it swings no further than a few losses
        if lasts[k] > 2 * np.max(lasts[before]) and size[k - 1] > 2 * usual:
            return int(swings.at[k])
    return None


def swell_of(swings: Swings, decays: Sequence[Decay]) -> tuple[int, int] | None:
    """The samples between which most swings in a row grow, outside of decays; None where a hand's way has as many.

    A hand that carries a mass from one place to another turns back a few times at most (``hand``); what grows swing by
    swing more often is driven. What grows to less than a third of the decays has driven none of them.
    """
    size, at = swings.size, swings.at
    grows, falls = size[2:] >= size[:-2], np.zeros(size.size, bool)
    for decay in decays:
        grows &= (at[3:] <= decay.start) | (at[:-3] >= decay.stop)
        falls |= (at[1:] > decay.start) & (at[:-1] < decay.stop)
    least = KNOWN * float(np.max(size[falls], initial=0.0))
    best = None
    for a, b in runs(grows):
        gained = float(size[b] + size[b + 1] - size[a] - size[a + 1])
        longest = OF_MOVED - 2 if best is None else best[1] - best[0]
        if b - a > longest and gained > 2 * max(CLEAR_OF_NOISE * swings.noise, least):
            best = (a, b)
    return None if best is None else (int(at[best[0]]), int(at[best[1] + 2]))


def falls_steadily(swings: Swings, start: int, stop: int) -> bool:
    """Whether the swings between two samples fall, by a tenth at least, far beyond what scatters them.

    That is what they differ by from the nearest sizes that never rise, in either direction: noise, another mode, frames
    of a camera that are off. What is driven, or beats, rises and falls by much of what it falls by altogether.
    """
    from scipy.optimize import isotonic_regression

    last = swings.at.size - 1  # which is where the record ends, as the first may be where it begins
    inside = np.flatnonzero((swings.at >= start) & (swings.at < stop) & (swings.at > 0) & (np.arange(last + 1) < last))
    if inside.size <= 2 * SEVERAL:
        return False
    size = swings.size[inside[:-1]]
    nearest = np.empty_like(size)
    for way in (slice(0, None, 2), slice(1, None, 2)):
        nearest[way] = isotonic_regression(size[way], increasing=False).x
    scatter = max(swings.noise, float(np.sqrt(np.mean((size - nearest) ** 2))))
    fall = float(size[0] + size[1] - size[-1] - size[-2]) / 2
    first, second = size[0] - size[size.size // 2], size[size.size // 2] - size[-1]
    even = 2 * first > second  # a larger swing loses no less; what is driven at first loses nothing
    return bool(even and fall > LEAST_FALL * size[0] and fall > 2 * CLEAR_OF_NOISE * scatter)
