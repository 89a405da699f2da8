"""Displacement from a recorded velocity or acceleration by band-limited integration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...recording.fact import fact
from ...recording.recording import QUANTITIES, Recording
from ..signals.registry import numerics
from ..signals.signals import Signal, drive_of, response_of
from .decays import find_free_motion

_TREND = numerics(
    2.5, "cycles a knot", why="slower is drift of the integration, or how the amplitude of a free motion goes"
)
_KNOTS = numerics(
    2, "knots", why="in a motion of fewer cycles drift and amplitude are one cubic each, and not told apart"
)
_COLOUR = numerics(
    (1.0, 1.3, 2.4),
    "times",
    why="noise integrated so often, in the slope by a Blackman kernel of three cycles, over white noise as dense there",
)
_DRIVEN_TREND = numerics(3.5, "cycles a knot", why="a long driven record suffers more from the drift that is left")

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@fact("response", "force", "fs", "quantity")
def displacement(recording: Recording) -> Signal:
    """Displacement of a recording, in its unit times s or s2; a displacement is returned as it is.

    Each integration is that of the cubic spline through the samples; what it adds that is slower than the motion (the
    unknown constant, the sensor's offset, integrated noise) is a least-squares spline with a knot every few cycles,
    and is taken off. Of free motion that spline is fitted together with the motion, cosine and sine of its frequency
    with amplitudes that are splines of time: a decay begins loud, and would bend the drift towards it.

    Raises:
        BadInput: the recording does not oscillate.
    """
    response, drive = response_of(recording), drive_of(recording)
    times = QUANTITIES.index(recording.quantity)
    if times == 0:
        return response
    x, slowest, cycles, swing = response.samples, response.frequency, _TREND, response.frequency
    # what is struck rings at its own frequency, and has no slower motion, however low its blows reach
    if drive is not None and np.ptp(drive.samples) > 0 and not find_free_motion(recording).blows:
        slowest, cycles, swing = min(slowest, drive.band[0]), _DRIVEN_TREND, None
    if swing is not None and response.n * swing / recording.fs < _KNOTS * _TREND:
        swing = None
    for _ in range(times):
        x = _integrate(x, recording.fs, slowest / cycles, swing)
    made = Signal(x, recording.fs)
    if swing is not None:
        # integrated noise is white no more: what counts is what it has around the motion's frequency
        made.__dict__["noise"] = _COLOUR[times] * response.noise / (2 * np.pi * swing) ** times
    return made


def _integrate(v: np.ndarray, fs: float, drift: float, swing: float | None) -> np.ndarray:
    """The integral (n,) of v (n,) less what is slower than ``drift``, Hz; ``swing``: frequency of a free motion, Hz."""
    from scipy.interpolate import CubicSpline
    from scipy.sparse import hstack
    from scipy.sparse.linalg import spsolve

    k = np.arange(v.size, dtype=float)
    x = CubicSpline(k, v - np.mean(v)).antiderivative()(k) / fs
    columns: Any = _splines(k, drift / fs)
    count = columns.shape[1]
    slow = columns
    if swing is not None:
        turn, sizes = 2 * np.pi * swing / fs * k, _splines(k, swing / _TREND / fs)
        columns = hstack([slow, sizes.multiply(np.cos(turn)[:, None]), sizes.multiply(np.sin(turn)[:, None])]).tocsc()
    found: np.ndarray = np.asarray(spsolve((columns.T @ columns).tocsc(), columns.T @ x))
    return x - slow @ found[:count]


def _splines(k: np.ndarray, rate: float) -> csr_array:
    """Cubic B-splines (n, columns) at samples k (n,) with so many knots a sample."""
    from scipy.interpolate import BSpline

    inner = np.linspace(0, k[-1], max(1, int(k.size * rate)) + 1)[1:-1]
    return BSpline.design_matrix(k, np.concatenate([[0.0] * 4, inner, [k[-1]] * 4]), 3)
