"""Free decays by their fall alone, where no force was recorded: from where the motion is let go to its noise."""

from __future__ import annotations

import numpy as np

from ..signals.limits import CLEAR_OF_NOISE, FEWEST_CYCLES, SEVERAL
from .decay import Decay
from .envelope import Envelope
from .limits import FALLS
from .swings import Swings, caught, falls_steadily, release


def falling(x: np.ndarray, envelope: Envelope, swings: Swings, shortest: float = FEWEST_CYCLES) -> list[Decay]:
    """Decays of a motion (n,): from the highest envelope what falls from there, then the same left and right of it.

    Args:
        x: the motion.
        envelope, swings: its own.
        shortest: cycles that a decay has at least.
    """
    size, period = envelope.size, envelope.period
    decays: list[Decay] = []
    todo = [(0, x.size)]
    while todo:
        a, b = todo.pop()
        if b - a < shortest * period:
            continue
        top = a + int(np.argmax(size[a:b]))
        if size[top] < 2 * envelope.floor:
            continue
        decay = _one(x, envelope, swings, a, top, b, shortest)
        stop = top + period
        if decay is not None:
            decays.append(decay)
            stop = max(stop, decay.stop)
            top = min(top, decay.start)
        else:
            stop = max(stop, _end_of_fall(size, envelope.floor, top, b))
        todo += [(a, top), (stop, b)]
    return decays


def _one(x: np.ndarray, envelope: Envelope, swings: Swings, a: int, top: int, b: int, shortest: float) -> Decay | None:
    """The decay from the highest envelope between two samples, or None."""
    size, period = envelope.size, envelope.period
    stop = _end_of_fall(size, envelope.floor, top, b)
    corner = _corner(size, period, a, top, stop)
    start = corner
    if start is None:
        start = 0 if a == 0 and top <= 2 * period else top + period
    end = caught(swings, start, stop)
    stop = stop if end is None else end
    grown = float(np.max(size[stop : stop + SEVERAL * period], initial=0.0))
    freely = end is not None or FALLS * grown <= size[stop - 1]
    if freely:  # else it may be a drive that comes and goes
        freed = release(x, swings, start)
        if freed is not None and freed >= a:
            start = corner = freed
        elif corner == 0:
            start = _struck(x, envelope)
    if stop - start < shortest * period:
        return None
    if corner is not None and 2 * size[stop - 1] < size[start]:
        return Decay(start, stop)
    return Decay(start, stop) if freely and falls_steadily(swings, start, stop) else None


def _struck(x: np.ndarray, envelope: Envelope) -> int:
    """First sample at which a blow is over that struck in the record's first cycles, 0 where it moves from its start.

    A turning point dwells within the noise for less than a quarter of a cycle; a blow's contact lasts less than a half.
    """
    first = x[: 3 * envelope.period]
    moves = np.abs(first - first[0]) > CLEAR_OF_NOISE * envelope.noise
    strikes = int(np.argmax(moves)) if moves.any() else 0
    swing = envelope.period // 2
    return strikes + swing if 2 * strikes > swing else 0


def _end_of_fall(envelope: np.ndarray, end_level: float, top: int, b: int) -> int:
    """First sample at the noise, or the lowest one before the envelope rises again, or `b`."""
    part = envelope[top:b]
    low = np.flatnonzero(part < end_level)
    if low.size:
        part = part[: int(low[0])]
    rising = np.flatnonzero(FALLS * part > np.minimum.accumulate(part))
    return top + (int(np.argmin(part[: int(rising[0])])) if rising.size else part.size)


def _corner(envelope: np.ndarray, period: int, a: int, top: int, stop: int) -> int | None:
    """Where the fall from `top` to `stop` begins: before it the envelope falls at less than half its later rate."""
    fall = np.log(np.maximum(envelope[top:stop], 1e-300))
    well_down = np.flatnonzero(fall < fall[0] + np.log(FALLS))
    if not well_down.size:
        return None
    k = int(well_down[0])
    deep = np.flatnonzero(fall < fall[0] - 1)
    end = int(deep[0]) if deep.size else fall.size - 1
    if end <= k:
        return None
    rate = (fall[k] - fall[end]) / (end - k)
    ahead = np.minimum(np.arange(fall.size) + period, fall.size - 1)
    steep = fall - fall[ahead] >= rate * (ahead - np.arange(fall.size)) / 2
    slack = np.flatnonzero(~steep[: k + 1])
    corner = top + (int(slack[-1]) + 1 if slack.size else 0)
    if a == 0 and corner <= 2 * period:
        return 0  # the record begins with the decay: its first cycle has no cycle before it to compare with
    return corner + period
