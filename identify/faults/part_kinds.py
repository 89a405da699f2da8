"""What a part of a recording that all the rest contradicts looks like: a walk, a swing cut off, a sample held or off.

No size of these is fitted: it is asked of what is left there, by the model that the rest agrees with.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...recording.recording import Recording
from ...recording.resolution import converter_step
from ..fit.reported_result import Fit
from ..problem.segments import Segment
from ..signals.limits import FLAT
from ..signals.noise_spectrum import two_sources
from ..signals.odds import BEYOND_ERRORS, BY_CHANCE
from ..signals.registry import numerics
from ..signals.said import said
from ..signals.signals import noise_levels
from .contradiction import Contradiction
from .limits import PASSED

_SLOWEST = numerics(16, "lines", why="the slowest of a walk: their mean has 32 degrees of freedom")


def kind_of_part(found: Contradiction, fit: Fit, recordings: Sequence[Recording]) -> str | None:
    """What the part shows, in words; None where it is neither.

    Args:
        found: of the fit.
        fit: of the recordings.
        recordings: as they were fitted.
    """
    if found.other is not None:
        return None
    recording = recordings[found.part.recording]
    for fitted, left in zip(fit.segments, found.left, strict=True):
        segment, inside = fitted.segment, found.part.holds(fitted.segment)
        if np.count_nonzero(inside) < FLAT or not np.all(np.isfinite(left[inside])):
            continue  # where the model runs away, what it leaves is not known
        noise = noise_levels(recording)[0]
        if (stood := stands_still(segment, left, inside, noise)) is not None:
            value, begin, end = stood
            return (
                f"from {begin:.4g} to {end:.4g} s the response stands still at {said(recording, value)} while the "
                "thing moves on: the recorder held a sample, or a cable was loose; leave that out (--part FROM:TO)"
            )
        if (spike := lone(segment, left, inside, noise)) is not None:
            size, time = spike
            return (
                f"at {time:.4g} s the response is off by {said(recording, size)} for a sample or two: a spike of "
                "the electronics; leave that out (--part FROM:TO), or record again"
            )
        if (cut := cut_off(segment, left, inside, noise)) is not None:
            top, time = cut
            return (
                f"at {time:.4g} s the top of a swing is cut off at {said(recording, top)}: the sensor or its "
                "amplifier came to its limit; leave out what reaches it (--part FROM:TO), or measure with more range"
            )
        long = 2 * np.count_nonzero(inside) >= segment.n
        if long and (step := walk(left[inside])) is not None:
            size = step * np.sqrt(recording.fs)
            return (
                f"the sensor's zero walks at random, by {said(recording, size)} in a second: it drifts with "
                "temperature or its amplifier integrates noise; mend that, and leave the recording out"
            )
    return None


def walk(left: np.ndarray) -> float | None:
    """Size of a random walk's step from sample to sample where that and white noise are all of a signal (n,).

    Its differences are then two sources of known spectra, and over their sum the periodogram is that of white noise
    (Whittle 1953; Bartlett 1955).
    """
    from scipy.special import chdtr, kolmogorov

    n = left.size - 1
    if n < FLAT**2:
        return None
    periodogram = np.abs(np.fft.rfft(np.diff(left))) ** 2 / n
    turn = 2.0 * np.pi * np.fft.rfftfreq(n)
    known = slice(1, periodogram.size - 1)  # the mean, and the line that has no partner, are distributed otherwise
    steps, noise = two_sources(periodogram[known], 2.0 - 2.0 * np.cos(turn[known]))
    over = periodogram[known] / (steps + noise)
    cumulated = np.cumsum(over) / np.sum(over) - np.arange(1, over.size + 1) / over.size
    white = kolmogorov(float(np.max(np.abs(cumulated))) * np.sqrt(over.size)) >= BY_CHANCE
    freedom = 2 * _SLOWEST
    # what forgets where it was after a while stays where it was
    strays = chdtr(freedom, freedom * float(np.mean(over[:_SLOWEST]))) >= BY_CHANCE
    return float(np.sqrt(np.mean(steps))) if white and strays else None


def cut_off(segment: Segment, left: np.ndarray, inside: np.ndarray, noise: float) -> tuple[float, float] | None:
    """Where the top of a swing in a part is cut off: the level that is shown and the time; None where none is.

    Equal samples beyond which the motion goes on, by more than noise. What has shown twice as much on that side
    elsewhere was not at its limit.

    Args:
        segment: that holds the part.
        left: (n,) of it by the model of the rest.
        inside: (n,) which samples are in the part.
        noise: standard deviation of the sensor's.
    """
    shown = segment.response
    for flat in _flats(shown, left, inside):
        way = np.sign(shown[flat.start])
        limit = np.max(way * shown) <= PASSED * way * shown[flat.start]
        if limit and np.max(-left[flat] * way) > BEYOND_ERRORS * noise:
            return float(shown[flat.start]), segment.time + 0.5 * (flat.start + flat.stop - 1) * segment.dt
    return None


def stands_still(
    segment: Segment, left: np.ndarray, inside: np.ndarray, noise: float
) -> tuple[float, float, float] | None:
    """Where a part stays at one value while the motion passes it: value and times; None where it does not.

    A swing that is cut off is all beyond the value; this one is on its near side too, by more than noise. What stays
    where it is to the end has come to rest.

    Args:
        segment, left, inside, noise: as of ``cut_off``.
    """
    for flat in _flats(segment.response, left, inside):
        way = np.sign(segment.response[flat.start])
        passed = left[flat] * way if way else np.abs(left[flat])
        if flat.stop < segment.n and np.max(passed) > BEYOND_ERRORS * noise:
            begin, end = (segment.time + place * segment.dt for place in (flat.start, flat.stop - 1))
            return float(segment.response[flat.start]), begin, end
    return None


def lone(segment: Segment, left: np.ndarray, inside: np.ndarray, noise: float) -> tuple[float, float] | None:
    """Size and time of what a sample or two of a part are off by, all else in it being noise; None where it is not.

    Args:
        segment, left, inside, noise: as of ``cut_off``.
    """
    off = np.flatnonzero(inside & (np.abs(left) > BEYOND_ERRORS * noise))
    if off.size == 0 or off[-1] - off[0] >= FLAT - 1:
        return None
    top = int(off[np.argmax(np.abs(left[off]))])
    return float(left[top]), segment.time + top * segment.dt


def _flats(shown: np.ndarray, left: np.ndarray, inside: np.ndarray) -> list[slice]:
    """Runs of equal samples of a part that no noise makes, nor a converter: the motion moves by more than its step."""
    step = converter_step(shown)
    same = np.concatenate([[False], (np.diff(shown) == 0.0) & inside[1:] & inside[:-1]])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], same.astype(int), [0]])))
    flats = [slice(int(begin) - 1, int(end)) for begin, end in edges.reshape(-1, 2) if end - begin + 1 >= FLAT]
    return [flat for flat in flats if np.ptp(left[flat]) > step]
