"""The half kernel at each end of a stretch, which leans on the continuation, extrapolated from what does not.

The laws meet the motion under the same kernel as the motion itself (``Stretch.passed``): the first value that the
recording alone decides needs the amplitude right up to the end. There logarithm of the amplitude and phase go on as a
polynomial, whose first two derivatives are growth and frequency; the motion is smooth where nothing strikes it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..signals.hilbert import AnalyticSignal

_DEGREE = 3
_KERNELS = 1.0  # so many kernels behind the end are asked


def with_ends(signal: AnalyticSignal, fs: float) -> AnalyticSignal:
    """A signal whose ends, half a kernel each, are extrapolated; a stretch too short for that stays as it is."""
    edge, asked = signal.kernel // 2, int(_KERNELS * signal.kernel)
    n = signal.time.size
    if n < 2 * (edge + asked):
        return signal
    log = np.log(np.abs(signal.slow)) + 1j * signal.phase  # of the un-decayed motion
    fields = {
        name: getattr(signal, name).copy()
        for name in ("amplitude", "phase", "omega", "growth", "curvature", "chirp", "slow", "equation_first")
    }
    for ends, inner in (
        (slice(0, edge), slice(edge, edge + asked)),
        (slice(n - edge, n), slice(n - edge - asked, n - edge)),
    ):
        centre = signal.time[inner].mean()
        scale = asked / fs
        at, known = (signal.time[ends] - centre) / scale, (signal.time[inner] - centre) / scale
        q = np.polynomial.polynomial.polyfit(known, np.column_stack([log[inner].real, log[inner].imag]), _DEGREE)
        value, slope, bend = (
            np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyder(q, m) if m else q) / scale**m
            for m in range(3)
        )
        growth = slope[0] - signal.undecay
        fields["amplitude"][ends] = np.exp(value[0] - signal.undecay * signal.time[ends])
        fields["phase"][ends] = value[1]
        fields["omega"][ends] = slope[1]
        fields["growth"][ends] = growth
        fields["curvature"][ends] = bend[0] + growth**2
        fields["chirp"][ends] = bend[1]
        fields["slow"][ends] = np.exp(value[0] + 1j * (value[1] - signal.carrier[ends]))
        fields["equation_first"][ends] = growth + 1j * slope[1]
    return replace(signal, **fields)
