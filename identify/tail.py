"""What a decay still says once it has sunk into its noise: above all when friction ends it.

No sample shows it, but a fit sums over all of them. It is taken along only where nothing stopped the motion under cover
of the noise. How it goes on is known from how it fell before: viscous and dry friction,

    A' = -h A - c,    A = (A0 + c/h) exp(-h t) - c/h,

fitted to the last cycles that stand clear. Where the samples behind them hold less than that leaves, beyond chance,
something else has ended it; so they do where another law rules the fall and that misses it, and the decay ends as if
there were no tail. The tail ends where all that could be to come, were there no dry friction, is worth one standard
error of a single number: the sum of its squares over the noise's variance is one. That nothing moves there says that
there is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .decay import Decay, FreeMotion
from .envelope import ABOVE_FLOOR, Envelope, envelope_of
from .hilbert import blackman
from .odds import BY_CHANCE
from .signals import response_of

if TYPE_CHECKING:
    from ..recording.recording import Recording

#: Cycles before the end that show both frictions: over them either makes of an amplitude at the noise one clear of it.
_CYCLES = 12
#: Values that three numbers are fitted to.
_LEAST = 5
#: An envelope that lies higher by more than this factor, which noise over a cycle does not reach, is no longer that.
_HIGHER = 1.1


def with_tails(recording: Recording, motion: FreeMotion) -> tuple[Decay, ...]:
    """The decays of a recording, each that faded with its tail."""
    envelope = None if recording.free or motion.blows or not motion.decays else envelope_of(recording)
    if envelope is None:
        return motion.decays
    x, ends = response_of(recording).samples, [*(decay.start for decay in motion.decays[1:]), recording.n]
    return tuple(
        replace(decay, stop=max(decay.stop, _end(x, envelope, decay, min(end, decay.undriven or end))))
        for decay, end in zip(motion.decays, ends, strict=True)
    )


def _end(x: np.ndarray, envelope: Envelope, decay: Decay, last: int) -> int:
    """The sample at which the tail of a decay ends, at most `last`; that of the decay itself where it has none."""
    size, period, variance, stop = envelope.size, envelope.period, envelope.noise**2, decay.stop
    white = ABOVE_FLOOR * np.sqrt(2 * variance)
    if not variance > 0 or envelope.floor > _HIGHER * white or size[stop - 1] > _HIGHER * white:
        return stop  # it was stopped, or what covers it is no white noise
    at = np.arange(stop - 1, max(decay.start + period, stop - _CYCLES * period), -period)
    if at.size < _LEAST or last <= stop:
        return stop
    fall = _fall(at - stop, size[at] ** 2 - 2 * variance, variance, period)
    if fall is None:
        return stop
    theta, covariance = fall
    telling = _worth(theta, variance, last - stop)
    if not telling or _stopped(x[stop : stop + telling], theta, covariance, variance):
        return stop
    last = stop + _worth(theta * [1.0, 1.0, 0.0], variance, last - stop)
    grown = np.flatnonzero(size[stop:last] > _HIGHER * white)
    if grown.size:  # the envelope's kernel reaches a cycle ahead
        last = stop + int(grown[0]) - period
    return last


def _worth(theta: np.ndarray, variance: float, most: int) -> int:
    """So many samples, at most, until all that is to come of a fall is worth one."""
    to_come = 0.5 * np.cumsum(_swing(theta, np.arange(most))[::-1] ** 2)[::-1]
    return int(np.count_nonzero(to_come > variance))


def _swing(theta: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Amplitude at the samples t, 0 where friction has ended it, of (logarithm at 0, h, c over that amplitude)."""
    from scipy.special import exprel

    ended = np.exp(-theta[1] * t) - theta[2] * t * exprel(-theta[1] * t)
    return np.exp(theta[0]) * np.maximum(ended, 0.0)


def _fall(at: np.ndarray, squares: np.ndarray, variance: float, period: int) -> tuple[np.ndarray, np.ndarray] | None:
    """The fall (3,) that a squared envelope (m,) shows, and its covariance; None where it does not fall."""
    from scipy.optimize import least_squares

    kernel = np.maximum(blackman(2 * period)[0], 0)  # the envelope's own
    beside = at[:, None] + np.arange(kernel.size) - kernel.size // 2
    # of squares that hold motion and noise, the noise's share taken off
    errors = np.sqrt(4 * (variance**2 + variance * np.maximum(squares, 0.0)) * 2 * np.sum(kernel**2))

    def left(theta: np.ndarray) -> np.ndarray:
        return (_swing(theta, beside) ** 2 @ kernel - squares) / errors

    if not squares[-1] > squares[0] > 0:
        return None
    rate = 0.5 * np.log(squares[-1] / squares[0]) / float(at[0] - at[-1])
    begin = np.array([0.5 * np.log(squares[0]), 0.5 * rate, 0.5 * rate])
    # far beyond what may come out, and no number overflows
    low, high = [begin[0] - 3.0, 1e-3 * rate, 0.0], [begin[0] + 3.0, 10 * rate, 10 * rate]
    found = least_squares(left, begin, x_scale=[1.0, rate, rate], bounds=(low, high))
    wide = max(1.0, 2 * found.cost / (at.size - 3))
    return found.x, wide * np.linalg.pinv(found.jac.T @ found.jac)


def _stopped(tail: np.ndarray, theta: np.ndarray, covariance: np.ndarray, variance: float) -> bool:
    """Whether samples (n,) hold less than goes on falling as it did."""
    from scipy.special import ndtri

    t = np.arange(tail.size)

    def energy(theta: np.ndarray) -> float:
        return 0.5 * float(np.sum(_swing(theta, t) ** 2))

    expected, seen = energy(theta), float(np.sum((tail - np.mean(tail)) ** 2)) - tail.size * variance
    steps = 1e-3 * np.sqrt(np.diag(covariance))
    moves = zip(steps, np.diag(steps), strict=True)
    slope = np.array([(energy(theta + d) - energy(theta - d)) / (2 * s) if s > 0 else 0.0 for s, d in moves])
    spread = 2 * tail.size * variance**2 + 4 * variance * expected + slope @ covariance @ slope
    return bool(seen < expected + ndtri(BY_CHANCE) * np.sqrt(spread))
