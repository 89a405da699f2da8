"""Which side of a jump a sample shows: an acceleration's where friction turns, where a preload or a contact changes.

On which side the sample before a jump and the one after it were taken is known no better than the instant of the jump,
which the smallest change of any parameter moves. Taken as simulated, the likelihood would have steps of many units, and
a law could buy such samples, one by one, with changes of the motion that nobody sees. So a sample is taken on the other
side where that is decisively likelier. What is left are steps below decisive odds.

Where samples are few to a cycle all are beside jumps, and the noise that they are held against is an estimate from few
itself: beyond so many of its deviations lies more than of known ones (Student 1908), or each sample chooses its side by
its own noise, and what is left tells of less than there is.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...simulate.sides import Sides
from ..signals.noise_beside_edges import OF_MEDIAN
from ..signals.odds import BEYOND_ERRORS
from ..signals.registry import numerics
from .segments import Segment

_EFFICIENCY = numerics(0.37, "of the samples", why="whose deviation is known as well as the median tells that of all")


@lru_cache(maxsize=1024)
def _beyond(n: int) -> float:
    """So many deviations, by the median of n sizes, are as rare as ``BEYOND_ERRORS`` of known ones."""
    from scipy.special import ndtr, stdtrit

    return float(stdtrit(max(_EFFICIENCY * n, 1.0), ndtr(BEYOND_ERRORS)))


def nearer_sides(segment: Segment, response: np.ndarray, sides: Sides) -> np.ndarray:
    """Which of the other sides, as places in ``sides``, samples are taken on.

    Args:
        segment: what was measured, and its noise.
        response: (n,) as simulated, perhaps of its first samples only.
        sides: what samples beside its jumps are on their other sides.
    """
    if not sides.at.size:
        return sides.at
    left = np.abs(segment.response[: response.size] - response)
    # the jumps themselves are in the highest frequencies too, from which the noise is measured, if there are enough
    by_median = OF_MEDIAN * float(np.median(left))
    noise = min(segment.noise or by_median, by_median)
    # nearer, noise alone is as likely a cause, and a choice that follows it would bend the size of the jump
    apart = np.abs(segment.response[sides.at] - sides.shown)
    with np.errstate(over="ignore", invalid="ignore"):  # a motion that runs away
        nearer = np.flatnonzero(left[sides.at] ** 2 - apart**2 > (_beyond(left.size) * noise) ** 2)
    nearer = nearer[np.lexsort((apart[nearer], sides.at[nearer]))]
    return nearer[np.append(True, np.diff(sides.at[nearer]) > 0)] if nearer.size else nearer


def put_on_same_sides(response: np.ndarray, sides: Sides, moved: np.ndarray, moved_sides: Sides) -> None:
    """Put the samples of a neighbouring run, (n,), on those sides of their jumps on which a response (n,) shows them.

    Where a jump has passed a sample the way across it has turned round.
    """
    steps, own = moved_sides.shown - moved[moved_sides.at], sides.shown - response[sides.at]
    for at in np.intersect1d(moved_sides.at, sides.at):
        here = np.flatnonzero(moved_sides.at == at)
        ways = own[sides.at == at]
        turned, kept = (np.min(np.abs(steps[here, None] + sign * ways), axis=1) for sign in (1.0, -1.0))
        if np.min(turned) < np.min(kept):
            moved[at] = moved_sides.shown[here[int(np.argmin(turned))]]
