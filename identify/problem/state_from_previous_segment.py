"""What a stretch that begins at rest goes on with from the one before it: where friction holds the mass, what rings on.

An accelerometer shows neither, a displacement sensor the first. Both follow from the parameters, and are no unknowns of
their own: as such an attached mass as light as nothing could be thrown so far at the beginning of every stretch that it
makes up for anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..signals.registry import numerics
from .prediction import FREE
from .search_point import SHOWN, State
from .segments import Segment

if TYPE_CHECKING:
    from .output_error import OutputError

SPEED = numerics(1, "place", why="of the velocity among the states")


def goes_on(segment: Segment) -> bool:
    """Whether all of its beginning follows from the stretch before it: the mass rests, after it had moved."""
    return segment.rests and segment.after is not None


def shows_where(segment: Segment) -> bool:
    """Whether its sensor shows where the mass rests: a displacement that stands out of its noise is no rest."""
    return segment.quantity == "displacement"


def before(segments: Sequence[Segment]) -> dict[int, int]:
    """The segment before each, by their indices: one that ends where it begins or, where that rests, before it rested.

    None where that was left out, as where a part is asked for that the rest contradicts: the beginning is then as it
    was. A slide is cut into cycles so that what its model lacks does not add up: nothing is carried on there.
    """
    ends = {(segment.recording, segment.stop): i for i, segment in enumerate(segments) if not segment.slide}
    found = {}
    for i, segment in enumerate(segments):
        if segment.after is not None and (goes_on(segment) or segment.after == segment.start):
            found[i] = ends.get((segment.recording, segment.after))
    return {i: index for i, index in found.items() if index is not None}


def run_on(problem: OutputError, state: State, last: int, index: int) -> np.ndarray:
    """(states,) with which one segment begins where another had gone on to it, with nothing that drives it between."""
    core, segment = problem.core, problem.segments[index]
    between = segment.start - problem.segments[last].stop + 1
    begun = core.initial(problem.states(last, state)[-1])
    made = core.record(state.values, begun, None, between + 1, segment.dt, problem.max_step, states=True)
    return core.initial(made[-1])


def beginning(problem: OutputError, state: State, last: int, index: int) -> np.ndarray:
    """(states,) with which a segment that goes on begins, but for what it has to itself.

    The mass is known to rest: a model that moves there still by more than a hundredth of the motion, or ran away, says
    nothing of where, and begins in the middle.
    """
    segment = problem.segments[index]
    own = list(problem.free_states(segment))
    made = np.zeros(problem.core.states)
    if problem.core.states > SHOWN or not shows_where(segment):
        begun = run_on(problem, state, last, index)
        made = begun if abs(begun[SPEED]) <= problem.state_scale[SPEED] else made
    if shows_where(segment):
        made[:SHOWN] = 0.0
    made[own] = state.initial[index][own]
    return made


def continued_from_previous(problem: OutputError, state: State) -> State:
    """A point with those beginnings that follow from it."""
    if problem.memory != FREE:  # a prediction forgets
        return state
    chains: dict[int, list[tuple[int, int]]] = {}
    for index, last in before(problem.segments).items():
        if goes_on(problem.segments[index]):
            chains.setdefault(problem.segments[index].recording, []).append((last, index))
    if not chains:
        return state
    initial = state.initial.copy()

    def follow(chain: list[tuple[int, int]]) -> None:
        for last, index in chain:
            initial[index] = beginning(problem, replace(state, initial=initial), last, index)

    problem.map(follow, list(chains.values()))
    return replace(state, initial=initial)
