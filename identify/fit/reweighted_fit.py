"""The maximum of the likelihood with every frequency weighted by what is left there, as long as that is noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...model import Oscillator
from ...model.left import times_the_noise
from ...recording.recording import Recording
from ..problem.data import equivalent_resonance, expected_noise, noise_at
from ..problem.descent import MOST_STEPS, Descent, search
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..problem.search_point import Outcome
from ..signals.noise_spectrum import NoiseSpectrum, concentrated_likelihood, estimate, white
from ..signals.odds import ABOVE_NOISE
from ..signals.registry import numerics
from ..signals.signals import noise_levels
from .choose_noise_model import by_chance, plain_cost

FINE = numerics(1e-3, "log-likelihood", why="a twentieth of a standard error: the search for an answer is over")
NEAR_ENOUGH = numerics(
    0.01, "log-likelihood", why="a seventh of a standard error: the search for what is only compared is over"
)


@dataclass(frozen=True, eq=False)
class Answer:
    """A maximum with the noise that it was weighted by, and its log-likelihood but for a constant.

    ``remainders`` are the spectra of what it leaves, where it was weighted by others.
    """

    outcome: Outcome
    noise: list[NoiseSpectrum]
    likelihood: float
    remainders: list[NoiseSpectrum] | None = None


def reweighted(
    problem: OutputError,
    state: State,
    start: Oscillator,
    recordings: Sequence[Recording],
    linear: float = np.inf,
    most: int = MOST_STEPS,
) -> tuple[Answer, int]:
    """The maximum with every frequency weighted, or unweighted least squares where that has lost the motion.

    What a wrong model leaves is no noise. Weighed by it, what is explained least counts least, the more so the fewer
    frequencies the motion has: a search may buy some noise elsewhere with the motion itself.

    Args:
        problem: the model over the segments.
        state: its least squares.
        start: structure.
        recordings: of the segments.
        linear: ``plain_cost`` of a linear rig, which the answer must not exceed.
        most: steps that each search may take.
    """
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(r))) for r in residuals) or (
        max(over_noise(problem, residuals, state, start, recordings)) <= ABOVE_NOISE
    ):
        return whitened(problem, state, start, most=most)
    answer, steps = whitened(problem, state, start, tolerance=NEAR_ENOUGH, most=most, informed=False)
    if not np.isfinite(answer.likelihood):
        return answer, steps
    nearer = min(
        (state, residuals), (answer.outcome.state, answer.outcome.residuals), key=lambda point: plain_cost(point[1])
    )
    plain = search(problem, nearer[0], tolerance=FINE, most=most, tempered=False, residuals=nearer[1])
    steps += plain.iterations
    remainders = _remainders(problem, plain, start, recordings)
    cost = plain_cost(answer.outcome.residuals)
    if cost <= linear and cost - plain_cost(plain.residuals) < by_chance(problem, plain, remainders):
        answer, more = finished(problem, answer, start, most=most)
        return answer, steps + more
    flat = [white(residual) for residual in plain.residuals]
    remainders = noise_at(problem, plain.residuals, plain.state, start)  # for the errors what any noise could do
    plain = replace(plain, cost=0.5 * sum(residual.size for residual in plain.residuals))  # that under flat spectra
    return Answer(plain, flat, concentrated_likelihood(remainders), remainders), steps


def whitened(
    problem: OutputError,
    state: State,
    start: Oscillator,
    *,
    tolerance: float = FINE,
    most: int = MOST_STEPS,
    informed: bool = True,
) -> tuple[Answer, int]:
    """The maximum with every frequency weighted by the noise that is left there, and the steps to it.

    ``tolerance``, ``most`` and ``informed`` are as in ``descent.search``.
    """
    residuals, steps = problem.residuals(state), 0
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        nothing = np.zeros((len(problem.free), len(problem.free)))
        return Answer(Outcome(state, np.inf, nothing, residuals, 0, False), [], -np.inf), 0
    noise = noise_at(problem, residuals, state, start)
    rough = {"tolerance": 100.0 * tolerance, "most": most, "informed": False}
    outcome = search(problem, state, noise, **rough, residuals=residuals)
    state, residuals, steps = outcome.state, outcome.residuals, outcome.iterations
    noise = noise_at(problem, residuals, state, start)
    fine = {"tolerance": tolerance, "most": most, "informed": informed}
    outcome = search(problem, state, noise, **fine, residuals=residuals)
    likelihood = concentrated_likelihood(noise_at(problem, outcome.residuals, outcome.state, start))
    return Answer(outcome, noise, likelihood), steps + outcome.iterations


def finished(problem: OutputError, answer: Answer, start: Oscillator, *, most: int = MOST_STEPS) -> tuple[Answer, int]:
    """The maximum of which an answer is known to be near, weighted as there; and the steps to it."""
    near = answer.outcome
    outcome = search(problem, near.state, answer.noise, tolerance=FINE, most=most, residuals=near.residuals)
    likelihood = concentrated_likelihood(noise_at(problem, outcome.residuals, outcome.state, start))
    return Answer(outcome, answer.noise, likelihood), outcome.iterations


def concentrated(problem: OutputError, state: State, start: Oscillator) -> float:
    """Log-likelihood at a point, concentrated over the noise spectra, but for a constant; -inf where not finite."""
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return -np.inf
    return concentrated_likelihood(noise_at(problem, residuals, state, start))


def within_reach(problem: OutputError, state: State, start: Oscillator) -> tuple[float, float]:
    """Log-likelihood, as ``concentrated`` has it, here and where the whole next step would lead if the response were
    linear; -inf where it does not simulate."""
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return -np.inf, -np.inf
    here = noise_at(problem, residuals, state, start)
    expected = Descent(problem, state, here, residuals).expected
    there = [left if np.all(np.isfinite(left)) else now for left, now in zip(expected, residuals, strict=True)]
    likelihood = concentrated_likelihood(here)
    return likelihood, max(likelihood, concentrated_likelihood(noise_at(problem, there, state, start)))


def over_noise(
    problem: OutputError,
    residuals: Sequence[np.ndarray],
    state: State,
    start: Oscillator,
    recordings: Sequence[Recording],
) -> list[float]:
    """For each segment the rms of what is left over that of the noise."""
    levels = noise_alone(problem, state, start, recordings)
    return [times_the_noise([residual], [level]) for residual, level in zip(residuals, levels, strict=True)]


def noise_alone(problem: OutputError, state: State, start: Oscillator, recordings: Sequence[Recording]) -> list[float]:
    """Rms that noise of sensor and force alone leaves of each segment, in its unit."""
    values = dict(zip(start.parameters(), map(float, state.values), strict=True))
    return [expected_noise(s, values, *noise_levels(recordings[s.recording])) for s in problem.segments]


def _remainders(
    problem: OutputError, plain: Outcome, start: Oscillator, recordings: Sequence[Recording]
) -> list[NoiseSpectrum]:
    """Spectra of what least squares leave: as they show, and no less than sensors' noise makes through the model.

    Not of the form that a fit weighs by: noise on the force that nobody saw there would explain all of a motion.
    """
    values = dict(zip(start.parameters(), map(float, plain.state.values), strict=True))
    spectra = []
    for segment, residual in zip(problem.segments, plain.residuals, strict=True):
        shown = estimate(residual)
        density = np.full(shown.density.size, noise_levels(recordings[segment.recording])[0] ** 2)
        if segment.force is not None and problem.memory == FREE:
            force = noise_levels(recordings[segment.recording])[1] / values["mass"]
            density = density + force**2 * equivalent_resonance(segment, values)
        spectra.append(replace(shown, density=np.maximum(shown.density, density)))
    return spectra
