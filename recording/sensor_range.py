"""Samples beyond the range of a sensor: tops that scatter behind a limit, and what shows the other end of the range.

A smooth top that is entered with the slope s and left with -s after L samples is s L / 4 high, as a parabola is; of a
sine it is up to a quarter higher. Behind a limit it is as high as the sensor's scatter, whatever the slopes are. One
flat top may be the motion's own; a limit is where several end, each within a cycle. A sensor that folds over shows
one level, far from all others, and goes there from the other end of its range and back.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .clipping import clipping
from .continuity import noise_beside
from .missing import Runs, Whole, made_whole, runs_of, spans
from .resolution import converter_step

#: A smooth top is this many times less high than its slopes say: a sine's 1.3 times, and half as much again where the
#: slopes are measured half its length away; of four samples, 2.3 times.
_FLAT = 4.0
#: Samples of the shortest top: its length is known to one of them.
_SHORTEST = 4
#: Tops at a limit, at least: one may be the motion's own.
_VISITS = 2
#: Scatter behind a limit, in standard deviations of the noise at least, and in parts of the range at most.
_NOISE, _WIDEST = 4.0, 0.05
#: Steps to the other end of the range, in steps that are none, at least; what is shown there is one level to this part
#: of what lies between.
_LEAPS, _ONE = 3.0, 1e-3


#: Part of what a signal falls beside a top that it falls in the nearer half: from rest, as where a hand lets go, a
#: quarter, and somewhat more a few samples later; from a parabola whose tip is cut off, 5/12.
_AT_ONCE = 3 / 8


@dataclass(frozen=True)
class Beyond:
    """Samples beyond the range of a sensor, as slices, the level at which it ends, and what it shows beyond."""

    level: float
    runs: Runs
    shown: float | None = None


def seen_whole(where: str, columns: np.ndarray, fs: float, *, imposed: bool = False) -> Whole:
    """Signals (n, k), response before force, with what they lack filled: see ``made_whole``.

    What the response shows beyond the range of its sensor is lacking. A sensor that stands still at its limit, to the
    last digit, is left to ``clipping``.
    """
    response = columns[:, 0]
    there = np.isfinite(response)
    shown = np.interp(np.arange(response.size), np.flatnonzero(there), response[there]) if np.any(there) else response
    if response.size < 4 * _SHORTEST or not np.ptp(shown) > 0:
        return made_whole(where, columns, fs, imposed=imposed)
    power = np.abs(np.fft.rfft(shown - np.mean(shown))) ** 2
    found = beyond_range(shown, response.size / (1 + int(np.argmax(power[1:]))))
    if any(end.shown is None for end in found) and clipping(shown):
        found = []
    mask, notes = np.zeros(response.size, bool), []
    for end in found:
        for a, b in end.runs:
            mask[a:b] = True
        times = spans((a / fs, b / fs) for a, b in end.runs)
        what = "it stands at its limit" if end.shown is None else f"it shows {end.shown:.4g} instead"
        notes.append(
            f"{where}: the response goes beyond the range of its sensor, which ends at {end.level:.4g}: {what}, "
            f"{times} from the start; these {sum(b - a for a, b in end.runs)} samples are not fitted"
        )
    whole = made_whole(where, columns, fs, mask if found else None, imposed=imposed)
    return replace(whole, notes=(*notes, *whole.notes))


def beyond_range(signal: np.ndarray, cycle: float) -> list[Beyond]:
    """Ends of a sensor's range that a signal (n,) goes beyond: none, one or two.

    Args:
        signal: finite.
        cycle: samples in a cycle of the motion.
    """
    if signal.size < 4 * _SHORTEST:
        return []
    if (fold := _folded(signal)) is not None:
        return [fold]
    sides = [_limit(sign * signal, sign, cycle) for sign in (1.0, -1.0)]
    return [side for side in sides if side is not None]


def _folded(signal: np.ndarray) -> Beyond | None:
    values = np.sort(signal)
    if values.size < 2 or not values[-1] > values[0]:
        return None
    gaps = np.diff(values)
    place = int(np.argmax(gaps))
    for sign in (1.0, -1.0):
        y, cut = sign * signal, sign * 0.5 * (values[place] + values[place + 1])
        away = y > cut
        runs, rest = runs_of(away), y[~away]
        inner = [(a, b) for a, b in runs if a > 0 and b < y.size]
        steps = np.abs(np.diff(y))[~(away[1:] ^ away[:-1])]
        usual = float(np.max(steps)) if steps.size else np.inf
        ends = [y[i] for a, b in inner for i in (a - 1, b)]
        if (
            len(inner) >= _VISITS
            and rest.size >= 4 * _SHORTEST
            and float(np.ptp(y[away])) <= max(_ONE * float(gaps[place]), 2.0 * _NOISE * noise_beside(rest))
            and float(np.min(y[away]) - np.min(rest)) > _LEAPS * usual
            and max(ends) <= float(np.min(rest)) + usual
        ):
            return Beyond(float(sign * np.min(rest)), tuple(runs), float(np.median(signal[away])))
    return None


def _limit(y: np.ndarray, sign: float, cycle: float) -> Beyond | None:
    top, reach = float(np.max(y)), float(np.ptp(y))
    width = max(_NOISE * noise_beside(y), converter_step(y), 1e-9 * reach)
    best: Beyond | None = None
    most = 0
    while width <= _WIDEST * reach:
        runs = [(a, b) for a, b in runs_of(y >= top - width) if b - a >= _SHORTEST]
        flat = [(a, b) for a, b in runs if b - a <= cycle and _is_flat(y, a, b, width, cycle)]
        held = sum(b - a for a, b in flat)
        if len(flat) >= _VISITS and 2 * len(flat) > len(runs) and held > 1.05 * most:
            every = tuple(runs_of(y >= top - width))
            best, most = Beyond(float(sign * (top - 0.5 * width)), every), held
        width *= 2.0
    return best


def _is_flat(y: np.ndarray, a: int, b: int, width: float, cycle: float) -> bool:
    """Whether a top from a to b, no higher than a width, is too flat for the slopes at which it is entered and left."""
    length = b - a
    side = max(2, length // 2)
    if a < side + 1 or b + side + 1 > y.size:
        return False
    near = max(2, min(side, int(cycle / 8)) // 2 * 2)  # of a motion from rest a parabola
    both = y[a - 1 - side : a][::-1], y[b : b + side + 1]  # on either side, from the top on
    at_once = all(top[0] - top[near // 2] > _AT_ONCE * (top[0] - top[near]) for top in both)
    slope = min(top[0] - top[-1] for top in both) / side
    return bool(at_once and slope * (length - 1) / 4.0 > _FLAT * width)
