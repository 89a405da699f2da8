"""The way up to a simulation: from prediction over a cycle, and from the beginnings of decays to their ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...model.left import share_of_motion
from ..problem.descent import search
from ..problem.output_error import OutputError, State
from ..problem.settle import settled
from ..signals.registry import numerics
from .from_prediction import Maxima, from_prediction, growing, simulates
from .limits import POOR_NRMSE, QUIET

_NOTHING_TOLD = numerics(1e3, "times the motion", why="what runs away has explained nothing, however far it ran")


@dataclass(frozen=True, eq=False)
class Climb:
    """Where a search came to from prediction and the beginnings of decays.

    ``problem`` is over what it tells, ``whole`` whether that is all, ``lost`` whether some stretch is hardly explained;
    ``log_nrmse`` is the mean logarithm of what it leaves of each segment's motion, weighted by length: of what it does
    not tell, all of it.
    """

    problem: OutputError
    state: State
    rungs: Mapping[float, State]
    iterations: int
    whole: bool
    log_nrmse: float
    lost: bool


def best_climb(problem: OutputError, start: State, others: Callable[[], Iterable[Oscillator]]) -> Climb:
    """The climb from the first start; where that explains little, the best of all of them.

    Where a further effect bends the estimates, their cubic and preload lead astray first. Raises BadInput where none
    simulates.
    """
    climbs: list[Climb] = []
    problems: list[BadInput] = []
    maxima = Maxima()

    def tried(state: State) -> None:
        try:
            climbs.append(_climbed(problem, state, maxima))
        except BadInput as why:
            problems.append(why)

    tried(start)
    if not climbs or climbs[0].lost or not climbs[0].whole:
        for other in others():
            tried(replace(start, values=np.array(list(other.values().values()))))
    if not climbs:
        raise problems[0]
    return min(climbs, key=lambda climb: climb.log_nrmse)


def from_near(problem: OutputError, state: State) -> Climb | None:
    """The maximum next to a start; None where that does not simulate."""
    state = settled(problem, state)
    if not simulates(problem, state):
        return None
    outcome = search(problem, state, tolerance=1.0)
    return Climb(problem, outcome.state, {}, outcome.iterations, True, 0.0, False)


def _climbed(problem: OutputError, state: State, maxima: Maxima) -> Climb:
    first, *later = growing(problem.segments)
    stage_problem, whole = problem.over(first), True
    state, rungs, iterations = from_prediction(stage_problem, state, maxima)
    for stage in later:
        try:
            state, rungs, steps = from_prediction(problem.over(stage), state)
        except BadInput:  # what remains is at rest, say, where these values push the mass away
            whole = False
            break
        stage_problem, iterations = problem.over(stage), iterations + steps
    ratios = np.array(
        [
            share_of_motion([residual], [segment.response])
            for residual, segment in zip(stage_problem.residuals(state), stage_problem.segments, strict=True)
        ]
    )
    loud = [float(np.std(segment.response)) for segment in stage_problem.segments]
    size = [segment.n for segment in stage_problem.segments]
    left = np.log(np.clip(ratios, np.finfo(float).tiny, _NOTHING_TOLD))
    log_nrmse = float(np.sum(left * size)) / sum(segment.n for segment in problem.segments)
    lost = bool(np.any((ratios > POOR_NRMSE) & (np.array(loud) >= QUIET * max(loud))))
    return Climb(stage_problem, state, rungs, iterations, whole, log_nrmse, lost)
