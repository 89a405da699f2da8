"""The end of a fit: weighted by the noise, held against what predictions say, its standard errors.

Whatever searched before, a fit ends here, simulated as finely as a model is delivered. Where the model leaves more than
noise, its errors say so: they are those of what is left (Huber 1967), and what the most likely prediction finds
otherwise stands in them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...model.left import share_of_motion, times_the_noise
from ...recording.recording import Recording
from ..problem.data import Data
from ..problem.descent import MOST_STEPS, search
from ..problem.jumps import left_out, smooth_stretches
from ..problem.normal_equations import pseudo_inverse, without_information
from ..problem.offset import FoundOffset
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..problem.segments import Segment
from ..problem.settle import settled
from ..problem.structure import Structure
from ..signals.noise_spectrum import NoiseSpectrum, concentrated_likelihood
from ..signals.odds import ABOVE_NOISE, DECISIVE
from ..signals.registry import budget, numerics
from .choose_noise_model import plain_cost
from .from_prediction import EARLY_STEPS, keeps_step, memories, simulates
from .offsets import found_offsets, kept_offsets, zeros_of
from .reweighted_fit import (
    NEAR_ENOUGH,
    Answer,
    concentrated,
    finished,
    noise_alone,
    over_noise,
    reweighted,
    whitened,
    within_reach,
)
from .scatter import noise_on_forces, scatter

_UNSEEN = numerics(1e-6, "of the motion", why="what an unknown moves that the recordings do not carry")

_WHOLE = numerics(100.0, "typical sizes", why="a member as large as the force of inertia: what says nothing allows it")

_CUTS = budget(3, "times", why="what jumps is left out and the rest fitted anew, which may end where another jumps")
_DRAWS = numerics(60, "draws of force noise", why="standard errors are then good to 9 %")
_LAST_STEPS = budget(
    3, "steps", why="from where a coarser simulation has its maximum: each squares what is left of the way"
)


@dataclass(frozen=True, eq=False)
class SegmentFit:
    """How one segment came out.

    Attributes:
        segment: what was fitted.
        initial: (states,) displacement, velocity and inner states at its first sample.
        simulated: (n,) response, simulated freely, the sensor's offset in it.
        nrmse: rms(simulated - measured) / std(measured).
        over_noise: rms of the prediction errors over that of the noise: what the fit is judged by.
        noise: rms that noise alone leaves, in the response's unit.
    """

    segment: Segment
    initial: np.ndarray
    simulated: np.ndarray
    nrmse: float
    over_noise: float
    noise: float

    @property
    def left(self) -> np.ndarray:
        """(n,) what its simulation leaves."""
        return self.segment.response - self.simulated


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


def delivered(
    start: Oscillator,
    data: Data,
    fixed: Sequence[str] = (),
    *,
    initial: np.ndarray | None = None,
    memory: float = FREE,
    doubted: bool = True,
    compared: bool = False,
) -> Fit:
    """The fit next to where a search that compares structures has left it, simulated as finely as it is delivered.

    Such a search takes longer steps, and the force in fewer pieces: an error far below any noise, by which a parameter
    may yet be off by more than its standard error where a record is long and clean.

    Args:
        start: structure and values.
        data: the recordings of one rig, cut with ``coarse=False``.
        fixed: names of parameters that keep their values.
        initial: (segments, states) of each segment; None where they are to be found.
        memory: how far the model predicts, in cycles; see ``prediction``.
        doubted: see ``maximum_likelihood``.
        compared: see ``ended``.

    Raises:
        BadInput: where nothing in the recordings can be simulated.
    """
    recordings = data.recordings
    structure = Structure(start, data, fixed, zeros_of(data, recordings, start))
    problem = structure.problem.predicting(memory)
    state = structure.state(initial)
    if initial is None and memory == FREE:
        state = settled(problem, state)
    # what the sensors show at zero was taken off by that search, or it guesses here what the motion itself explains
    bare = replace(state, offsets=np.zeros_like(state.offsets))
    if plain_cost(problem.residuals(bare)) <= plain_cost(problem.residuals(state)):
        state = bare
    problem, state = kept_offsets(problem, state, start)
    how = {"doubted": doubted, "compared": compared, "most": _LAST_STEPS}
    return ended(problem, state, start, recordings, {}, np.inf, [], **how)


def ended(
    problem: OutputError,
    state: State,
    start: Oscillator,
    recordings: Sequence[Recording],
    rungs: Mapping[float, State],
    plain: float,
    notes: Sequence[str],
    *,
    doubted: bool = True,
    compared: bool = False,
    most: int = MOST_STEPS,
) -> Fit:
    """The fit from a place near it: weighted by the noise, and held against what predictions say.

    Args:
        problem: the model over the segments.
        state: its least squares.
        start: structure.
        recordings: of the segments.
        rungs: where the search came through each memory on its way to ``state``.
        plain: cost of a linear rig, which the answer must not exceed.
        notes: what a user should know.
        doubted: see ``maximum_likelihood``.
        compared: whether it is only compared with others: its errors are then those of the linearised response.
        most: steps that each search may take.
    """
    answer, iterations = reweighted(problem, state, start, recordings, plain, most)
    whole = problem.segments
    for cut in range(_CUTS if doubted else 0):  # what was smooth where the search came from may jump where it ended
        smooth, begun = smooth_stretches(problem, answer.outcome.state, tangent_alone=cut > 0)
        if smooth == problem.segments:
            break
        shorter = problem.over(smooth)
        without, steps = reweighted(shorter, begun, start, recordings, plain, most)
        iterations += steps
        if not np.isfinite(without.likelihood):  # at the reach of a spring that gives way it may run away from there
            break
        problem, answer, rungs = shorter, without, {}  # those are of other segments
    notes = [*notes, *left_out(whole, problem.segments, [recording.name for recording in recordings])]
    doubt, free_run = np.zeros(answer.outcome.state.values.size), answer.outcome.residuals
    in_step = keeps_step(problem.segments, answer.outcome.residuals)
    above = max(over_noise(problem, answer.outcome.residuals, answer.outcome.state, start, recordings)) > ABOVE_NOISE
    if above and not in_step:
        problem, answer, doubt, free_run, steps = _most_likely(problem.coarsely(), answer, rungs, start, plain, most)
        iterations += steps
    elif above and doubted:
        doubt, steps = _said_otherwise(problem.coarsely(), answer, rungs, start, most)
        iterations += steps
    if not np.isfinite(answer.likelihood):
        raise BadInput(
            "no model of this structure simulates along these recordings; check signs and units of force and response"
        )
    used = {segment.recording for segment in problem.segments}
    notes = [*notes] + [
        f"{recording.name}: nothing in it that could be fitted; it was left out"
        for i, recording in enumerate(recordings)
        if i not in used and not any(note.startswith(f"{recording.name}: ") for note in notes)
    ]
    names = tuple(name for i, name in enumerate(start.parameters()) if i in problem.free)
    draws = 0 if compared else _DRAWS
    return _result(start, names, problem, answer, doubt, free_run, recordings, iterations, notes, draws)


def _most_likely(
    problem: OutputError, free: Answer, rungs: Mapping[float, State], start: Oscillator, plain: float, most: int
) -> tuple[OutputError, Answer, np.ndarray, tuple[np.ndarray, ...], int]:
    """Where no simulation keeps step: the answer of the most likely memory with its problem, the doubt, what it leaves
    when it is simulated freely, and the steps.

    The simulation's stays where that one's free run is no better than a linear rig's, whose cost is ``plain``, and
    where the model runs away within every memory, as beyond the reach of a spring that gives way.
    """
    answers, steps = [], 0
    for memory in memories(problem.segments):
        predicting = problem.predicting(memory)
        begun = _nearest(predicting, rungs, free.outcome.state, start)
        answer, taken = whitened(predicting, begun, start, tolerance=NEAR_ENOUGH, most=most, informed=False)
        answers.append((memory, answer))
        steps += taken
    answers.sort(key=lambda pair: -pair[1].likelihood)
    memory, likeliest = answers[0]
    if not np.isfinite(likeliest.likelihood):
        return problem, free, np.zeros(free.outcome.state.values.size), free.outcome.residuals, steps
    likeliest, taken = finished(problem.predicting(memory), likeliest, start, most=most)
    steps += taken
    free_run = _simulated(problem, likeliest.outcome.state)
    if plain_cost(free_run) > plain:
        return problem, free, _apart(likeliest, free), free.outcome.residuals, steps
    doubt = _apart(answers[1][1], likeliest) if len(answers) > 1 else np.zeros(likeliest.outcome.state.values.size)
    return problem.predicting(memory), likeliest, doubt, free_run, steps


def _said_otherwise(
    problem: OutputError, answer: Answer, rungs: Mapping[float, State], start: Oscillator, most: int
) -> tuple[np.ndarray, int]:
    """(parameters,) by how much the most likely prediction differs from a simulation that keeps step, and the steps.

    0 where none is decisively more likely. One step of the linearised prediction tells how likely each memory becomes:
    none is searched where twice what that gains would not be decisive, and only those that promise to be the most
    likely, the first first.
    """
    begun = []
    for memory in memories(problem.segments):
        predicting = problem.predicting(memory)
        state = _nearest(predicting, rungs, answer.outcome.state, start)
        begun.append((*within_reach(predicting, state, start), predicting, state))
    likeliest, steps = answer, 0
    for here, there, predicting, state in sorted(begun, key=lambda one: -one[1]):
        least = answer.likelihood + DECISIVE if likeliest is answer else likeliest.likelihood
        if not (there > least or (likeliest is answer and here + 2.0 * (there - here) > least)):
            break
        other, taken = whitened(predicting, state, start, tolerance=NEAR_ENOUGH, most=most, informed=False)
        steps += taken
        if other.likelihood > least:
            likeliest = other
    return _apart(likeliest, answer), steps


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
    return search(alone, state, tolerance=1.0, most=EARLY_STEPS).residuals


def _result(
    start: Oscillator,
    names: tuple[str, ...],
    problem: OutputError,
    answer: Answer,
    doubt: np.ndarray,
    free_run: Sequence[np.ndarray],
    recordings: Sequence[Recording],
    iterations: int,
    remarks: Sequence[str],
    draws: int,
) -> Fit:
    outcome, noise = answer.outcome, answer.noise
    levels = noise_on_forces(problem, outcome.state, outcome.residuals, recordings)
    spread = scatter(
        problem.coarsely(), outcome.state, noise, levels, draws, remainders=answer.remainders, recordings=recordings
    )
    inverse, lost = _invert(outcome.information, problem.scale[list(problem.free)])
    sizes = np.maximum(np.abs(outcome.state.values), _WHOLE * problem.scale)[list(problem.free)]
    unseen = without_information(outcome.information)
    unseen = unseen / np.max(np.abs(unseen) / sizes[:, None], axis=0, initial=0.0)
    doubt = doubt[list(problem.free)]  # two estimates of a right model differ by chance alone (Hausman 1978)
    covariance = inverse @ spread @ inverse + np.outer(doubt, doubt)  # Huber (1967): right where the weights are not
    covariance = covariance + unseen @ unseen.T  # to where one of them is as large as can be
    errors = dict(zip(names, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    old = start.parameters()
    values = dict(zip(old, map(float, outcome.state.values), strict=True))
    identified = start.with_parameters(
        {name: replace(old[name], value=value, std=_std(name, names, lost, errors)) for name, value in values.items()}
    )
    levels = noise_alone(problem, outcome.state, start, recordings)
    fits = tuple(
        SegmentFit(
            segment,
            initial,
            segment.response - left,
            share_of_motion([left], [segment.response]),
            times_the_noise([residual], [noise_rms]),
            noise_rms,
        )
        for segment, initial, left, residual, noise_rms in zip(
            problem.segments, outcome.state.initial, free_run, outcome.residuals, levels, strict=True
        )
    )
    points = sum(segment.n for segment in problem.segments)
    log_likelihood = -outcome.cost + concentrated_likelihood(noise) - 0.5 * points * np.log(2 * np.pi)
    notes = [*remarks, *(f"{names[i]} is not identifiable from these recordings" for i in lost)]
    notes += [_together(names, direction) for direction in (np.abs(unseen) / sizes[:, None]).T]
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


def _together(names: Sequence[str], sizes: np.ndarray) -> str:
    """One sentence on parameters that stand for one another, by how much of its own size each moves."""
    *others, last = (name for name, size in zip(names, sizes, strict=True) if size * _WHOLE > 1)
    return (
        f"{', '.join(others)} and {last} cannot be distinguished: changed together they leave the simulation as it is, "
        "and the standard errors say so; fix what is known of them (--fix NAME=VALUE), or record a motion to either "
        "side of rest"
    )


def _at_bounds(problem: OutputError, values: np.ndarray, names: Sequence[str]) -> list[str]:
    """One sentence for each parameter that the search wanted beyond its bound."""
    if problem.bounds is None:
        return []
    low, high = problem.bounds
    return [
        f"{name} came to rest at its bound ({values[parameter]:.4g}): the recordings ask for more than the law allows"
        for name, parameter in zip(names, problem.free, strict=True)
        if values[parameter] in (low[parameter], high[parameter])
    ]


def _invert(information: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Covariance, and which parameters the information does not reach."""
    size = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    lost = tuple(int(i) for i in np.flatnonzero(size * scale < _UNSEEN))
    return pseudo_inverse(information), lost
