"""The noise of a struck rig where it rests between blows: what white noise of the highest frequencies does not tell.

Noise of a colour is larger at the frequency of the motion than at the highest ones, from which noise is measured where
a rig always moves. Between blows nothing drives it, and what does not swing at one frequency is noise as it is there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..signals.limits import FEWEST_CYCLES
from ..signals.odds import HALF_AGAIN
from ..signals.registry import numerics
from .decay import Blow
from .first_motion import first_motion, motion_length

_CYCLES = numerics(3, "cycles", why="of a window in which a swing is a line beside noise")
_LINE = numerics(3, "lines", why="of a swing: its own and one on either side")


def quiet_noise(response: np.ndarray, blows: Sequence[Blow], dt: float, pace: float) -> tuple[float, float]:
    """Noise where a struck rig rests: its standard deviation, and that of white noise which would hide as much.

    The second counts for what is measured over the first part of a cycle (``first_motion``): noise that changes slowly
    does not average out there. Both are zero without blows, where the rig rests nowhere for three cycles, and where
    all that is seen of a rest is a constant: what rounding hides is known.

    Args:
        response: (n,) of one recording.
        blows: of it.
        dt: sample interval, s.
        pace: angular frequency at which the rig swings, rad/s.
    """
    period = round(2 * np.pi / pace / dt)
    window = _CYCLES * period
    if not blows or period < FEWEST_CYCLES:
        return 0.0, 0.0
    edges = [0, *(edge for blow in blows for edge in (blow.start, blow.stop)), response.size]
    rests, swings = [], np.inf
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        for start in range(begin, end - window + 1, period):
            part = response[start : start + window]
            if np.ptp(part) == 0:
                return 0.0, 0.0
            if 2 * _swing(part) <= 1:  # else most of it lies about one frequency
                rests.append(part)
            else:
                swings = min(swings, float(np.std(part)))
    quietest = min((float(np.std(part)) for part in rests), default=np.inf)
    if not quietest < 2 * swings:  # a swing is no quieter than the noise on it: there several modes ring
        return 0.0, 0.0
    quiet = [part - np.mean(part) for part in rests if np.std(part) <= HALF_AGAIN * quietest]
    step = motion_length(window, dt, pace)
    begun = [first_motion(part[k:], dt, pace) for part in quiet for k in range(0, window - step + 1, step)]
    slow = [motion / spread for motion, spread in begun]
    return float(np.std(quiet)), float(np.sqrt(np.mean(np.square(slow))))


def _swing(part: np.ndarray) -> float:
    """Largest share of a stretch, about its mean, that lies about one frequency: a preload makes small swings fast."""
    power = np.abs(np.fft.rfft(part - np.mean(part))[1:]) ** 2
    return float(np.max(np.convolve(power, np.ones(_LINE), "same")) / np.sum(power))
