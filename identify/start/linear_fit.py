"""A linear rig fitted to all segments from no start at all: the least that any answer has to reach.

Mass, offsets and initial states follow at each frequency and damping (``linear_response``), so that these two can be
tried all over the recordings' spectrum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..problem.segments import Segment
from ..signals.registry import budget, numerics
from .linear_response import Signal, followed, linear_response

_EDGE = numerics(1e-9, "natural logarithm", why="within the bounds, where a search may begin")

_COMPARED = numerics(8.0, "samples a cycle", why="by which many are only compared")
_DAMPING = numerics(
    (0.003, 0.03, 0.3),
    "parts of the critical",
    why="a grid, even in the logarithm, of what is tried where a force drives",
)
_FREQUENCIES = numerics(np.geomspace(0.2, 5.0, 49), "times that of the motion", why="a grid, even in the logarithm")
_FALLS = numerics(
    (0.3, 1.0, 3.0, 10.0, 30.0),
    "natural logarithm",
    why="a grid of how much a free decay falls from its beginning to its end",
)
_KEPT = budget(3, "places", why="of the grid that are followed to their own best")
_STEPS = budget(15, "steps", why="the search of the simulation begins where this one ends")


@dataclass(frozen=True, eq=False)
class LinearFit:
    """The best linear rig.

    Attributes:
        omega0: rad/s.
        viscous: 1/s.
        mass: None where nothing is driven, or where the response goes against its force.
        initial: (segments, 2) displacement and velocity.
        offsets: (segments,) what the sensor shows at zero.
        nrmse: (segments,) rms of what it leaves over the motion's standard deviation.
    """

    omega0: float
    viscous: float
    mass: float | None
    initial: np.ndarray
    offsets: np.ndarray
    nrmse: np.ndarray


def linear_fit(segments: Sequence[Segment]) -> LinearFit | None:
    """Fit a linear rig to segments; None where a motion shows no frequency of its own, as on a slide."""
    if not segments or any(segment.slide for segment in segments):
        return None
    signals = [Signal(segment) for segment in segments]
    fewer = [Signal(segment, _COMPARED) for segment in segments]
    pace = segments[0].pace
    longest = max(s.n * s.dt for s in segments)
    coarsest = max(s.dt for s in segments)
    low = np.log([0.5 / longest, 1e-4 / longest])
    high = np.log([np.pi / coarsest, np.pi / coarsest])
    places = _free_places([s for s in signals if s.force is None])
    if any(s.force is not None for s in signals):
        places += [(k * pace, z * k * pace) for k in _FREQUENCIES for z in _DAMPING]
    if not places:  # what stands still, or moves by less than a cycle, shows no line
        return None
    inside = [np.clip(np.log(place), low + _EDGE, high - _EDGE) for place in places]
    costs = [linear_response(fewer, theta).cost for theta in inside]
    nearest = [followed(fewer, inside[i], (low, high), _STEPS).theta for i in np.argsort(costs)[:_KEPT]]
    best = min(nearest, key=lambda theta: linear_response(signals, theta).cost)  # of fewer an alias leaves no more
    best = followed(signals, best, (low, high), _STEPS)
    (pole,) = best.poles.tolist()
    initial = []
    for own, segment in zip(best.own, segments, strict=True):
        phasor = complex(own[0], -own[1]) / pole**segment.order
        initial.append((phasor.real, (pole * phasor).real))
    return LinearFit(
        abs(pole),
        -2.0 * pole.real,
        1.0 / float(best.gains[0]) if best.gains[0] > 0.0 else None,
        np.array(initial),
        np.array([own[2] for own in best.own]),
        np.array([np.linalg.norm(rest) for rest in best.rests]),
    )


def _free_places(signals: Sequence[Signal]) -> list[tuple[float, float]]:
    """Frequencies and rates at which damped sines take most of what moves freely: the peaks of its damped spectra."""
    if not signals:
        return []
    step = min(signal.dt * signal.stride for signal in signals)
    longest = max(signal.time[-1] for signal in signals)
    size = 4 * 2 ** int(np.ceil(np.log2(longest / step + 1)))
    omega = 2 * np.pi * np.fft.rfftfreq(size, step)
    places = []
    for fall in _FALLS:
        rate = fall / longest
        power = np.zeros(omega.size)
        for signal in signals:
            window = np.exp(-rate * signal.time)
            moved = signal.measured - np.mean(signal.measured)
            own = np.abs(np.fft.rfft(moved * window, size)) ** 2 / np.sum(window**2)
            power += np.interp(omega, 2 * np.pi * np.fft.rfftfreq(size, signal.dt * signal.stride), own)
        power[omega < 2 * (2 * np.pi) / longest] = 0.0  # at least two cycles
        places += [(float(omega[k]), rate) for k in _peaks(power)]
    return places


def _peaks(power: np.ndarray) -> list[int]:
    """The highest local maxima."""
    inner = np.flatnonzero((power[1:-1] >= power[:-2]) & (power[1:-1] > power[2:])) + 1
    return inner[np.argsort(power[inner])[::-1][:_KEPT]].tolist()
