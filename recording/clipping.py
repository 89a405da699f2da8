"""Whether a signal was cut off at the end of its measuring range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .resolution import converter_step, rounding_noise

SHORTEST = 3  # samples: two equal samples astride a smooth peak are common
VISITS = 2  # one flat top may be the signal's own
MARGIN = 16.0  # a smooth peak falls at most 8 steps of resolution within one run length; twice that
MOST = 0.6  # of the samples: a signal that is mostly at its extremes switches between levels
CREEPS, JUMPS = 0.05, 0.75  # of the rise before the flat top, in its last quarter: a third of 5/32; three quarters
SENSOR_NOISE = 1e-5  # of the peak: no sensor is quieter, so below it the signal was computed or commanded


@dataclass(frozen=True)
class Clipping:
    """The level at which a signal is cut, how often, how many samples of it, and where the first and the last one is.

    ``hidden`` is the sum of squares of what lies beyond the rail, by parabolas through the flanks of each flat top.
    """

    level: float
    visits: int
    samples: int
    first: int
    last: int
    hidden: float = 0.0


def clipping(signal: np.ndarray) -> list[Clipping]:
    """Return the rails at which the signal (n,) is clipped: none, one or two.

    A digitised smooth peak that stays on one level for L samples hides at most one step q, so by its parabola it has
    fallen by no more than 8 q another L samples away on either side. A clipped one has fallen by much more. Counted are
    runs at the very extreme only, so neither coarse resolution nor rest nor friction's dwell at varied levels counts.
    """
    step = _resolution(signal)
    rails: list[Clipping] = []
    for sign in (1.0, -1.0):
        starts, lengths = _runs_at_maximum(sign * signal)
        if lengths.sum() > MOST * len(signal):
            continue
        cut = [(i, n) for i, n in zip(starts, lengths, strict=True) if _is_cut(sign * signal, int(i), int(n), step)]
        if cut:
            samples = int(sum(n for _, n in cut))
            hidden = sum(_beyond(sign * signal, int(i), int(n)) for i, n in cut)
            first, *_, last = np.flatnonzero(_at_maximum(sign * signal))
            rails.append(Clipping(float(signal[first]), len(cut), samples, int(first), int(last), hidden))
    both = sum(rail.visits for rail in rails) >= VISITS
    at_rails = sum(rail.samples for rail in rails) <= MOST * len(signal)
    return rails if both and at_rails else []


def measured(signal: np.ndarray) -> bool:
    """Whether the signal (n,) carries sensor noise, so that it was measured and not computed.

    Differencing shrinks a smooth, well sampled signal each time and makes noise grow: the fifth differences of noise
    exceed the fourth by sqrt(252/70).
    """
    peak = float(np.max(np.abs(signal)))
    fourth, fifth = (float(np.median(np.abs(np.diff(signal, k)))) for k in (4, 5))
    return fifth > fourth and fourth / np.sqrt(70) > SENSOR_NOISE * peak


def noise_of(signal: np.ndarray) -> float:
    """Standard deviation of the white noise on a signal (n,), its converter's steps among it.

    From its fourth differences, which leave little of a well sampled motion and multiply noise by sqrt(70).
    """
    return max(float(np.std(np.diff(signal, 4))) / np.sqrt(70), rounding_noise(signal))


def _resolution(signal: np.ndarray) -> float:
    """Return the step of the digitiser, or the small gaps between the values that occur (their 5th percentile)."""
    if step := converter_step(signal):
        return step
    values = np.unique(signal)
    gaps = np.diff(values)
    gaps = gaps[gaps > 1e-9 * (values[-1] - values[0])]  # the same level, printed or converted differently
    return float(np.percentile(gaps, 5)) if len(gaps) else 0.0


def _at_maximum(signal: np.ndarray) -> np.ndarray:
    return signal >= signal.max() - 1e-9 * np.ptp(signal)


def _runs_at_maximum(signal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], _at_maximum(signal).astype(np.int8), [0]))))
    starts, lengths = edges[::2], edges[1::2] - edges[::2]
    long = lengths >= SHORTEST
    return starts[long], lengths[long]


def _is_cut(signal: np.ndarray, start: int, length: int, step: float) -> bool:
    before, after = start - length, start + 2 * length - 1
    if before < 0 or after >= len(signal):
        return False
    drop = signal[start] - max(signal[before], signal[after])
    rises = _bends_at_once(signal[before : start + 1])
    return bool(drop > MARGIN * step and (rises or _bends_at_once(signal[after : start + length - 2 : -1])))


def _beyond(signal: np.ndarray, start: int, length: int) -> float:
    """Sum of squares of what a parabola through both flanks, each half as long as the flat top, makes beyond the rail.

    Further down the flanks of a sine that was cut deeply bend the other way.
    """
    side = max(SHORTEST, length // 2)
    place = np.arange(start - side, start + length + side)
    flank = (place < start) | (place >= start + length)
    u = (place - np.mean(place)) / length
    peak = np.polyval(np.polyfit(u[flank], signal[place[flank]], 2), u[~flank])
    return float(np.sum(np.maximum(peak - signal[start], 0.0) ** 2))


def _bends_at_once(way: np.ndarray) -> bool:
    """Whether a signal is on its way when it meets the rail, which it does with the last of these samples.

    Over as long as it then stays on the rail, a parabola cut below its peak makes 5/32 of its rise in the last quarter,
    a straight line a quarter. A command that jumps makes all of it there; one that creeps up to its level nothing.
    """
    rise, quarter = way[-1] - way[0], (len(way) - 1) // 4
    # the sample before the rail may lie just below it, so one interval says nothing about creeping
    jump, creep = way[-1] - way[-1 - max(1, quarter)], way[-1] - way[-1 - max(2, quarter)]
    in_one = float(np.max(np.diff(way[-1 - quarter :]))) if quarter >= SHORTEST else 0.0  # from another level
    return bool(jump < JUMPS * rise and in_one < JUMPS * jump and creep > CREEPS * rise)
