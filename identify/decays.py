"""Free decays in a recording, found by themselves: where the force is off, or where the envelope falls steadily."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .hilbert import blackman, dominant_frequency, noise_level

if TYPE_CHECKING:
    from ..recording.recording import Recording

SHORTEST_CYCLES = 5.0  # below this there is no decay to speak of
ABOVE_FLOOR = 2.0  # a decay ends where its envelope has come down to this many times that of the noise


@dataclass(frozen=True)
class Decay:
    """A free decay: samples start to stop of a recording, as Python slices them."""

    start: int
    stop: int


def find_decays(recording: Recording) -> tuple[Decay, ...]:
    """Find the free decays of a recording, in order of time; none is an empty tuple, not an error.

    With a force: from the sample after the force went off (its level over a cycle is down at its own noise) to where it
    comes on again. Without one, or with a force that is zero throughout: where the envelope falls steadily, beginning
    a cycle after the corner at which it begins to fall, so that no driven part is in it. Both end where the envelope
    meets the noise of the recording.
    """
    x, fs = np.asarray(recording.response, float), recording.fs
    try:
        f = dominant_frequency(x, fs)
    except BadInput:
        return ()
    period = max(2, round(fs / f))
    if x.size < SHORTEST_CYCLES * period or period < 5:
        return ()
    envelope = _envelope(x, period)
    end_level = ABOVE_FLOOR * _floor(x, fs, envelope, period)
    force = recording.force
    if force is None or force_is_silent(recording):
        found = _falling(envelope, end_level, period, 0, x.size)
        if force is not None and np.ptp(force) > 0:
            # white noise may be a shaker's too: only a fall to the noise, or the whole record, is a free decay then
            found = [d for d in found if envelope[d.stop - 1] < 1.1 * end_level or d.stop - d.start > 0.8 * x.size]
    else:
        found = _force_off(np.asarray(force, float), envelope, end_level, period)
    long_enough = [d for d in found if d.stop - d.start >= SHORTEST_CYCLES * period]
    return tuple(sorted(long_enough, key=lambda d: d.start))


def force_is_silent(recording: Recording) -> bool:
    """Whether the force column, if there is one, holds nothing but an offset and the white noise of its sensor."""
    force = recording.force
    if force is None:
        return False
    if np.ptp(force) == 0:
        return True
    return noise_level(np.asarray(force), recording.fs) > 0.7 * float(np.std(force))


def _envelope(x: np.ndarray, period: int) -> np.ndarray:
    """Amplitude (n,) from the local variance under a kernel of two cycles: an offset or slow drift does not count."""
    kernel = np.maximum(blackman(2 * period)[0], 0)
    half = kernel.size // 2
    padded = np.pad(x - np.median(x), half, mode="symmetric")
    mean = np.convolve(padded, kernel, mode="valid")
    square = np.convolve(padded**2, kernel, mode="valid")
    return np.sqrt(2 * np.maximum(square - mean**2, 0))


def _floor(x: np.ndarray, fs: float, envelope: np.ndarray, period: int) -> float:
    """Envelope of the noise: of the white noise, or of the recording where it is at rest, whichever is larger."""
    top = float(np.max(envelope))
    white = np.sqrt(2) * noise_level(x, fs)
    low = int(np.argmin(envelope))
    level = 1.5 * float(envelope[low])
    a, b = _run(envelope <= level, low)
    rest = 0.0
    if b - a >= 8 * period:
        first, last = np.median(envelope[a : a + 2 * period]), np.median(envelope[b - 2 * period : b])
        if abs(first - last) < 0.25 * max(first, last):
            rest = float(np.median(envelope[a:b]))
    return max(white, rest, 1e-6 * top)


def _run(mask: np.ndarray, inside: int) -> tuple[int, int]:
    """The run of True in `mask` around the sample `inside`, as a slice."""
    after = np.flatnonzero(~mask[inside:])
    before = np.flatnonzero(~mask[: inside + 1])
    return (int(before[-1]) + 1 if before.size else 0), (inside + int(after[0]) if after.size else mask.size)


def _force_off(force: np.ndarray, envelope: np.ndarray, end_level: float, period: int) -> list[Decay]:
    kernel = np.ones(period) / period
    level = np.sqrt(np.maximum(np.convolve(np.pad(force**2, period, mode="edge"), kernel, "same")[period:-period], 0))
    floor, top = float(np.min(level)), float(np.max(level))
    # off: at the level of the quietest cycle (which is a little below the mean noise), and far below the force itself
    off = level <= min(max(3 * floor, 1e-6 * top), 0.15 * top)
    found: list[Decay] = []
    for a, b in _runs(off):
        if b - a < (SHORTEST_CYCLES - 1) * period:
            continue
        quiet = force[a + period // 2 : b - period // 2]
        centre, reach = float(np.mean(quiet)), 5 * float(np.std(quiet)) + 1e-9 * top
        loud = np.abs(force - centre) > reach
        before = np.flatnonzero(loud[max(0, a - period) : a + period])
        start = max(0, a - period) + int(before[-1]) + 1 if before.size else a
        after = np.flatnonzero(loud[b - period : b + period])
        stop = b - period + int(after[0]) if after.size else b
        low = np.flatnonzero(envelope[start:stop] < end_level)
        fading = start + int(low[0]) if low.size else stop
        tail = max(start, fading - period)
        if fading > start and envelope[start] > 2 * end_level and envelope[tail] < 0.8 * envelope[start]:
            found.append(Decay(start, fading))
    return found


def _runs(mask: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _falling(envelope: np.ndarray, end_level: float, period: int, first: int, last: int) -> list[Decay]:
    """Decays between two samples: the highest envelope, what falls from there, then the same left and right of it."""
    found: list[Decay] = []
    todo = [(first, last)]
    while todo:
        a, b = todo.pop()
        if b - a < SHORTEST_CYCLES * period:
            continue
        top = a + int(np.argmax(envelope[a:b]))
        if envelope[top] < 3 * end_level:
            continue
        stop = _end_of_fall(envelope, end_level, top, b)
        start = _corner(envelope, period, a, top, stop)
        if (
            start is not None
            and stop - start >= SHORTEST_CYCLES * period
            and envelope[stop - 1] < 0.6 * envelope[start]
        ):
            found.append(Decay(start, stop))
        todo += [(a, top), (max(stop, top + period), b)]
    return found


def _end_of_fall(envelope: np.ndarray, end_level: float, top: int, b: int) -> int:
    """First sample at the noise, or the lowest one before the envelope rises by a quarter again, or `b`."""
    part = envelope[top:b]
    low = np.flatnonzero(part < end_level)
    if low.size:
        part = part[: int(low[0])]
    rising = np.flatnonzero(part > 1.25 * np.minimum.accumulate(part))
    return top + (int(np.argmin(part[: int(rising[0])])) if rising.size else part.size)


def _corner(envelope: np.ndarray, period: int, a: int, top: int, stop: int) -> int | None:
    """Where the fall from `top` to `stop` begins: before it the envelope falls at less than half its later rate."""
    fall = np.log(np.maximum(envelope[top:stop], 1e-300))
    well_down = np.flatnonzero(fall < fall[0] + np.log(0.8))
    if not well_down.size:
        return None
    k = int(well_down[0])
    deep = np.flatnonzero(fall < fall[0] + np.log(0.3))
    end = int(deep[0]) if deep.size else fall.size - 1
    if end <= k:
        return None
    rate = (fall[k] - fall[end]) / (end - k)
    ahead = np.minimum(np.arange(fall.size) + period, fall.size - 1)
    steep = fall - fall[ahead] >= 0.5 * rate * (ahead - np.arange(fall.size))
    slack = np.flatnonzero(~steep[: k + 1])
    corner = top + (int(slack[-1]) + 1 if slack.size else 0)
    if a == 0 and corner <= 1.5 * period:
        return 0  # the record begins with the decay: its first cycle has no cycle before it to compare with
    return corner + period
