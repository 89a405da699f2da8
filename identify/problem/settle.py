"""Initial states found by themselves, before the parameters are searched for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...model.fit_state import FOLLOWS
from ...simulate.core import STEPS_PER_PERIOD
from ..signals.odds import SIGNIFICANT
from ..signals.registry import budget, numerics
from .limits import FEWEST_SAMPLES
from .output_error import OutputError, State
from .prediction import FREE
from .search_point import SHOWN
from .segments import Segment
from .state_from_previous_segment import before, beginning, goes_on, run_on
from .state_limits import nearest_reach

#: A simulation keeps step where it leaves less than this part of each motion ...
IN_STEP = FOLLOWS
_SIZES = numerics(100.0, "sizes of the finite differences", why="a hundredth of the motion each")
_FIRST = numerics(0.25, "cycles", why="that are asked first where the beginning is lost")
_LONGER = numerics(2**0.5, "times", why="as many cycles are asked next: the phase is then still one")
_STEPS = budget(8, "steps", why="of Gauss and Newton, each of two runs of a few cycles")


def follows(left: float, measured: np.ndarray, noise: float) -> bool:
    """Whether what a simulation leaves, rms, of a motion (n,) is an error of phase and size, beside that noise."""
    return bool(left <= IN_STEP * float(np.std(measured)) + SIGNIFICANT * noise)


def settled(problem: OutputError, state: State, cycles: float = 3.0) -> State:
    """Better initial states from the first few cycles of each segment, the parameters as they are.

    Where these are lost, as where a pendulum is begun a little too fast and goes over the top, the first quarter of a
    cycle is asked first, and ever longer beginnings from there. States that no sensor shows, as those of an attached
    mass, are those with which the stretch before it ended, where there is one and these do better; at rest they follow
    from it (``state_from_previous_segment``). A prediction forgets what came before.
    """
    cycle = problem.max_step * STEPS_PER_PERIOD
    initial = state.initial.copy()
    last = before(problem.segments) if problem.memory == FREE else {}
    for i, segment in enumerate(problem.segments):
        free = problem.free_states(segment)
        if i in last and goes_on(segment):
            initial[i] = beginning(problem, replace(state, initial=initial), last[i], i)
        if not free:
            continue
        begun = _Beginning(problem, replace(state, initial=initial.copy()), i, free)
        whole = _samples(segment, cycles * cycle)
        start = initial[i]
        if i in last and not segment.rests and problem.core.states > SHOWN:
            handed = run_on(problem, replace(state, initial=initial), last[i], i)
            start = min(start, handed, key=lambda candidate: begun.misfit(candidate, whole))
        found = begun.settled(start, whole)
        if not begun.in_step(found, whole):
            grown, part = start, _FIRST
            while part < cycles:
                grown, part = begun.settled(grown, _samples(segment, part * cycle)), part * _LONGER
            grown = begun.settled(grown, whole)
            found = grown if begun.in_step(grown, whole) else found
        initial[i] = found
    return replace(state, initial=initial)


def _samples(segment: Segment, time: float) -> int:
    """How many samples of a segment such a time (s) holds."""
    return int(np.clip(time / segment.dt, FEWEST_SAMPLES, segment.n))


class _Beginning:
    """One segment's beginning, simulated from initial states of its own.

    Args:
        problem: all segments.
        state: parameters and initial states of all.
        index: of the segment.
        free: which of its states may be moved.
    """

    def __init__(self, problem: OutputError, state: State, index: int, free: Sequence[int]) -> None:
        self.problem, self.state, self.index, self.free = problem, state, index, list(free)
        self.measured = problem.segments[index].response

    def in_step(self, candidate: np.ndarray, n: int) -> bool:
        """Whether what (states,) leaves of the first n samples is one of phase and size, apart from noise and zero."""
        measured, noise = self.measured[:n], self.problem.segments[self.index].noise
        with np.errstate(over="ignore", invalid="ignore"):  # a motion that ran away
            left = float(np.std(measured - self._response(candidate, n)))
        return follows(left, measured, noise)

    def misfit(self, candidate: np.ndarray, n: int) -> float:
        """Sum of squares that (states,) leaves of the first n samples; inf where that does not simulate."""
        with np.errstate(over="ignore", invalid="ignore"):  # a motion that ran away
            left = float(np.sum((self.measured[:n] - self._response(candidate, n)) ** 2))
        return left if np.isfinite(left) else np.inf

    def settled(self, start: np.ndarray, n: int) -> np.ndarray:
        """(states,) as the first n samples ask for them next to a start."""
        free, scale = self.free, self.problem.state_scale[self.free]
        reaches = self.problem.core.reaches(self.state.values)
        initial = nearest_reach(start, reaches, free, lambda candidate: self.misfit(candidate, n))
        for _ in range(_STEPS):
            base, rows = self._derived(initial, n)
            jacobian = rows.T
            residual = self.measured[:n] - base
            if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
                break
            # a step by the size of the motion costs as much as what is left, or the far side of a curved valley would
            # be reached at once; the nearer the motion is, the less it costs
            size = _SIZES * scale
            ridge = float(np.linalg.norm(residual)) * np.eye(len(free))
            stacked = np.vstack([jacobian * size, ridge]), np.append(residual, np.zeros(len(free)))
            trial = initial.copy()
            trial[free] += np.linalg.lstsq(*stacked)[0] * size
            if not self.misfit(trial, n) < np.sum(residual**2):
                break
            initial = trial
        return initial

    def _begun(self, candidate: np.ndarray) -> State:
        moved = self.state.initial.copy()
        moved[self.index] = candidate
        return replace(self.state, initial=moved)

    def _response(self, candidate: np.ndarray, n: int) -> np.ndarray:
        return self.problem.simulate(self.index, self._begun(candidate), n)

    def _derived(self, candidate: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
        """(n,) response, and (own, n) its derivatives by the initial states that may be moved."""
        shared = self.problem.shared
        rows = np.zeros((shared + self.problem.core.states, n))
        unknowns = [shared + k for k in self.free]
        return self.problem.carry(self.index, self._begun(candidate), unknowns, rows), rows[unknowns]
