"""Which side of a jump a sample shows: an acceleration's where friction turns, where a preload or a contact changes.

On which side the sample before a jump and the one after it were taken is known no better than the instant of the jump,
and that a hair of any parameter moves. Taken as simulated, the likelihood would have steps of many units, and a law
could buy such samples, one by one, with changes of the motion that nobody sees. So one that is decisively off is taken
on the other side where it is nearer to that. What is left are steps below decisive odds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..signals.odds import BEYOND_ERRORS
from .segments import Segment

#: Standard deviation of normal noise over its median size.
_OF_MEDIAN = 1.4826


def nearer_sides(
    segment: Segment, response: np.ndarray, signs: np.ndarray, under: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """(n,) response with the samples beside its jumps on the nearer side, and (n, surfaces + 1) signs that it has then.

    Args:
        segment: what was measured, and its noise.
        response: (n,) as simulated.
        signs: (n, surfaces + 1) of that simulation; see ``simulate.core.Core.record``.
        under: gives the response (n,) of the same motion under other signs; asked where a sample beside a jump is so
            far off that it is decisively likelier to be on the other side of one.
    """
    measured = segment.response
    before = np.flatnonzero(np.any(signs[1:] != signs[:-1], axis=1))
    # the jumps themselves are in the highest frequencies too, from which the noise is measured
    left = np.abs(measured - response)
    noise = min(segment.noise, _OF_MEDIAN * float(np.median(left)))
    # nearer, noise alone is as likely a cause, and a choice that follows it would bend the size of the jump
    off = left > BEYOND_ERRORS * noise
    if not np.any(off[before] | off[before + 1]):
        return response, signs
    surfaces: list[slice] = [slice(None)]
    if np.any(np.diff(before) == 1):  # several surfaces change about one sample, and it may be on either side of each
        surfaces += [slice(k, k + 1) for k in range(signs.shape[1])]
    taken = signs.copy()
    for there, beside in ((before, before + 1), (before + 1, before)):
        for changed in surfaces:
            across = signs.copy()
            across[there, changed] = signs[beside, changed]
            other = under(across)
            nearer = off & (np.abs(measured - other) < np.abs(measured - response))
            response, taken = np.where(nearer, other, response), np.where(nearer[:, None], across, taken)
    return response, taken
