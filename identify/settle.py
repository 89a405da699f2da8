"""Initial states found by themselves, before the parameters are searched for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..simulate.core import STEPS_PER_PERIOD
from .output_error import OutputError, State
from .reach import nearest_reach

#: The sizes of the motion, in those of the finite differences (a hundredth of it).
_SIZES = 100.0


def settled(problem: OutputError, state: State, cycles: float = 3.0) -> State:
    """Better initial states from the first few cycles of each segment, the parameters as they are."""
    rate = max(2 * np.pi / (problem.max_step * STEPS_PER_PERIOD), np.finfo(float).tiny)
    initial = state.initial.copy()
    for i, segment in enumerate(problem.segments):
        own = problem.own(segment)
        if not own:
            continue
        n = int(np.clip(cycles / rate / segment.dt * 2 * np.pi, 8, segment.n))

        def misfit(candidate: np.ndarray, i: int = i, n: int = n) -> float:
            return float(np.sum((problem.segments[i].response[:n] - response(candidate, i, n)) ** 2))

        def response(candidate: np.ndarray, i: int = i, n: int = n) -> np.ndarray:
            moved = initial.copy()
            moved[i] = candidate
            return problem.simulate(i, replace(state, initial=moved), n)

        initial[i] = nearest_reach(initial[i], problem.core.reaches(state.values), own, misfit)
        for _ in range(4):
            base = response(initial[i])
            rows = []
            for k in own:
                moved = initial[i].copy()
                moved[k] += problem.state_scale[k]
                rows.append((response(moved) - base) / problem.state_scale[k])
            jacobian = np.array(rows).T
            residual = segment.response[:n] - base
            if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
                break
            # a step by the size of the motion costs as much as what is left, or the far side of a curved valley would
            # be reached at once; the nearer the motion is, the less it costs
            size = _SIZES * problem.state_scale[list(own)]
            ridge = float(np.linalg.norm(residual)) * np.eye(len(own))
            stacked = np.vstack([jacobian * size, ridge]), np.append(residual, np.zeros(len(own)))
            trial = initial[i].copy()
            trial[list(own)] += np.linalg.lstsq(*stacked)[0] * size
            after = segment.response[:n] - response(trial)
            if not np.sum(after**2) < np.sum(residual**2):
                break
            initial[i] = trial
    return replace(state, initial=initial)
