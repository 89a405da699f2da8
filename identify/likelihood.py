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

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..model import Oscillator
from ..recording.recording import Recording
from .climb import best_climb, from_near, nrmse_of
from .data import Data, data_of
from .from_prediction import EARLY_STEPS, from_prediction, keeps_step, memories, simulates
from .jumps import left_out, smooth_stretches
from .noise_spectrum import NoiseSpectrum, concentrated_likelihood
from .normal_equations import pseudo_inverse
from .offset import FoundOffset
from .offsets import found_offsets, kept_offsets, zeros_of
from .output_error import OutputError, State
from .plainest import linear_state, plain_cost
from .prediction import FREE
from .scatter import scatter
from .segments import Segment
from .settle import settled
from .signals import noise_levels
from .structure import Structure
from .weighed import ABOVE_NOISE, Answer, concentrated, over_noise, weighed, whitened

#: Simulation is given up for prediction where that is a thousand times as likely.
_DECISIVE = float(np.log(1000.0))
#: Gain of log-likelihood at which the search for what a prediction says otherwise is over: a seventh of an error.
_NEAR_ENOUGH = 0.01
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
    start: Oscillator,
    recordings: Sequence[Recording],
    fixed: Sequence[str] = (),
    data: Data | None = None,
    *,
    doubted: bool = True,
    near: bool = False,
    others: Callable[[], Iterable[Oscillator]] = tuple,
) -> Fit:
    """Find the parameters of ``start``'s structure that make the recordings most likely.

    Args:
        start: structure, with any laws of the library, and start values; ``mass`` None where no recording has a force.
        recordings: of one rig, all of the same quantity.
        fixed: names of parameters that keep their values.
        data: the recordings as they are fitted, where they have been cut before.
        doubted: whether a simulation that keeps step is held against predictions, for the standard errors, and its
            search ended by simulations as they are delivered; fits that are only compared need neither.
        near: whether ``start`` was found from these very recordings: then nothing has to lead to it, and where it keeps
            step no linear rig is asked for.
        others: more models of the same structure to start from, asked for where the first explains little.

    Raises:
        BadInput: where nothing in the recordings can be simulated.
    """
    data = data or data_of(recordings, start, coarse=False)
    structure = Structure(start, data, fixed, zeros_of(data, recordings, start))
    problem = structure.problem.coarsely()
    climb = from_near(problem, structure.state(None)) if near else None
    near = climb is not None and keeps_step(problem.segments, problem.residuals(climb.state))
    climb = climb or best_climb(problem, structure.state(None), others)
    told, free, rungs, iterations = climb.problem, climb.state, climb.rungs, climb.iterations
    notes = [] if climb.whole else [_beyond(told.segments, problem.segments, recordings)]
    problem, free = kept_offsets(told, free, start)
    if any(offset.channel == "drift" for offset in problem.offsets):
        try:
            free, rungs, steps = from_prediction(problem, free)  # what drifted may have led the search astray
            iterations += steps
        except BadInput:  # with that taken off nothing simulates: it was the model's lack and no drift
            problem, free = _without_drift(problem, free)
    plain, steps = np.inf, 0
    if not near:
        free, plain, steps = _beside_linear(problem, free, start, recordings)
    iterations += steps
    smooth, begun = smooth_stretches(problem, free)
    jumps = left_out(problem.segments, smooth, [recording.name for recording in recordings])
    notes += jumps
    if jumps:
        problem = problem.over(smooth)  # what has no derivative may have held the search back
        free, rungs, steps = from_prediction(problem, begun)
        iterations += steps
        free, plain, steps = _beside_linear(problem, free, start, recordings)
        iterations += steps
    problem = problem.coarsely(not doubted)
    answer, steps = weighed(problem, free, start, recordings, plain)
    iterations += steps
    doubt = np.zeros(answer.outcome.state.values.size)
    in_step = keeps_step(problem.segments, answer.outcome.residuals)
    above = max(over_noise(problem, answer.outcome.residuals, answer.outcome.state, start, recordings)) > ABOVE_NOISE
    if above and not in_step:
        problem, answer, doubt, steps = _most_likely(problem.coarsely(), answer, rungs, start, plain)
        iterations += steps
    elif above and doubted:
        doubt, steps = _said_otherwise(problem.coarsely(), answer, rungs, start)
        iterations += steps
    if not np.isfinite(answer.likelihood):
        raise BadInput(
            "no model of this structure simulates along these recordings; check signs and units of force and response"
        )
    used = {segment.recording for segment in problem.segments}
    notes += [
        f"{recording.name}: nothing in it that could be fitted; it was left out"
        for i, recording in enumerate(recordings)
        if i not in used and not any(note.startswith(f"{recording.name}: ") for note in notes)
    ]
    return _result(start, structure.free, problem, answer, doubt, recordings, iterations, notes)


def _without_drift(problem: OutputError, state: State) -> tuple[OutputError, State]:
    """The problem and the point of its search without the drift of any sensor."""
    kept = [place for place, offset in enumerate(problem.offsets) if offset.channel != "drift"]
    return problem.with_offsets([problem.offsets[place] for place in kept]), replace(state, offsets=state.offsets[kept])


def _beside_linear(
    problem: OutputError, state: State, start: Oscillator, recordings: Sequence[Recording]
) -> tuple[State, float, int]:
    """The simulation beside the best linear rig's, which it must not leave more than; that one's cost, and the steps.

    Only where more than noise is left: else there is nothing better. Nor is there where no parameter is free.
    """
    if not problem.free:
        return state, np.inf, 0
    residuals = problem.residuals(state)
    if max(over_noise(problem, residuals, state, start, recordings)) <= ABOVE_NOISE:
        return state, np.inf, 0
    plain = linear_state(problem, state, start)
    if plain is None:
        return state, np.inf, 0
    cost = plain_cost(problem.residuals(plain))
    if not cost < plain_cost(residuals):
        return state, cost, 0
    outcome = problem.search(plain, tolerance=1.0)
    return outcome.state, cost, outcome.iterations


def _beyond(told: Sequence[Segment], whole: Sequence[Segment], recordings: Sequence[Recording]) -> str:
    """Which ends of decays no model of the structure was found to simulate."""
    ends = [
        f"{recordings[part.recording].name} from {part.time + part.n * part.dt:.4g} s"
        for part, all_of_it in zip(told, whole, strict=True)
        if part.n < all_of_it.n
    ]
    return (
        f"no model of this structure that tells the beginning simulates the end of {', '.join(ends)}; it was left out"
    )


def _most_likely(
    problem: OutputError, free: Answer, rungs: Mapping[float, State], start: Oscillator, plain: float
) -> tuple[OutputError, Answer, np.ndarray, int]:
    """Where no simulation keeps step: the answer of the most likely memory with its problem, the doubt, the steps.

    The simulation's stays where that one's free run is no better than a linear rig's, whose cost is ``plain``.
    """
    answers, steps = [], 0
    for memory in memories(problem.segments):
        predicting = problem.predicting(memory)
        answer, taken = whitened(predicting, _nearest(predicting, rungs, free.outcome.state, start), start)
        answers.append((memory, answer))
        steps += taken
    answers.sort(key=lambda pair: -pair[1].likelihood)
    memory, likeliest = answers[0]
    if plain_cost(_simulated(problem, likeliest.outcome.state)) > plain:
        return problem, free, _apart(likeliest, free), steps
    return problem.predicting(memory), likeliest, _apart(answers[min(1, len(answers) - 1)][1], likeliest), steps


def _said_otherwise(
    problem: OutputError, answer: Answer, rungs: Mapping[float, State], start: Oscillator
) -> tuple[np.ndarray, int]:
    """(parameters,) by how much the most likely prediction differs from a simulation that keeps step, and the steps.

    0 where none is decisively more likely.
    """
    predicted, steps = [], 0
    for memory in memories(problem.segments):
        predicting = problem.predicting(memory)
        state = _nearest(predicting, rungs, answer.outcome.state, start)
        other, taken = whitened(predicting, state, start, tolerance=_NEAR_ENOUGH, informed=False)
        predicted.append(other)
        steps += taken
    likeliest = max(predicted, key=lambda other: other.likelihood)
    decisive = likeliest.likelihood > answer.likelihood + _DECISIVE
    return _apart(likeliest, answer if decisive else likeliest), steps


def _nearest(problem: OutputError, rungs: Mapping[float, State], state: State, start: Oscillator) -> State:
    """Where a memory's search begins: where the search came through it on its way to ``state``, or there."""
    points = [state]
    if problem.memory in rungs:
        points.append(replace(rungs[problem.memory], offsets=state.offsets))
    return max(points, key=lambda point: concentrated(problem, point, start))


def _apart(answer: Answer, other: Answer) -> np.ndarray:
    return answer.outcome.state.values - other.outcome.state.values


def _simulated(problem: OutputError, state: State) -> tuple[np.ndarray, ...]:
    """What the model leaves when it is simulated freely, from the initial states that suit that best."""
    alone = problem.predicting(FREE).keeping(state)
    state = settled(alone, replace(state, offsets=np.zeros(0)))
    if not simulates(alone, state):
        return alone.residuals(state)
    return alone.search(state, tolerance=1.0, most=EARLY_STEPS).residuals


def _result(
    start: Oscillator,
    names: tuple[str, ...],
    problem: OutputError,
    answer: Answer,
    doubt: np.ndarray,
    recordings: Sequence[Recording],
    iterations: int,
    remarks: Sequence[str],
) -> Fit:
    outcome, noise = answer.outcome, answer.noise
    levels = [noise_levels(recordings[s.recording])[1] for s in problem.segments]
    spread = scatter(problem.coarsely(), outcome.state, noise, levels, _DRAWS, remainders=answer.remainders)
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
        SegmentFit(segment, initial, segment.response - residual, nrmse_of(residual, segment.response), ratio)
        for segment, initial, residual, ratio in zip(
            problem.segments,
            outcome.state.initial,
            free_run,
            over_noise(problem, outcome.residuals, outcome.state, start, recordings),
            strict=True,
        )
    )
    points = sum(segment.n for segment in problem.segments)
    log_likelihood = -outcome.cost + concentrated_likelihood(noise) - 0.5 * points * np.log(2 * np.pi)
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
        found_offsets(problem, outcome.state, outcome.residuals, answer.remainders or noise),
        iterations,
        outcome.converged,
        tuple(notes),
    )


def _std(name: str, names: Sequence[str], lost: Sequence[int], errors: dict[str, float]) -> float | None:
    return None if name not in names or names.index(name) in lost or not errors[name] > 0 else float(errors[name])


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
