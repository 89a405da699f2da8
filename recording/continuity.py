"""Samples that cannot be what a sensor saw: a displacement that leaps, and blocks that are written twice.

A recorder that loses, holds or repeats samples without a clock in its file leaves a record that looks whole, and a fit
that is off by tens of its standard errors: what follows the gap comes too early or too late.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .resolution import rounding_noise

#: Physical limit: within a cycle no sample of a thing with mass goes this many times as far as every other.
_LEAP = 3.0
#: Noise of so many standard deviations is not met in any record.
_NOISE = 6.0
#: Samples on either side of a leap over which a signal that was resampled by splines rings, and what it rings by then.
_RINGS, _RINGING = 2, 5e-3
#: Part of an edge that the steps on either side of it may have, and of all squared steps that edges then are.
_BESIDE, _NEARLY_ALL = 0.1, 0.9
#: Standard deviations below which a quarter of the absolute values of a normal variable lie.
_QUARTER = 0.3186
#: What is left about levels is noise where it is no larger than this many times the noise beside them.
_LIKE_NOISE = 1.3
#: Part of the range that the mean of equal numbers is off.
_ROUNDING = 1e-12
#: Leaps that are told; more of them are the way in which the thing moves, or its sensor works.
_MOST = 5
#: Samples in a block that is compared; of so many values with noise on them none are the same by chance ...
_BLOCK = 16
#: ... where at least this many of them differ: at rest, and between steps of a coarse converter, they repeat.
_VALUES = 8
#: Signs in a row that are compared of two recordings, and the part of the range to which a file of six digits rounds.
_SIGNS = 60
_ROUNDED = 1e-6


@dataclass(frozen=True)
class Leap:
    """Between which samples a displacement leaps, by how much, and how many times as far as any step that is none.

    ``back`` says that the next step leads back, or that there is none: one sample is wrong.
    """

    first: int
    size: float
    times: float
    back: bool


def leaps(displacement: np.ndarray, cycle: float) -> list[Leap]:
    """Steps that no motion makes, between motion, in the order of time; none where there are more than a few.

    The speed of a mass is continuous but for impacts, and after these as large as elsewhere in the cycle. The first and
    the last sample have motion on one side alone; a last number that was cut short as it was written is such a leap.

    Args:
        displacement: (n,) samples.
        cycle: samples in a cycle of the motion.
    """
    from scipy.ndimage import maximum_filter1d

    steps = np.diff(displacement)
    size, reach = np.abs(steps), max(4, round(cycle))
    if size.size <= 2 * reach:
        return []
    widest = maximum_filter1d(size, reach, mode="constant")
    before, after = np.zeros_like(size), np.zeros_like(size)
    near = reach // 2 + 2  # the window of so many samples ends two away
    before[near:], after[:-near] = widest[:-near], widest[near:]
    ordinary, noise = np.maximum(before, after), _NOISE * noise_beside(displacement)
    moving = np.minimum(before, after) > noise  # a file may well begin or end with a rest somewhere else
    ends = [0, size.size - 1]
    moving[ends] = size[ends] > _LEAP * noise  # though no rest of one sample
    found: list[Leap] = []
    for place in np.flatnonzero(moving & (size > _LEAP * ordinary)):
        if found and place == found[-1].first + 1 and steps[place] * steps[place - 1] < 0:
            found[-1] = replace(found[-1], back=True)
            continue
        times = float(size[place] / max(ordinary[place], noise))
        found.append(Leap(int(place), float(steps[place]), times, place in ends))
    return found if len(found) <= _MOST else []


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Places of the samples before which an angle (n,), in rad, was brought back into one turn; empty where none was.

    An encoder or an arctangent that shows -180 degrees next to +180. Half a turn in a sample is a physical limit: a
    faster rotation cannot be told from one the other way. With the turn put back no such step may be a leap, and all
    that is shown must lie within a turn.
    """
    steps = np.diff(angle)
    over = np.abs(steps) > np.pi
    if not np.any(over) or np.all(over):
        return np.zeros(0, int)
    ordinary = float(np.max(np.abs(steps[~over])))
    within = float(np.ptp(angle)) <= 2 * np.pi + ordinary
    back = np.abs(steps[over] - 2 * np.pi * np.sign(steps[over]))
    return np.flatnonzero(over) + 1 if within and np.max(back) <= _LEAP * ordinary else np.zeros(0, int)


def folded(signal: np.ndarray) -> np.ndarray:
    """Places of the samples before which a signal (n,) left its range and went on at the other end; empty where none.

    A counter or a converter that does not stop at its limit. Its leaps go over all of its range, out and
    back again, and stand out from its steps; in between it moves on, away from the limit by more than noise, which a
    force that is switched does not, from however many levels, nor what a resampling makes of its edges.
    """
    steps = np.diff(signal)
    over = np.abs(steps) > 0.5 * np.ptp(signal)
    places = np.flatnonzero(over) + 1
    if places.size < 2 or np.all(over) or _levels(signal) is not None:
        return np.zeros(0, int)
    ordinary, ways = float(np.max(np.abs(steps[~over]))), np.sign(steps[over])
    whole = np.all(np.abs(steps[over]) >= np.ptp(signal) - _LEAP * ordinary)
    pairs = zip(ways[::2], ways[1::2], strict=False)
    if not whole or np.min(np.abs(steps[over])) <= _LEAP * ordinary or any(out == back for out, back in pairs):
        return np.zeros(0, int)
    beyond = [signal[first:last] for first, last in zip(places[:-1:2], places[1::2], strict=False)]
    within = [piece[_RINGS:-_RINGS] for piece in beyond if piece.size > 2 * _RINGS]
    away = min(float(np.ptp(piece)) for piece in beyond)
    middle = float(np.median([np.ptp(piece) for piece in within])) if within else 0.0
    moves = away > _NOISE * noise_beside(signal) and middle > _RINGING * np.ptp(signal)
    return places if moves else np.zeros(0, int)


def is_switched(signal: np.ndarray) -> bool:
    """Whether a signal (n,) goes from level to level at once, as a command in steps does.

    Nearly all that it goes, in squares, it then goes in single steps, with next to none before and behind them.
    """
    return edges_of(signal).size > 0


def is_rough(signal: np.ndarray) -> bool:
    """Whether samples (n,) are told by the cubic through their neighbours no better than by their mean.

    As those of a white command, which a converter holds and no curve joins.
    """
    told = (4.0 * (signal[1:-3] + signal[3:-1]) - signal[:-4] - signal[4:]) / 6.0
    return bool(told.size and np.mean((signal[2:-2] - told) ** 2) > np.var(signal))


def edges_of(signal: np.ndarray) -> np.ndarray:
    """The samples that the steps of a switched signal (n,) lead to; none where it is not switched."""
    return _edges(signal)[0]


def without_noise(signal: np.ndarray) -> np.ndarray:
    """A switched signal (n,) as the levels that were commanded: white noise of its sensor is none of the command.

    As it is where it is not switched, or goes on between its edges by more than noise.
    """
    levels = _levels(signal)
    return signal if levels is None or not noise_beside(signal) > 0.0 else levels


def _levels(signal: np.ndarray) -> np.ndarray | None:
    """(n,) levels between which a signal is switched; None where it is not, or goes on between its edges."""
    edges, noise = _edges(signal)
    if not edges.size:
        return None
    pieces = np.split(signal, edges)
    levels = np.repeat([float(np.mean(piece)) for piece in pieces], [piece.size for piece in pieces])
    return levels if np.std(signal - levels) <= max(_LIKE_NOISE * noise, _ROUNDING * np.ptp(signal)) else None


def _edges(signal: np.ndarray) -> tuple[np.ndarray, float]:
    """The samples that single steps of a switched signal (n,) lead to, none where it is not, and its noise."""
    steps = np.abs(np.diff(signal))
    if steps.size < 3:
        return np.zeros(0, int), 0.0
    # levels of a few samples leave no fourth difference without an edge, but one first difference in four
    noise = min(noise_beside(signal), float(np.quantile(steps, 0.25)) / (_QUARTER * np.sqrt(2.0)))
    least = _NOISE * np.sqrt(2.0) * noise
    beside, step = np.maximum(steps[:-2], steps[2:]), steps[1:-1]
    single = (step > least) & (beside < np.maximum(_BESIDE * step, least))
    gone = float(np.sum(steps**2)) - 2.0 * steps.size * noise**2
    switched = np.sum(step[single] ** 2) > _NEARLY_ALL * gone > 0.0
    return np.flatnonzero(single) + 2 if switched else np.zeros(0, int), noise


def noise_beside(signal: np.ndarray) -> float:
    """Standard deviation of the noise on a signal (n,), whatever it does at a few instants.

    As ``clipping.noise_of``, by the median of the fourth differences, 0.6745 of their standard deviation.
    """
    middle = float(np.median(np.abs(np.diff(signal, 4))))
    return max(middle / (0.6745 * np.sqrt(70)), rounding_noise(signal))


def repeated(signals: np.ndarray) -> tuple[int, int, int] | None:
    """First sample, earlier first sample and length of a block that is written twice in all (channels, n) signals."""
    channels, n = signals.shape
    if n < 2 * _BLOCK:
        return None
    windows = np.lib.stride_tricks.sliding_window_view(signals, _BLOCK, axis=1)  # (channels, n - 15, 16)
    mixed = np.random.default_rng(0).standard_normal((channels, _BLOCK))
    marks = np.einsum("cnk,ck->n", windows, mixed)
    order = np.argsort(marks, kind="stable")
    same = np.flatnonzero(np.diff(marks[order]) == 0.0)
    for first in same:
        earlier, later = sorted((int(order[first]), int(order[first + 1])))
        block = signals[:, later : later + _BLOCK]
        if not np.array_equal(signals[:, earlier : earlier + _BLOCK], block):
            continue
        if min(np.unique(block[channel]).size for channel in range(channels)) < _VALUES:
            continue
        length = _BLOCK
        while later + length < n and np.array_equal(signals[:, earlier + length], signals[:, later + length]):
            length += 1
        while earlier > 0 and np.array_equal(signals[:, earlier - 1], signals[:, later - 1]):
            earlier, later, length = earlier - 1, later - 1, length + 1
        return later, earlier, length
    return None


def in_both(signals: Sequence[np.ndarray]) -> tuple[int, int, int, int, int] | None:
    """Places of two of several (channels, n) signals, first samples in each, and length of a block that both hold.

    Of each first channel the signs of so many third differences in a row are compared, which no noise shows twice; what
    they say is proved by the samples of all channels, which are the same to what a file of six digits leaves of them.
    One sort of all marks says which pairs and which shifts are asked.
    """
    if len(signals) < 2:
        return None
    marks = [_marks(signal[0]) for signal in signals]
    every = np.concatenate([*marks, np.zeros(0, np.uint64)])
    owner = np.repeat(np.arange(len(marks)), [mark.size for mark in marks])
    place = np.concatenate([*(np.arange(mark.size) for mark in marks), np.zeros(0, int)])
    order = np.argsort(every, kind="stable")
    before, after = order[:-1], order[1:]
    met = (every[before] == every[after]) & (owner[before] != owner[after])
    pairs = np.column_stack([owner[before], owner[after], place[after] - place[before]])[met]
    shifts, counts = np.unique(pairs, axis=0, return_counts=True)
    for one, other, lag in shifts[np.argsort(-counts)][:_MOST]:
        first, second = signals[one], signals[other]
        begin, end = max(0, -lag), min(first.shape[1], second.shape[1] - lag)
        if len(first) != len(second):
            continue
        sizes = np.maximum(np.ptp(first, axis=1), np.ptp(second, axis=1))[:, None]
        off = np.abs(first[:, begin:end] - second[:, begin + lag : end + lag])
        same = np.all(off <= _ROUNDED * sizes, axis=0)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], same.astype(int), [0]]))).reshape(-1, 2)
        at, stop = max(edges.tolist(), key=lambda edge: edge[1] - edge[0], default=(0, 0))
        if stop - at >= _SIGNS:
            return int(one), int(other), int(begin + at), int(begin + at + lag), int(stop - at)
    return None


def _marks(signal: np.ndarray) -> np.ndarray:
    """(n - _SIGNS - 2,) of each place the signs of so many third differences from there on, as one number."""
    signs = (np.diff(signal, 3) > 0).astype(np.uint64)
    if signs.size < _SIGNS:
        return np.zeros(0, np.uint64)
    windows = np.lib.stride_tricks.sliding_window_view(signs, _SIGNS)
    return windows @ (np.uint64(1) << np.arange(_SIGNS, dtype=np.uint64))
