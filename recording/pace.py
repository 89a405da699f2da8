"""How long a cycle of a motion takes, from its own swings: also where it was pulled aside and let go many times.

The strongest line of such a recording's spectrum is how often that was done. Its swings, paired into cycles as fatigue
counts them, are those of the motion: a small cycle is taken out of the larger one in which it lies, so that of two
modes the larger gives the cycle, and not the faster.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .fact import fact
from .oscillation import SMALLEST, oscillation_of
from .recording import Recording

#: Noise alone turns a signal by less than so many times its rms.
_TURNS = 8.0
_MIDDLE = 0.25  # of a swing's range, to each side of its middle: a sine is there for a sixth of its cycle
_OF_A_CYCLE = 6.0


@fact("response", "fs")
def cycle_of(recording: Recording) -> float:
    """Duration in s of a cycle of the response: the median of that of its swings, weighed by their ranges squared.

    Each is measured where it is fastest, in the middle half of its range, so that a hand that holds the thing aside
    before it lets go counts for nothing. That of the strongest line of a velocity or an acceleration, in which what a
    hand does slowly is weak and a blow is a large swing of its own, and where nothing swings.
    """
    response, moving = np.asarray(recording.response, float), oscillation_of(recording)
    if recording.quantity != "displacement":
        return 1.0 / moving.frequency
    swings = _swings(response, max(_TURNS * moving.noise, SMALLEST * float(np.ptp(response))))
    if not swings:
        return 1.0 / moving.frequency
    lasts = np.array([_OF_A_CYCLE * _across(response[a : b + 1], far) for a, b, far in swings])
    order = np.argsort(lasts)
    weights = np.cumsum([(response[swings[i][0]] - swings[i][2]) ** 2 for i in order])
    return float(lasts[order][np.searchsorted(weights, 0.5 * weights[-1])]) / recording.fs


def _swings(signal: np.ndarray, least: float) -> list[tuple[int, int, float]]:
    """Both swings of each cycle of a signal (n,) above that range: from where, to where at most, to which value.

    Rainflow counting (ASTM E1049-85, 5.4.4): of three ranges that follow one another the middle one is a cycle where
    it is no larger than its neighbours; what is left at the end are single swings.
    """
    slope = np.sign(np.diff(signal))
    moves = np.flatnonzero(slope)
    turns = [0, *moves[1:][slope[moves[1:]] != slope[moves[:-1]]].tolist(), signal.size - 1]
    values = signal[turns].tolist()
    found: list[tuple[int, int, float]] = []
    kept: list[int] = []
    for place in range(len(turns)):
        kept.append(place)
        while len(kept) > 3:
            a, b, c, d = (values[one] for one in kept[-4:])
            if abs(b - c) > min(abs(a - b), abs(c - d)):
                break
            if abs(b - c) > least:
                there, back, after = (turns[one] for one in kept[-3:])
                found += [(there, back, c), (back, after, b)]
            del kept[-3:-1]
    return found + [(turns[i], turns[j], values[j]) for i, j in pairwise(kept) if abs(values[i] - values[j]) > least]


def _across(swing: np.ndarray, far: float) -> float:
    """How many samples a signal (n,) takes across the middle half of its way from its first value to a far one."""
    gone = (swing - swing[0]) / (far - swing[0])
    over = int(np.argmax(gone >= 0.5 + _MIDDLE)) - 1
    near = over - int(np.argmax(gone[over::-1] <= 0.5 - _MIDDLE))
    return _when(gone, over, 0.5 + _MIDDLE) - _when(gone, near, 0.5 - _MIDDLE)


def _when(gone: np.ndarray, before: int, level: float) -> float:
    """When a level is passed between a sample and the next, in samples."""
    return before + (level - float(gone[before])) / float(gone[before + 1] - gone[before])
