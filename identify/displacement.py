"""Displacement from a recorded velocity or acceleration by band-limited integration."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .hilbert import dominant_frequency
from .regression import excited_band

if TYPE_CHECKING:
    from ..recording.recording import Recording

TREND_CYCLES = 5.0  # what is slower than this many cycles of the slowest motion is drift of the integration


def displacement(recording: Recording) -> np.ndarray:
    """Displacement (n,) of a recording, in its unit times s or s2; a displacement is returned as it is.

    Each integration is that of the cubic spline through the samples; what it adds that is slower than the motion (the
    unknown constant, the sensor's offset, integrated noise) is a least-squares spline with a knot every five cycles,
    and is taken off. Raises BadInput when the recording does not oscillate.
    """
    x = np.asarray(recording.response, float)
    times = {"displacement": 0, "velocity": 1, "acceleration": 2}[recording.quantity]
    if times == 0:
        return x
    slowest = dominant_frequency(x, recording.fs)
    if recording.force is not None and np.ptp(recording.force) > 0:
        slowest = min(slowest, max(excited_band(recording.force, recording.fs)[0], 1.5 * recording.fs / x.size))
    for _ in range(times):
        x = _integrate(x, recording.fs, slowest)
    return x


def _integrate(v: np.ndarray, fs: float, slowest: float) -> np.ndarray:
    from scipy.interpolate import CubicSpline, make_lsq_spline

    k = np.arange(v.size, dtype=float)
    x = CubicSpline(k, v - np.mean(v)).antiderivative()(k) / fs
    pieces = max(1, int(v.size * slowest / fs / TREND_CYCLES))
    inner = np.linspace(0, v.size - 1, pieces + 1)[1:-1]
    knots = np.concatenate([[0.0] * 4, inner, [float(v.size - 1)] * 4])
    return x - make_lsq_spline(k, x, knots, k=3)(k)
