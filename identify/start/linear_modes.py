"""One mode more in all segments, from no start at all: where it takes most of what the known ones leave.

Each mode is a linear oscillator; its answer to the force, and in each segment its beginning, follow from linear least
squares at its frequency and damping (``linear_response``), which are tried all over a grid and then followed together
with those of the known modes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..problem.segments import Segment
from ..signals.registry import budget, numerics
from .further_modes import Mode
from .limits import MOST_DAMPING
from .linear_response import LinearResponse, Signal, followed, linear_response

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
    known = _followed(fewer, _logarithms(modes), low, high).theta
    first, fall = np.exp(known[:2])
    fall = max(fall, 1.0 / max(segment.n * segment.dt for segment in segments))
    costs, starts = [], []
    for factor in _FREQUENCIES:
        places = [np.append(known, np.log([first * factor, fall * factor * z])) for z in _DAMPING]
        tried = [(linear_response(fewer, start, drifts=True).cost, start) for start in np.clip(places, low, high)]
        cost, start = min(tried, key=lambda pair: pair[0])
        costs.append(cost)
        starts.append(start)
    around = np.pad(costs, 1, constant_values=np.inf)
    lowest = [i for i in np.argsort(costs) if costs[i] <= min(around[i], around[i + 2])][:_KEPT]
    return _fitted(segments, [_followed(fewer, starts[i], low, high).theta for i in lowest], modes)


def fitted_modes(segments: Sequence[Segment], modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """The modes, all fitted anew from where they are; that is the first which is nearest to the one before."""
    return _fitted(segments, [_logarithms(modes)], modes)


def _fitted(segments: Sequence[Segment], places: Sequence[np.ndarray], modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """From the best of the places: of fewer samples an alias leaves no more than what it is one of."""
    signals = [Signal(segment, by_means=True) for segment in segments]
    nearest = min(places, key=lambda theta: linear_response(signals, theta, drifts=True).cost)
    best = _followed(signals, nearest, *_bounds(segments))
    found = [(abs(p), -p.real / abs(p), gain) for p, gain in zip(best.poles.tolist(), best.gains.tolist(), strict=True)]
    # a model has a mass above zero; where the sensor shows a mode against the force, that mode is a further one
    first = min(found, key=lambda mode: (mode[2] < 0.0, abs(np.log(mode[0] / modes[0][0]))))
    return (first, *(mode for mode in found if mode is not first))


def _followed(signals: Sequence[Signal], theta: np.ndarray, low: float, high: float) -> LinearResponse:
    return followed(signals, np.clip(theta, low, high), (low - 1e-9, high + 1e-9), _STEPS, drifts=True)


def _bounds(segments: Sequence[Segment]) -> tuple[float, float]:
    """Of the logarithms of frequencies and rates."""
    longest = max(segment.n * segment.dt for segment in segments)
    return float(np.log(1e-4 / longest)), float(np.log(np.pi / max(segment.dt for segment in segments)))


def _logarithms(modes: Sequence[Mode]) -> np.ndarray:
    return np.log([part for mode in modes for part in _pole(mode)])


def left_by(segments: Sequence[Segment], modes: Sequence[Mode]) -> np.ndarray:
    """(segments,) mean squares that modes of such frequencies and dampings leave of a response, in its unit squared."""
    signals = [Signal(segment, by_means=True) for segment in segments]
    rests = linear_response(signals, _logarithms(modes), drifts=True).rests if modes else None
    each = rests or [signal.measured for signal in signals]
    least = np.finfo(float).tiny
    return np.array([max(float(r @ r) * s.scale**2, least) for r, s in zip(each, signals, strict=True)])


def _pole(mode: Mode) -> tuple[float, float]:
    """Frequency of the ringing and rate of its fall, rad/s and 1/s."""
    omega, zeta, _ = mode
    zeta = float(np.clip(zeta, _LEAST_DAMPING, MOST_DAMPING))
    return omega * np.sqrt(1 - zeta**2), omega * zeta
