"""The search from prediction to simulation, and from the beginning of each decay to its end."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from ...errors import BadInput
from ..problem.descent import repeated, search
from ..problem.limits import FEWEST_SAMPLES
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..problem.search_point import Outcome
from ..problem.segments import Segment
from ..problem.settle import IN_STEP, follows, settled
from ..signals.registry import budget, numerics
from .limits import STRETCH

FIRST_MEMORY = numerics(1.0, "cycles", why="the memory with which a search from prediction to simulation begins")
_GROWTH = numerics(
    8.0, "times", why="by which it grows: a phase that is right to a radian at one memory is followed at the next"
)
_SHORTEST_MEMORY = numerics(1.0 / 64.0, "cycles", why="a tenth of a radian, over which any motion is a straight line")
_FIRST_CYCLES = numerics(12.0, "cycles", why="over which free decays are fitted first")
_LONGER = numerics(4.0, "times as many", why="over which they are fitted next")
_RESTS = numerics(1.0, "log-likelihood", why="what the next step promises where a search is over: half of it an error")
EARLY_STEPS = budget(8, "steps", why="at each memory: it only has to lead to the next")

_log = logging.getLogger(__name__)


class Maxima:
    """Where searches of one problem have ended, by the memory: another that comes there leads nowhere else."""

    def __init__(self) -> None:
        self._costs: dict[float, list[float]] = {}

    def add(self, memory: float, problem: OutputError, outcome: Outcome) -> None:
        """Keep where a search ended, over a cycle at least: less tells few of the parameters.

        Raises:
            BadInput: where another search had ended there.
        """
        if memory < FIRST_MEMORY:
            return
        known = self._costs.setdefault(memory, [])
        rests = _RESTS * repeated(problem.segments, outcome.residuals)  # as its search did
        if any(abs(outcome.cost - cost) <= rests for cost in known):
            raise BadInput("another start has converged here")
        known.append(outcome.cost)


def from_prediction(
    problem: OutputError, state: State, maxima: Maxima | None = None
) -> tuple[State, dict[float, State], int]:
    """Where the search from prediction to simulation ended, where each memory before it did, and the steps it took.

    Prediction is left as soon as a simulation keeps step with the recordings: its search then ends where they are.

    Raises:
        BadInput: where nothing simulates from the start, or it leads to one of the maxima.
    """
    maxima = maxima or Maxima()
    free = settled(problem, state)
    if keeps_step_throughout(problem.segments, problem.residuals(free)):
        return _searched(problem, free, {}, 0, maxima)
    first, predicted = _followed(problem, state)
    if predicted is not None:
        state = predicted
    elif simulates(problem, free):  # what a prediction corrects may push it over the top of its spring
        return _searched(problem, free, {}, 0, maxima)
    else:
        raise BadInput("the model does not simulate with its start values; check signs and units of force and response")
    rungs: dict[float, State] = {}
    iterations = 0
    for memory in memories(problem.segments, first):
        if keeps_step_throughout(problem.segments, problem.residuals(state)):
            break
        outcome = search(problem.predicting(memory), state, tolerance=_RESTS, most=EARLY_STEPS)
        maxima.add(memory, problem, outcome)
        state, iterations = outcome.state, iterations + outcome.iterations
        rungs[memory] = state
        _log.info("predicted with a memory of %g cycles: %d steps", memory, outcome.iterations)
    if not simulates(problem, state):
        return state, rungs, iterations
    return _searched(problem, state, rungs, iterations, maxima)


def _followed(problem: OutputError, state: State) -> tuple[float, State | None]:
    """The longest memory, of a cycle at most, over which a start predicts the motion, and its initial states there.

    The shortest over which it predicts anything where none is so short; None where no prediction runs to its end.
    """
    found: tuple[float, State | None] = (FIRST_MEMORY, None)
    memory = FIRST_MEMORY
    while memory >= _SHORTEST_MEMORY:
        predicting = problem.predicting(memory)
        begun = settled(predicting, state)
        residuals = predicting.residuals(begun)
        if all(bool(np.all(np.isfinite(residual))) for residual in residuals):
            found = memory, begun
            if keeps_step(problem.segments, residuals):
                break
        memory /= _GROWTH
    return found


def _searched(
    problem: OutputError, state: State, rungs: dict[float, State], iterations: int, maxima: Maxima
) -> tuple[State, dict[float, State], int]:
    outcome = search(problem, state, tolerance=_RESTS)
    maxima.add(FREE, problem, outcome)
    _log.info("simulated: %d steps", outcome.iterations)
    return outcome.state, rungs, iterations + outcome.iterations


def growing(segments: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Ever longer beginnings of the free segments, then the whole; forced ones are whole, their memory is short.

    The quiet end of a decay, where friction and preload rule, has a pace of its own: it is fitted once the rest is.
    """
    longest = max((s.n * s.dt * s.pace / (2 * np.pi) for s in segments if s.force is None), default=0.0)
    stages, cycles = [], _FIRST_CYCLES
    while cycles < longest:
        stages.append(tuple(_beginning(s, cycles) if s.force is None else s for s in segments))
        cycles *= _LONGER
    return [*stages, tuple(segments)]


def _beginning(segment: Segment, cycles: float) -> Segment:
    count = int(cycles * 2 * np.pi / segment.pace / segment.dt)
    return segment.part(0, min(segment.n, max(count, FEWEST_SAMPLES)))  # a model may be far too fast for the recorder


def memories(segments: Sequence[Segment], first: float = FIRST_MEMORY) -> list[float]:
    """Memories from prediction to simulation, in cycles, as far as the longest segment goes."""
    longest = max(s.n * s.dt * s.pace / (2 * np.pi) for s in segments)
    ladder = [first]
    while ladder[-1] * _GROWTH < longest:
        ladder.append(ladder[-1] * _GROWTH)
    return ladder


def keeps_step(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> bool:
    """Whether a simulation is so near to the motion, all of it together, that its error is one of phase and size."""
    power = [float(np.sum((s.response - np.mean(s.response)) ** 2)) for s in segments]
    missed = [float(np.sum(residual**2)) for residual in residuals]
    return bool(np.isfinite(sum(missed)) and sum(missed) < IN_STEP**2 * sum(power))


def keeps_step_throughout(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> bool:
    """Whether it does so in every stretch of some cycles: the quiet end of a decay may have lost its phase early."""
    for segment, residual in zip(segments, residuals, strict=True):
        if not np.all(np.isfinite(residual)):
            return False
        count = max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi * STRETCH)))
        for measured, rest in zip(
            np.array_split(segment.response, count), np.array_split(residual, count), strict=True
        ):
            if not follows(float(np.sqrt(np.mean(rest**2))), measured, segment.noise):
                return False
    return True


def simulates(problem: OutputError, state: State) -> bool:
    """Whether every segment is simulated to its end."""
    return all(bool(np.all(np.isfinite(residual))) for residual in problem.residuals(state))
