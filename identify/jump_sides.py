"""Which side of a jump a sample shows: an acceleration's where friction turns, where a preload or a contact changes.

On which side the sample before a jump and the one after it were taken is known no better than the instant of the jump,
and that a hair of any parameter moves. Taken as simulated, the likelihood would have steps of many units, and a law
could buy such samples, one by one, with changes of the motion that nobody sees. So each is taken on the side to which
the measured value is nearer. That leaves a smooth likelihood; of what the sample tells, the size of the jump stays.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def nearer_sides(
    measured: np.ndarray, response: np.ndarray, signs: np.ndarray, under: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """(n,) response with the samples beside its jumps on the nearer side, and (n, surfaces + 1) signs that it has then.

    Args:
        measured: (n,).
        response: (n,) as simulated.
        signs: (n, surfaces + 1) of that simulation; see ``simulate.core.Core.record``.
        under: gives the response (n,) of the same motion under other signs.
    """
    before = np.flatnonzero(np.any(signs[1:] != signs[:-1], axis=1))
    if not before.size:
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
            nearer = np.abs(measured - other) < np.abs(measured - response)
            response, taken = np.where(nearer, other, response), np.where(nearer[:, None], across, taken)
    return response, taken
