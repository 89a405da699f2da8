"""The errors that a fit will state, before it is made: the Fisher information along the motion.

The response's derivatives by the parameters, from the engine, are divided by the noise; their inner products, initial
states and offsets eliminated, are the information that the recordings hold (Fisher 1922). Its inverse bounds the
covariance of every unbiased estimate (Cramér 1946), and maximum likelihood reaches it. What noise on a force does
beside that, of which a spectrum keeps only the mean over the record, and what not knowing the force between its samples
adds, are in it as they are in a fit's own errors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..identify.fit.climb import best_climb
from ..identify.fit.from_prediction import keeps_step, simulates
from ..identify.fit.hold import find_hold
from ..identify.fit.offsets import kept_offsets, zeros_of
from ..identify.fit.reweighted_fit import over_noise
from ..identify.fit.scatter import noise_on_forces, scatter
from ..identify.problem.data import Data, equivalent_resonance, noise_at
from ..identify.problem.descent import search
from ..identify.problem.jumps import smooth_stretches
from ..identify.problem.linearised import Linearised
from ..identify.problem.normal_equations import pseudo_inverse
from ..identify.problem.output_error import OutputError, State
from ..identify.problem.segments import Segment
from ..identify.problem.settle import settled
from ..identify.problem.structure import Structure
from ..identify.signals.noise_spectrum import NoiseSpectrum, white
from ..identify.signals.odds import ABOVE_NOISE
from ..identify.signals.registry import budget
from ..identify.signals.signals import noise_levels
from ..model import Oscillator, Provenance
from ..model.terms import with_values
from ..recording.recording import Recording

_STEPS = budget(8, "steps", why="of least squares from start values that follow the motion: the errors need no more")


@dataclass(frozen=True, eq=False)
class Information:
    """What recordings tell of a model's parameters, at values near theirs.

    Attributes:
        model: structure and values.
        names: free parameters in the covariance's order.
        covariance: (k, k) that a fit is expected to state.
        segments: of the recordings.
        left: (segments,) what the simulation at these values leaves of each motion, rms over its standard deviation.
        over_noise: (segments,) the same over the noise.
    """

    model: Oscillator
    names: tuple[str, ...]
    covariance: np.ndarray
    segments: tuple[Segment, ...]
    left: tuple[float, ...]
    over_noise: tuple[float, ...]

    @property
    def follows(self) -> bool:
        """Whether what is left is noise, so that the errors can be foretold."""
        return max(self.over_noise) <= ABOVE_NOISE


def information(
    model: Oscillator,
    data: Data,
    recordings: Sequence[Recording],
    fixed: Sequence[str] = (),
    others: Callable[[], Iterable[Oscillator]] = tuple,
) -> Information:
    """What recordings tell of a model, along the motion that it makes of them.

    Args:
        model: structure and start values.
        data: the recordings, cut.
        recordings: of the segments.
        fixed: names of parameters that keep their values.
        others: more models of the same structure, asked for where the first explains little.

    Raises:
        BadInput: where the model does not simulate along them.
    """
    structure = Structure(model, data, fixed, ())
    problem, state, residuals = _near(structure, model, data, recordings, fixed, others)
    if not all(np.all(np.isfinite(left)) for left in residuals):
        raise BadInput("no model of Eq. 17 was found that simulates along these recordings; check units and signs")
    smooth, state = smooth_stretches(problem, state)  # as a fit leaves out what jumps, and knows the less for it
    if smooth != problem.segments:
        problem = problem.over(smooth)
        residuals = problem.residuals(state)
    near = with_values(model, state.values)
    over = over_noise(problem, residuals, state, model, recordings)
    remainders = None
    if max(over) <= ABOVE_NOISE:
        noise = noise_at(problem, residuals, state, model)
    else:  # as a fit does that leaves more than noise
        noise, remainders = [white(left) for left in residuals], noise_at(problem, residuals, state, model)
    linearised = Linearised.of(problem, state, residuals, noise)
    known = linearised.shared.without(slice(len(problem.free), None)) if problem.offsets else linearised.shared
    inverse = pseudo_inverse(known.normal)
    levels = noise_on_forces(problem, state, residuals, recordings)
    spread = scatter(problem, state, noise, levels, 0, remainders=remainders)
    covariance = inverse @ spread @ inverse
    if remainders is None:
        held = find_hold(problem, state, near, recordings)
        covariance = covariance + held.spread(held.hold)
    left = [float(np.std(r) / np.std(s.response)) for r, s in zip(residuals, problem.segments, strict=True)]
    return Information(near, structure.free, covariance, problem.segments, tuple(left), tuple(over))


def _near(
    structure: Structure,
    model: Oscillator,
    data: Data,
    recordings: Sequence[Recording],
    fixed: Sequence[str],
    others: Callable[[], Iterable[Oscillator]],
) -> tuple[OutputError, State, tuple[np.ndarray, ...]]:
    """The problem at values near the answer: those given where they leave noise, else after a few steps."""
    problem = structure.problem
    state = settled(problem, structure.state(None))
    residuals = problem.residuals(state)
    if keeps_step(problem.segments, residuals) and (
        max(over_noise(problem, residuals, state, model, recordings)) <= ABOVE_NOISE
    ):  # with no zero of a sensor in what is left
        outcome = search(problem, state, tolerance=1.0, most=_STEPS, informed=False, residuals=residuals)
        return problem, outcome.state, outcome.residuals
    structure = Structure(model, data, fixed, zeros_of(data, recordings, model))
    problem = structure.problem
    state = settled(problem, structure.state(None))
    if keeps_step(problem.segments, problem.residuals(state)):
        state = search(problem, state, tolerance=1.0, most=_STEPS, informed=False).state
    else:
        climb = best_climb(problem, structure.state(None), others)
        problem, state = climb.problem, climb.state
    problem, state = kept_offsets(problem, state, model)
    return problem, state, problem.residuals(state)


def foretold(model: Oscillator, data: Data, recordings: Sequence[Recording], fixed: Sequence[str] = ()) -> Information:
    """As ``information``, in a tenth of the time: at the values given, by the noise that the sensors show alone.

    Raises:
        BadInput: where the model does not simulate along them.
    """
    structure = Structure(model, data, fixed, ())
    problem = structure.problem
    state = settled(problem, structure.state(None))
    if not simulates(problem, state):
        raise BadInput("the model does not simulate along these recordings from its start values")
    residuals, rows = problem.residuals_with_derivatives(state, single=True)
    noise = [
        expected_spectrum(segment, model, *noise_levels(recordings[segment.recording])) for segment in problem.segments
    ]
    shared = Linearised.of(problem, state, residuals, noise, rows).shared
    left = [float(np.std(r) / np.std(s.response)) for r, s in zip(residuals, problem.segments, strict=True)]
    over = over_noise(problem, residuals, state, model, recordings)
    covariance = pseudo_inverse(shared.normal)
    return Information(model, structure.free, covariance, problem.segments, tuple(left), tuple(over))


def expected_spectrum(segment: Segment, model: Oscillator, sensor: float, force: float) -> NoiseSpectrum:
    """Spectrum of what noise of the sensor, and of the force as the rig passes it on, leave in one segment.

    Args:
        segment: of a recording.
        model: that is driven.
        sensor, force: standard deviations of the noise of response and force.
    """
    density = np.full(segment.n // 2 + 1, max(sensor, float(np.finfo(float).tiny) ** 0.25) ** 2)
    if segment.force is None or not force > 0.0 or model.mass is None:
        return NoiseSpectrum(density, segment.n)
    passed = (force / model.mass.value) ** 2 * equivalent_resonance(segment, model.values())
    return NoiseSpectrum(density + passed, segment.n, passed / (density + passed))


def with_covariance(model: Oscillator, names: Sequence[str], covariance: np.ndarray) -> Oscillator:
    """The model with errors of its parameters, so that what follows from them has errors too."""
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    known = {name: replace(p, std=None) for name, p in model.parameters().items()}
    told = known | {name: replace(known[name], std=float(error)) for name, error in zip(names, errors, strict=True)}
    rows = tuple(tuple(float(c) for c in row) for row in covariance)
    return replace(  # amid no amplitudes: what follows from the parameters alone
        model.with_parameters(told),
        amplitude=None,
        identified=Provenance(parameters=tuple(names), covariance=rows, method="expected"),
    )
