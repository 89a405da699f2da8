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
from .linear_fit import Signal, sizes_of

_SAMPLES_A_CYCLE = numerics(8.0, "samples a cycle", why="by which places are only compared")
_FREQUENCIES = numerics(
    np.concatenate([np.geomspace(0.25, 0.9, 12), np.geomspace(0.92, 1.09, 9), np.geomspace(1.12, 5.0, 13)]),
    "times that of the first mode",
    why="a grid, finer where modes beat",
)
_DAMPING = numerics((0.5, 1.0, 2.0), "times that of the first mode", why="a grid: modes of one rig are damped alike")
_LEAST_DAMPING = numerics(1e-6, "damping ratio", why="of a search, which goes by logarithms")
_KEPT = budget(3, "places", why="of the grid that are followed to their own best")
_STEPS = budget(20, "steps", why="the search of the simulation begins where this one ends")


def one_mode_more(segments: Sequence[Segment], modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """The modes with one more, all fitted anew; that is the first which is nearest to the one before."""
    fewer, (low, high) = [Signal(segment, _SAMPLES_A_CYCLE, by_means=True) for segment in segments], _bounds(segments)
    known = _followed(fewer, _logarithms(modes), low, high)[1]
    first, fall = np.exp(known[:2])
    fall = max(fall, 1.0 / max(segment.n * segment.dt for segment in segments))
    costs, starts = [], []
    for factor in _FREQUENCIES:
        places = [np.append(known, np.log([first * factor, fall * factor * z])) for z in _DAMPING]
        tried = [(_cost(fewer, start), start) for start in np.clip(places, low, high)]
        cost, start = min(tried, key=lambda pair: pair[0])
        costs.append(cost)
        starts.append(start)
    around = np.pad(costs, 1, constant_values=np.inf)
    lowest = [i for i in np.argsort(costs) if costs[i] <= min(around[i], around[i + 2])][:_KEPT]
    best = min((_followed(fewer, starts[i], low, high) for i in lowest), key=lambda pair: pair[0])[1]
    return _fitted(segments, best, modes)


def fitted_modes(segments: Sequence[Segment], modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """The modes, all fitted anew from where they are; that is the first which is nearest to the one before."""
    return _fitted(segments, _logarithms(modes), modes)


def _fitted(segments: Sequence[Segment], theta: np.ndarray, modes: Sequence[Mode]) -> tuple[Mode, ...]:
    signals = [Signal(segment, by_means=True) for segment in segments]
    best = _followed(signals, theta, *_bounds(segments))[1]
    found = [
        (float(np.hypot(w, r)), float(r / np.hypot(w, r)), float(gain))
        for (w, r), gain in zip(np.exp(best).reshape(-1, 2), _solve(signals, best)[0], strict=True)
    ]
    # a model has a mass above zero; where the sensor shows a mode against the force, that mode is a further one
    first = min(found, key=lambda mode: (mode[2] < 0.0, abs(np.log(mode[0] / modes[0][0]))))
    return (first, *(mode for mode in found if mode is not first))


def _followed(signals: Sequence[Signal], theta: np.ndarray, low: float, high: float) -> tuple[float, np.ndarray]:
    """The sum of squares, and where it is least near logarithms of frequencies and rates (2 K,)."""
    from scipy.optimize import least_squares

    def remainder(theta: np.ndarray) -> np.ndarray:
        return np.concatenate(_solve(signals, theta)[1])

    inside = np.clip(theta, low, high)
    outcome = least_squares(remainder, inside, bounds=(low - 1e-9, high + 1e-9), max_nfev=_STEPS)
    return float(outcome.cost), outcome.x


def _cost(signals: Sequence[Signal], theta: np.ndarray) -> float:
    return sum(float(rest @ rest) for rest in _solve(signals, theta)[1])


def _bounds(segments: Sequence[Segment]) -> tuple[float, float]:
    """Of the logarithms of frequencies and rates."""
    longest = max(segment.n * segment.dt for segment in segments)
    return float(np.log(1e-4 / longest)), float(np.log(np.pi / max(segment.dt for segment in segments)))


def _logarithms(modes: Sequence[Mode]) -> np.ndarray:
    return np.log([part for mode in modes for part in _pole(mode)])


def left_by(segments: Sequence[Segment], modes: Sequence[Mode]) -> np.ndarray:
    """(segments,) mean squares that modes of such frequencies and dampings leave of a response, in its unit squared."""
    signals = [Signal(segment, by_means=True) for segment in segments]
    rests = _solve(signals, _logarithms(modes))[1] if modes else None
    each = rests or [signal.measured for signal in signals]
    least = np.finfo(float).tiny
    return np.array([max(float(r @ r) * s.scale**2, least) for r, s in zip(each, signals, strict=True)])


def _pole(mode: Mode) -> tuple[float, float]:
    """Frequency of the ringing and rate of its fall, rad/s and 1/s."""
    omega, zeta, _ = mode
    zeta = float(np.clip(zeta, _LEAST_DAMPING, MOST_DAMPING))
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
        basis = np.linalg.qr(columns / sizes_of(columns))[0]
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
