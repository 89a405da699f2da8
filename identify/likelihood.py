"""Maximum likelihood for any structure, over all recordings jointly; it survives a model that is not exact.

The model is the recorded rig's but for a latent force (``prediction``). With a long enough memory of the model the
likelihood is that of output error with the noise's own spectrum (Whittle 1953), which reaches the Cramér-Rao bound
where regressions on differentiated data are biased by any noise; with a short one it is that of prediction over a
cycle, which every start survives. The search runs from prediction to simulation, each time from where the last ended.
The answer is that of simulation where the model keeps step with the recordings; what the most likely memory says
otherwise is then in the standard errors. Where no simulation keeps step, the answer is that of the most likely memory.

The map from what was measured to the prediction errors is causal with a unit diagonal, whatever the gain, so that
likelihoods of different memories are those of the same data and may be compared.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..model import Oscillator
from ..recording.recording import Recording
from .data import Data, data_of, expected_noise, noise_of
from .hilbert import noise_level
from .jumps import left_out, smooth_stretches
from .noise_spectrum import NoiseSpectrum
from .normal_equations import pseudo_inverse
from .offset import FoundOffset
from .offsets import found_offsets, kept_offsets, response_offsets
from .output_error import Outcome, OutputError, State
from .prediction import FREE
from .scatter import scatter
from .segments import Segment
from .settle import settled
from .structure import Structure

#: The search begins with this memory, in cycles of the motion, and lets it grow by this factor.
_FIRST_MEMORY = 1.0
_GROWTH = 8.0
#: Free decays are fitted over this many cycles first, then over so many times as many.
_FIRST_CYCLES = 12.0
_LONGER = 4.0
#: Steps at each memory: it only has to lead to the next.
_EARLY_STEPS = 8
#: A simulation keeps step where it leaves less than this part of each motion: its phase is then off by less than as
#: much in radians, where a sine is still a straight line.
_IN_STEP = 0.3
#: ... in stretches of so many cycles, and but for so many times the noise.
_STRETCH = 8.0
_BEYOND_NOISE = 3.0
#: Simulation is given up for prediction where that is a thousand times as likely.
_DECISIVE = float(np.log(1000.0))
#: Residuals this many times the noise are more than the noise's own estimate leaves open.
_ABOVE_NOISE = 1.1
#: Draws of force noise for the covariance: its standard errors are then good to 9 %.
_DRAWS = 60


@dataclass(frozen=True, eq=False)
class SegmentFit:
    """How one segment came out.

    Attributes:
        segment: what was fitted.
        initial: (states,) displacement, velocity and inner states at its first sample.
        simulated: (n,) response, simulated freely, the sensor's offset in it.
        nrmse: rms(simulated - measured) / std(measured).
        over_noise: rms of the prediction errors over that of the noise.
    """

    segment: Segment
    initial: np.ndarray
    simulated: np.ndarray
    nrmse: float
    over_noise: float


@dataclass(frozen=True, eq=False)
class Fit:
    """The maximum of the likelihood.

    Attributes:
        oscillator: the model with identified values and standard errors.
        names: free parameters in the covariance's order.
        covariance: (k, k).
        log_likelihood: at the maximum, with the noise spectra found.
        segments: one per segment.
        noise: noise spectrum of each segment.
        memory: how far the model predicts in this answer, in cycles; ``FREE`` for simulation.
        offsets: what the sensors show at zero, as far as the recordings ask for it.
        iterations: steps of the search, all rounds together.
        converged: whether the last round came to rest.
        notes: what a user should know.
    """

    oscillator: Oscillator
    names: tuple[str, ...]
    covariance: np.ndarray
    log_likelihood: float
    segments: tuple[SegmentFit, ...]
    noise: tuple[NoiseSpectrum, ...]
    memory: float
    offsets: tuple[FoundOffset, ...]
    iterations: int
    converged: bool
    notes: tuple[str, ...]


def maximum_likelihood(
    start: Oscillator, recordings: Sequence[Recording], fixed: Sequence[str] = (), data: Data | None = None
) -> Fit:
    """Find the parameters of ``start``'s structure that make the recordings most likely.

    Args:
        start: structure, with any laws of the library, and start values; ``mass`` None where no recording has a force.
        recordings: of one rig, all of the same quantity.
        fixed: names of parameters that keep their values.
        data: the recordings as they are fitted, where they have been cut before.

    Raises:
        BadInput: where nothing in the recordings can be simulated.
    """
    data = data or data_of(recordings, start, coarse=False)
    structure = Structure(start, data, fixed, response_offsets(data, recordings, start))
    problem = structure.problem
    free, rungs, iterations = structure.state(None), {}, 0
    for stage in _growing(problem.segments):
        free, rungs, steps = _from_prediction(problem.over(stage), free)
        iterations += steps
    problem, free = kept_offsets(problem, free, start)
    smooth, left = smooth_stretches(problem, free)
    notes = left_out(problem.segments, smooth, [recording.name for recording in recordings])
    if notes:
        problem = problem.over(smooth)  # what has no derivative may have held the search back
        free, rungs, steps = _from_prediction(problem, left)
        iterations += steps
    answer, steps = _whitened(problem, free, start)
    iterations += steps
    other = answer
    if max(_over_noise(problem, answer, start, recordings)) > _ABOVE_NOISE:
        predicted, steps = _predictions(problem, answer, rungs, start)
        iterations += steps
        if not keeps_step(problem.segments, answer.outcome.residuals):
            memory, answer = predicted[0]
            problem, other = problem.predicting(memory), predicted[min(1, len(predicted) - 1)][1]
        elif predicted[0][1].likelihood > answer.likelihood + _DECISIVE:
            other = predicted[0][1]
    if not np.isfinite(answer.likelihood):
        raise BadInput(
            "no model of this structure simulates along these recordings; check signs and units of force and response"
        )
    doubt = other.outcome.state.values - answer.outcome.state.values
    used = {segment.recording for segment in problem.segments}
    notes += [
        f"{recording.name}: nothing in it that could be fitted; it was left out"
        for i, recording in enumerate(recordings)
        if i not in used and not any(note.startswith(f"{recording.name}: ") for note in notes)
    ]
    return _result(start, structure.free, problem, answer, doubt, recordings, iterations, notes)


@dataclass(frozen=True, eq=False)
class _Answer:
    """A maximum with the noise that it was weighed by, and its log-likelihood but for a constant."""

    outcome: Outcome
    noise: list[NoiseSpectrum]
    likelihood: float


def _from_prediction(problem: OutputError, state: State) -> tuple[State, dict[float, State], int]:
    """Where the search from prediction to simulation ended, where each memory before it did, and the steps it took.

    Prediction is left as soon as a simulation keeps step with the recordings: its search then ends where they are.
    """
    first, iterations = problem.predicting(_FIRST_MEMORY), 0
    state = settled(first, state)
    if not _simulates(first, state):
        raise BadInput("the model does not simulate with its start values; check signs and units of force and response")
    rungs: dict[float, State] = {}
    for memory in memories(problem.segments):
        if keeps_step(problem.segments, problem.residuals(state)):
            break
        outcome = problem.predicting(memory).search(state, tolerance=1.0, most=_EARLY_STEPS)
        state, iterations = outcome.state, iterations + outcome.iterations
        rungs[memory] = state
    if not _simulates(problem, state):
        return state, rungs, iterations
    outcome = problem.search(state, tolerance=1.0)
    return outcome.state, rungs, iterations + outcome.iterations


def _growing(segments: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Ever longer beginnings of the free segments, then the whole; forced ones are whole, their memory is short.

    The quiet end of a decay, where friction and preload rule, has a pace of its own: it is told once the rest is.
    """
    longest = max((s.n * s.dt * s.pace / (2 * np.pi) for s in segments if s.force is None), default=0.0)
    stages, cycles = [], _FIRST_CYCLES
    while cycles < longest:
        stages.append(tuple(_beginning(s, cycles) if s.force is None else s for s in segments))
        cycles *= _LONGER
    return [*stages, tuple(segments)]


def _beginning(segment: Segment, cycles: float) -> Segment:
    return segment.part(0, min(segment.n, int(cycles * 2 * np.pi / segment.pace / segment.dt)))


def memories(segments: Sequence[Segment]) -> list[float]:
    """Memories from prediction to simulation, in cycles, as far as the longest segment goes."""
    longest = max(s.n * s.dt * s.pace / (2 * np.pi) for s in segments)
    found = [_FIRST_MEMORY]
    while found[-1] * _GROWTH < longest:
        found.append(found[-1] * _GROWTH)
    return found


def keeps_step(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> bool:
    """Whether a simulation is so near to the recordings that its error is one of phase and size, and no turn of it.

    In every stretch of some cycles: the quiet end of a decay may have lost its phase where its loud beginning has not.
    """
    for segment, residual in zip(segments, residuals, strict=True):
        if not np.all(np.isfinite(residual)):
            return False
        count = max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi * _STRETCH)))
        noise = noise_level(segment.response, 1.0 / segment.dt)
        for measured, rest in zip(
            np.array_split(segment.response, count), np.array_split(residual, count), strict=True
        ):
            if np.sqrt(np.mean(rest**2)) > _IN_STEP * np.std(measured) + _BEYOND_NOISE * noise:
                return False
    return True


def _simulates(problem: OutputError, state: State) -> bool:
    return all(bool(np.all(np.isfinite(residual))) for residual in problem.residuals(state))


def _whitened(problem: OutputError, state: State, start: Oscillator) -> tuple[_Answer, int]:
    """The maximum with every frequency weighed by the noise that is left there, and the steps to it."""
    residuals, steps = problem.residuals(state), 0
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        nothing = np.zeros((len(problem.free), len(problem.free)))
        return _Answer(Outcome(state, np.inf, nothing, residuals, 0, False), [], -np.inf), 0
    noise = _noise(problem, residuals, state, start)
    outcome = problem.search(state, noise, tolerance=0.1)
    state, residuals, steps = outcome.state, outcome.residuals, outcome.iterations
    noise = _noise(problem, residuals, state, start)
    outcome = problem.search(state, noise, tolerance=1e-3)
    found = -0.5 * sum(s.log_determinant() for s in _noise(problem, outcome.residuals, outcome.state, start))
    return _Answer(outcome, noise, float(found)), steps + outcome.iterations


def _predictions(
    problem: OutputError, free: _Answer, rungs: Mapping[float, State], start: Oscillator
) -> tuple[list[tuple[float, _Answer]], int]:
    """The answer of each finite memory, the most likely first, and the steps to them."""
    found, steps = [], 0
    for memory in memories(problem.segments):
        state = replace(rungs.get(memory, free.outcome.state), offsets=free.outcome.state.offsets)
        answer, taken = _whitened(problem.predicting(memory), state, start)
        found.append((memory, answer))
        steps += taken
    return sorted(found, key=lambda pair: -pair[1].likelihood), steps


def _noise(
    problem: OutputError, residuals: Sequence[np.ndarray], state: State, start: Oscillator
) -> list[NoiseSpectrum]:
    values = dict(zip(start.parameters(), map(float, state.values), strict=True))
    return noise_of(problem.segments, residuals, values, start.response.quantity, problem.memory)


def _over_noise(
    problem: OutputError, answer: _Answer, start: Oscillator, recordings: Sequence[Recording]
) -> list[float]:
    """For each segment the rms of what is left over that of the noise."""
    values = dict(zip(start.parameters(), map(float, answer.outcome.state.values), strict=True))
    ratios = []
    for segment, residual in zip(problem.segments, answer.outcome.residuals, strict=True):
        recording = recordings[segment.recording]
        sensor = noise_level(np.asarray(recording.response, float), recording.fs)
        force = 0.0 if recording.force is None else noise_level(np.asarray(recording.force, float), recording.fs)
        level = expected_noise(segment, values, start.response.quantity, sensor, force)
        ratio = float(np.sqrt(np.mean(residual**2))) / level
        ratios.append(ratio if np.isfinite(ratio) else np.inf)
    return ratios


def _simulated(problem: OutputError, state: State) -> tuple[np.ndarray, ...]:
    """What the model leaves when it is simulated freely, from the initial states that suit that best."""
    alone = problem.predicting(FREE).keeping(state)
    state = settled(alone, replace(state, offsets=np.zeros(0)))
    if not _simulates(alone, state):
        return alone.residuals(state)
    return alone.search(state, tolerance=1.0, most=_EARLY_STEPS).residuals


def _result(
    start: Oscillator,
    names: tuple[str, ...],
    problem: OutputError,
    answer: _Answer,
    doubt: np.ndarray,
    recordings: Sequence[Recording],
    iterations: int,
    remarks: Sequence[str],
) -> Fit:
    outcome, noise = answer.outcome, answer.noise
    force_noise = [0.0 if r.force is None else noise_level(np.asarray(r.force, float), r.fs) for r in recordings]
    spread = scatter(problem, outcome.state, noise, [force_noise[s.recording] for s in problem.segments], _DRAWS)
    inverse, lost = _invert(outcome.information, problem.scale[list(problem.free)])
    doubt = doubt[list(problem.free)]  # two estimates of a right model differ by chance alone (Hausman 1978)
    covariance = inverse @ spread @ inverse + np.outer(doubt, doubt)  # Huber (1967): right where the weights are not
    errors = dict(zip(names, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    old = start.parameters()
    values = dict(zip(old, map(float, outcome.state.values), strict=True))
    identified = start.with_parameters(
        {name: replace(old[name], value=value, std=_std(name, names, lost, errors)) for name, value in values.items()}
    )
    free_run = outcome.residuals if problem.memory == FREE else _simulated(problem, outcome.state)
    fits = tuple(
        SegmentFit(segment, initial, segment.response - residual, _nrmse(residual, segment.response), ratio)
        for segment, initial, residual, ratio in zip(
            problem.segments,
            outcome.state.initial,
            free_run,
            _over_noise(problem, answer, start, recordings),
            strict=True,
        )
    )
    points = sum(segment.n for segment in problem.segments)
    log_likelihood = -outcome.cost - 0.5 * sum(s.log_determinant() for s in noise) - 0.5 * points * np.log(2 * np.pi)
    notes = [*remarks, *(f"{names[i]} is not identifiable from these recordings" for i in lost)]
    notes += _at_bounds(problem, outcome.state.values, names)
    if not outcome.converged:
        notes.append("the search for the maximum of the likelihood stopped at its limit of steps")
    return Fit(
        identified,
        names,
        covariance,
        float(log_likelihood),
        fits,
        tuple(noise),
        problem.memory,
        found_offsets(problem, outcome.state, outcome.residuals, noise),
        iterations,
        outcome.converged,
        tuple(notes),
    )


def _std(name: str, names: Sequence[str], lost: Sequence[int], errors: dict[str, float]) -> float | None:
    return None if name not in names or names.index(name) in lost or not errors[name] > 0 else float(errors[name])


def _nrmse(residual: np.ndarray, response: np.ndarray) -> float:
    spread = float(np.std(response))
    size = float(np.sqrt(np.mean(residual**2)))
    return size / spread if spread > 0 and np.isfinite(size) else np.inf


def _at_bounds(problem: OutputError, values: np.ndarray, names: Sequence[str]) -> list[str]:
    """One sentence for each parameter that the search wanted beyond its bound."""
    if problem.bounds is None:
        return []
    low, high = problem.bounds
    return [
        f"{name} came to rest at its bound ({values[place]:.4g}): the recordings ask for more than the law allows"
        for name, place in zip(names, problem.free, strict=True)
        if values[place] in (low[place], high[place])
    ]


def _invert(information: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Covariance, and which parameters the information does not reach."""
    size = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    lost = tuple(int(i) for i in np.flatnonzero(size * scale < 1e-6))
    return pseudo_inverse(information), lost
