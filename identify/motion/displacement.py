"""Displacement from a recorded velocity or acceleration by band-limited integration."""

from __future__ import annotations

import numpy as np

from ...recording.fact import fact
from ...recording.recording import QUANTITIES, Recording
from ..signals.registry import numerics
from ..signals.signals import Signal, drive_of, response_of
from .decays import find_free_motion

_TREND = numerics(
    5.0,
    "cycles a knot",
    why="slower is drift of the integration; a decay begins loud, where a dense spline takes the motion along",
)
_DRIVEN_TREND = numerics(3.5, "cycles a knot", why="a long driven record suffers more from the drift that is left")


@fact("response", "force", "fs", "quantity")
def displacement(recording: Recording) -> Signal:
    """Displacement of a recording, in its unit times s or s2; a displacement is returned as it is.

    Each integration is that of the cubic spline through the samples; what it adds that is slower than the motion (the
    unknown constant, the sensor's offset, integrated noise) is a least-squares spline with a knot every few cycles,
    and is taken off. Raises BadInput when the recording does not oscillate.
    """
    response, drive = response_of(recording), drive_of(recording)
    times = QUANTITIES.index(recording.quantity)
    if times == 0:
        return response
    x, slowest, cycles = response.samples, response.frequency, _TREND
    # what is struck rings at its own frequency, and has no slower motion, however low its blows reach
    if drive is not None and np.ptp(drive.samples) > 0 and not find_free_motion(recording).blows:
        slowest, cycles = min(slowest, drive.band[0]), _DRIVEN_TREND
    for _ in range(times):
        x = _integrate(x, recording.fs, slowest / cycles)
    return Signal(x, recording.fs)


def _integrate(v: np.ndarray, fs: float, drift: float) -> np.ndarray:
    from scipy.interpolate import CubicSpline, make_lsq_spline

    k = np.arange(v.size, dtype=float)
    x = CubicSpline(k, v - np.mean(v)).antiderivative()(k) / fs
    pieces = max(1, int(v.size * drift / fs))
    inner = np.linspace(0, v.size - 1, pieces + 1)[1:-1]
    knots = np.concatenate([[0.0] * 4, inner, [float(v.size - 1)] * 4])
    return x - make_lsq_spline(k, x, knots, k=3)(k)
