"""A linear rig fitted to all segments from no start at all: the least that any answer has to reach.

    x'' + viscous x' + omega0² x = F / m, and what the sensor shows at zero

Its motion from rest and its free motion are known in closed form for a force in straight lines between its samples, so
that mass, offsets and initial states follow from linear least squares at each frequency and damping (variable
projection: Golub and Pereyra 1973), and these two can be tried all over the recordings' spectrum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...simulate.recursion import recursion
from ..problem.segments import Segment
from ..signals.registry import budget, numerics
from .limits import MOST_DAMPING

_EDGE = numerics(1e-9, "natural logarithm", why="within the bounds, where a search may begin")

_SAMPLES_A_CYCLE = numerics(32.0, "samples a cycle", why="by which a sine is told")
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
    from scipy.optimize import least_squares

    if not segments or any(segment.slide for segment in segments):
        return None
    signals = [Signal(segment) for segment in segments]
    fewer = [Signal(segment, _COMPARED) for segment in segments]

    def remainder(theta: np.ndarray, signals: Sequence[Signal] = fewer) -> np.ndarray:
        return np.concatenate(_solve(signals, *np.exp(theta)).rests)

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
    costs = [float(np.sum(remainder(theta) ** 2)) for theta in inside]
    nearest = [inside[i] for i in np.argsort(costs)[:_KEPT]]
    outcomes = [least_squares(remainder, theta, bounds=(low, high), max_nfev=_STEPS) for theta in nearest]
    best = min(outcomes, key=lambda outcome: outcome.cost)
    best = least_squares(remainder, best.x, bounds=(low, high), max_nfev=_STEPS, args=(signals,))
    omega, rate = np.exp(best.x)
    solved = _solve(signals, omega, rate)
    pole = complex(-rate, omega)
    initial = []
    for own, segment in zip(solved.own, segments, strict=True):
        phasor = complex(own[0], -own[1]) / pole**segment.order
        initial.append((phasor.real, (pole * phasor).real))
    return LinearFit(
        float(np.hypot(omega, rate)),
        float(2.0 * rate),
        1.0 / solved.gain if solved.gain > 0.0 else None,
        np.array(initial),
        np.array([own[2] for own in solved.own]),
        np.array([np.sqrt(np.mean(rest**2) * signal.size) for rest, signal in zip(solved.rests, signals, strict=True)]),
    )


class Signal:
    """One segment: its response in units of its standard deviation, its force as finely as a sine needs."""

    def __init__(self, segment: Segment, samples_a_cycle: float = _SAMPLES_A_CYCLE, *, by_means: bool = False) -> None:
        self.order, self.dt = segment.order, segment.dt
        cycle = 2 * np.pi / (segment.pace * segment.dt)
        self.skipped = max(1, int(cycle / _SAMPLES_A_CYCLE))
        self.stride = self.skipped * max(1, int(cycle / (self.skipped * samples_a_cycle)))
        self.scale = float(np.std(segment.response)) or 1.0
        shown = segment.response[:: self.stride] / self.scale
        if by_means and segment.force is None:  # of damped sines means are damped sines, with less noise
            whole = segment.response[: segment.n // self.stride * self.stride]
            shown = np.mean(whole.reshape(-1, self.stride), axis=1) / self.scale
        self.size = shown.size
        self.measured = shown / np.sqrt(self.size)  # every segment counts alike
        self.time = segment.dt * self.stride * np.arange(self.size)
        self.force: np.ndarray | None = None
        if segment.force is not None:
            pieces, fine = segment.force.pieces, segment.force.fine
            end = pieces[-1] @ (segment.dt / fine) ** np.arange(4)
            force, self.held = np.append(pieces[:, 0], end), segment.force.hold == "zero"
            enough = _SAMPLES_A_CYCLE / cycle  # points a sample
            points = next(k for k in range(1, fine + 1) if fine % k == 0 and (k >= enough or k == fine))
            force = force[: segment.n * fine][:: fine // points]
            if self.skipped > 1 and self.held:  # held for the mean of what was skipped
                force = np.append(force, np.full(-force.size % self.skipped, force[-1]))
                force = np.mean(force.reshape(-1, self.skipped), axis=1)
            elif self.skipped > 1:
                force = force[:: self.skipped]
            self.force, self.step = force, segment.dt * self.skipped / points
            self.every = self.stride // self.skipped * points

    def free(self, omega: float, rate: float) -> np.ndarray:
        """(size, 3) the two free motions and what the sensor shows at zero, each in units of the response."""
        fall = np.exp(-rate * self.time)
        columns = np.column_stack(
            [fall * np.cos(omega * self.time), fall * np.sin(omega * self.time), 1.0 + 0.0 * fall]
        )
        return columns / (self.scale * np.sqrt(self.size))

    def driven(self, omega: float, rate: float) -> np.ndarray:
        """(size,) response from rest of a mass of one, in the same units."""
        assert self.force is not None
        pole = complex(-rate, omega)
        turn = np.exp(pole * self.step)
        whole = (turn - 1.0) / pole
        last = 0.0 if self.held else (whole / self.step - 1.0) / pole  # straight lines: the sample at the end's part
        pushes = (whole - last) * self.force[:-1] + last * self.force[1:]
        moved = np.append(0.0, recursion(np.array([[turn]]), pushes[:, None]))
        response = np.imag(pole**self.order * moved) / omega + (self.force if self.order == 2 else 0.0)
        sampled = response[:: self.every][: self.size]
        sampled = np.append(sampled, np.zeros(self.size - sampled.size))
        return sampled / (self.scale * np.sqrt(self.size))


@dataclass(frozen=True, eq=False)
class _Solved:
    """What linear least squares finds at one frequency and damping: gain, each segment's own, and what is left."""

    gain: float
    own: list[np.ndarray]
    rests: list[np.ndarray]


def _solve(signals: Sequence[Signal], omega: float, rate: float) -> _Solved:
    rate = min(rate, omega * MOST_DAMPING / np.sqrt(1.0 - MOST_DAMPING**2))
    columns = [signal.free(omega, rate) for signal in signals]
    bases = [np.linalg.qr(part / sizes_of(part))[0] for part in columns]
    rests = [s.measured - basis @ (basis.T @ s.measured) for s, basis in zip(signals, bases, strict=True)]
    forced: list[np.ndarray | None] = []
    above = below = 0.0
    for signal, basis, rest in zip(signals, bases, rests, strict=True):
        if signal.force is None:
            forced.append(None)
            continue
        made = signal.driven(omega, rate)
        forced.append(made)
        part = made - basis @ (basis.T @ made)
        above, below = above + float(part @ rest), below + float(part @ part)
    gain = above / below if below > 0.0 else 0.0
    own, final = [], []
    for signal, part, made in zip(signals, columns, forced, strict=True):
        measured = signal.measured if made is None else signal.measured - gain * made
        size = sizes_of(part)
        weights = np.linalg.lstsq(part / size, measured, rcond=1e-12)[0] / size
        own.append(weights)
        final.append(measured - part @ weights)
    return _Solved(gain, own, final)


def sizes_of(columns: np.ndarray) -> np.ndarray:
    """(k,) norms of columns; above zero also where a fall within one sample leaves nothing of a sine."""
    return np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)


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
