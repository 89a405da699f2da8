"""One mode more in all segments, from no start at all: where it takes most of what the known ones leave.

Each mode is a linear oscillator; its answer to the force, and in each segment its beginning, follow from linear least
squares at its frequency and damping (``linear_fit``; Golub and Pereyra 1973), which are tried all over a grid and then
followed together with those of the known modes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..problem.segments import Segment
from ..signals.registry import budget, numerics
from .further_modes import Mode
from .limits import MOST_DAMPING
from .linear_fit import Signal

_SAMPLES_A_CYCLE = numerics(8.0, "samples a cycle", why="by which places are only compared")
_FREQUENCIES = numerics(
    np.concatenate([np.geomspace(0.25, 0.9, 12), np.geomspace(0.92, 1.09, 9), np.geomspace(1.12, 5.0, 13)]),
    "times that of the first mode",
    why="a grid, finer where modes beat",
)
_DAMPING = numerics((0.5, 1.0, 2.0), "times that of the first mode", why="a grid: modes of one rig are damped alike")
_KEPT = budget(3, "places", why="of the grid that are followed to their own best")
_STEPS = budget(20, "steps", why="the search of the simulation begins where this one ends")


def one_mode_more(segments: Sequence[Segment], modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """The modes with one more, all fitted anew; that is the first which is nearest to the one before."""
    from scipy.optimize import least_squares

    signals = [Signal(segment, by_means=True) for segment in segments]
    fewer = [Signal(segment, _SAMPLES_A_CYCLE, by_means=True) for segment in segments]
    longest = max(segment.n * segment.dt for segment in segments)
    low, high = np.log(1e-4 / longest), np.log(np.pi / max(segment.dt for segment in segments))

    def remainder(theta: np.ndarray, signals: Sequence[Signal]) -> np.ndarray:
        return np.concatenate(_solve(signals, theta)[1])

    known = np.log([part for mode in modes for part in _pole(mode)])
    omega, zeta, _ = modes[0]
    zeta = max(zeta, 1.0 / (omega * longest))
    places = [_pole((omega * f, min(zeta * z, MOST_DAMPING), 0.0)) for f in _FREQUENCIES for z in _DAMPING]
    starts = [np.clip(np.append(known, np.log(place)), low, high) for place in places]
    costs = [float(np.sum(remainder(theta, fewer) ** 2)) for theta in starts]
    outcomes = [
        least_squares(remainder, starts[i], bounds=(low - 1e-9, high + 1e-9), max_nfev=_STEPS, args=(fewer,))
        for i in np.argsort(costs)[:_KEPT]
    ]
    best = min(outcomes, key=lambda outcome: outcome.cost).x
    best = least_squares(remainder, best, bounds=(low - 1e-9, high + 1e-9), max_nfev=_STEPS, args=(signals,)).x
    gains = _solve(signals, best)[0]
    found = [
        (float(np.hypot(w, r)), float(r / np.hypot(w, r)), float(gain))
        for (w, r), gain in zip(np.exp(best).reshape(-1, 2), gains, strict=True)
    ]
    first = min(found, key=lambda mode: abs(np.log(mode[0] / omega)))
    return (first, *(mode for mode in found if mode is not first))


def _pole(mode: Mode) -> tuple[float, float]:
    """Frequency of the ringing and rate of its fall, rad/s and 1/s."""
    omega, zeta, _ = mode
    zeta = float(np.clip(zeta, 1e-6, MOST_DAMPING))
    return omega * np.sqrt(1 - zeta**2), omega * zeta


def _solve(signals: Sequence[Signal], theta: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """(K,) answers to the force, and what is left of each signal, at logarithms of frequencies and rates (2 K,)."""
    poles = [(float(w), float(r)) for w, r in np.exp(theta).reshape(-1, 2)]
    normal, right = np.zeros((len(poles), len(poles))), np.zeros(len(poles))
    parts = []
    for signal in signals:
        free = [signal.free(*pole) for pole in poles]
        drift = np.linspace(-1.0, 1.0, signal.measured.size)  # of a sensor, which else is taken for a slow mode
        columns = np.column_stack([*(own[:, :2] for own in free), free[0][:, 2], drift])
        basis = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0]
        rest = signal.measured - basis @ (basis.T @ signal.measured)
        forced = np.zeros((rest.size, 0))
        if signal.force is not None:
            forced = np.column_stack([signal.driven(*pole) for pole in poles])
            forced = forced - basis @ (basis.T @ forced)
            normal, right = normal + forced.T @ forced, right + forced.T @ rest
        parts.append((rest, forced))
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    gains = np.linalg.lstsq(normal / np.outer(size, size), right / size, rcond=1e-12)[0] / size
    return gains, [rest - forced @ gains if forced.shape[1] else rest for rest, forced in parts]
