"""Whether what a model leaves over rings with the rig.

A force that the model lacks reaches the response through the rig's resonance, also where it keeps no step with the
motion: a rig that changes while it is recorded, a shove at the bench. Noise of sensors and recorders rises or falls
over the octaves, as a power of the frequency or beyond a filter's corner, and has no hump there.
"""

from __future__ import annotations

import math

import numpy as np

from ...identify.signals.odds import BEYOND_ERRORS

#: Half an octave: a band reaches as far on either side of its middle.
_HALF = math.sqrt(2.0)


def resonant_share(residual: np.ndarray, turn: float) -> float:
    """Share of a residual's power that the octave around the rig's frequency has above both octaves beside it.

    Zero where noise would have as much by chance (a line of a periodogram is a chi-square of two degrees of freedom),
    or where one of the three octaves has no lines.

    Args:
        residual: (n,) what is left over.
        turn: of the motion, in radians a sample.
    """
    n = residual.size
    power = np.abs(np.fft.rfft(residual - np.mean(residual))) ** 2
    angle = 2.0 * np.pi * np.arange(power.size) / n
    below, here, above = (
        power[(angle >= middle / _HALF) & (angle < middle * _HALF) & (angle < np.pi)]
        for middle in (0.5 * turn, turn, 2.0 * turn)
    )
    if not (below.size and above.size and np.any(power)):
        return 0.0
    hump = float(np.mean(here))
    for beside in (below, above):
        by_chance = math.exp(BEYOND_ERRORS * math.sqrt(1.0 / here.size + 1.0 / beside.size))
        if hump <= by_chance * float(np.mean(beside)):
            return 0.0
    return (hump - max(float(np.mean(below)), float(np.mean(above)))) * here.size / float(np.sum(power))
