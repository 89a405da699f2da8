"""Models rehearsed under excitations that were never played: responses, derivatives, and what one can imitate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..identify.fit.scatter import scatter
from ..identify.problem.data import Data, equivalent_resonance
from ..identify.problem.descent import search
from ..identify.problem.linearised import Linearised, off, orthonormal
from ..identify.problem.normal_equations import pseudo_inverse
from ..identify.problem.output_error import OutputError, State
from ..identify.problem.segments import FORCE_BAND, Segment
from ..identify.problem.structure import parameter_bounds, parameter_sizes
from ..identify.signals.noise_spectrum import NoiseSpectrum
from ..identify.signals.registry import budget, numerics
from ..model import Oscillator
from ..simulate.core import core_of, internal_step
from ..simulate.force import smooth_force
from .excitation import Excitation

_SMALL = numerics(1e-2, "of a parameter", why="the step of a difference quotient: its error is of second order")
_COARSER = numerics(1.6, "times the steps of a model that is delivered", why="the error stays far below any noise")
_STEPS = budget(8, "steps", why="quadratic convergence: a rival near its minimum needs fewer")


@dataclass(frozen=True, eq=False)
class Played:
    """One model under all excitations: responses (n,), and whitened these and their derivatives (k, n).

    None where the simulation fails.
    """

    problem: OutputError
    state: State
    raw: tuple[np.ndarray, ...]
    noise: tuple[NoiseSpectrum | None, ...]
    responses: tuple[np.ndarray | None, ...]
    derivatives: tuple[np.ndarray | None, ...]
    peaks: tuple[float, ...]

    def covariance(self, i: int, free: Sequence[int], force_noise: float) -> np.ndarray | None:
        """(k, k) that a fit of some parameters to the response under one excitation would state; None where it fails.

        Args:
            i: which excitation.
            free: indices of the parameters.
            force_noise: standard deviation of the noise on samples of the rehearsal's force.
        """
        noise = self.noise[i]
        if noise is None:
            return None
        problem, state = self._alone(self.problem.segments[i], free), self._state(i)
        known = Linearised.of(problem, state, problem.residuals(state), [noise]).shared.normal
        inverse = pseudo_inverse(known)
        driven = self.problem.segments[i].force is not None
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # where friction decides by chance, derivatives have no bound
            spread = scatter(problem, state, [noise], [force_noise if driven else 0.0], 0)
            covariance = inverse @ spread @ inverse
        return covariance if np.all(np.isfinite(covariance)) else None

    def _alone(self, segment: Segment, free: Sequence[int]) -> OutputError:
        p = self.problem
        return OutputError(p.core, (segment,), tuple(free), p.scale, p.state_scale, p.max_step, p.bounds)

    def _state(self, i: int) -> State:
        return State(self.state.values, self.state.initial[i : i + 1])

    def imitates(self, other: Played, i: int) -> float:
        """How many times the noise this model stays off another's response with all its parameters fitted to it."""
        noise = other.noise[i]
        if noise is None or self.responses[i] is None:
            return 0.0
        segment = replace(self.problem.segments[i], response=other.raw[i])
        alone, start = self._alone(segment, self.problem.free), self._state(i)
        return float(np.sqrt(2.0 * search(alone, start, (noise,), tolerance=0.5, most=_STEPS).cost))


def rehearse(
    model: Oscillator,
    reference: Oscillator,
    plans: Sequence[Excitation],
    data: Data,
    rate: float,
    fs: float,
    reach: float,
) -> Played:
    """Simulate one model under all excitations; noise as the reference passes it on, the same for all models.

    Args:
        model: that is simulated.
        reference: by whose resonance the noise of the force comes through.
        plans: what is played.
        data: noise of the sensors, and sizes of the motion.
        rate: samples a second of the rehearsal, and ``fs`` those of what would be recorded.
        reach: displacement up to which the simulation is to be right.
    """
    core = core_of(model)
    scales = data.scales
    segments, initial = [], np.zeros((len(plans), core.states))
    for i, plan in enumerate(plans):
        samples = plan.signal(rate)
        natural = model.omega0.value / (2 * np.pi)
        force = None if plan.kind == "decay" else smooth_force(samples, 1 / rate, FORCE_BAND * natural)
        zero = np.zeros(samples.size)
        rests, quantity = force is not None, model.response.quantity
        segments.append(
            Segment(0, 0, samples.size, zero, force, 1 / rate, 0.0, scales.omega, rests=rests, quantity=quantity)
        )
        if force is None:
            initial[i, 0] = plan.level
    inner = [_SMALL * scales.of(state.unit) for state in core.equations.inner]
    sizes = np.array([_SMALL * scales.length, _SMALL * scales.length * scales.omega, *inner])
    values = np.array(list(model.values().values()))
    step = internal_step(model, model.values(), reach) * _COARSER
    parameters = range(values.size)
    problem = OutputError(
        core, segments, tuple(parameters), parameter_sizes(model, scales), sizes, step, parameter_bounds(model, scales)
    )
    state = State(values, initial)
    residuals = problem.residuals(state)
    derivatives = problem.derivatives(state, [np.where(np.isfinite(r), r, 0.0) for r in residuals])
    noises, responses, slopes, peaks = [], [], [], []
    for i, segment in enumerate(segments):
        fine = np.all(np.isfinite(residuals[i]))
        noise = _noise(segment, -residuals[i], reference, data, rate / fs) if fine else None
        noises.append(noise)
        responses.append(None if noise is None else noise.whiten(-residuals[i]))
        slopes.append(None if noise is None else noise.whiten(derivatives[i]))
        peaks.append(float(np.max(np.abs(residuals[i]))) / scales.omega**segment.order if fine else np.inf)
    raw = tuple(-residual for residual in residuals)
    return Played(problem, state, raw, tuple(noises), tuple(responses), tuple(slopes), tuple(peaks))


def _noise(segment: Segment, response: np.ndarray, model: Oscillator, data: Data, thinned: float) -> NoiseSpectrum:
    """Sensor noise, and force noise through the resonance; fewer samples than recorded count for as much."""
    sensor = float(np.median(data.sensor)) ** 2 * thinned
    if sensor <= 0.0:
        sensor = (1e-4 * data.scales.response) ** 2
    density = np.full(segment.n // 2 + 1, sensor)
    if segment.force is not None and model.mass is not None and np.any(response):
        force = max(data.force) ** 2 * thinned
        heard = replace(segment, response=response)
        passed = force / model.mass.value**2 * equivalent_resonance(heard, model.values())
        return NoiseSpectrum(density + passed, segment.n, passed / (density + passed))
    return NoiseSpectrum(density, segment.n)


def apart(played: Played, other: Played, i: int) -> float:
    """By how many times the noise two models differ, the more easily imitated direction counting."""
    a, b = played.responses[i], other.responses[i]
    slopes = played.derivatives[i], other.derivatives[i]
    if a is None or b is None or slopes[0] is None or slopes[1] is None:
        return 0.0
    return min(float(np.linalg.norm(off(orthonormal(rows), a - b))) for rows in slopes if rows is not None)
