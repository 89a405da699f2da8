"""The last swings of a decay, which its envelope hides in the noise and a model tells apart.

A decay ends where its envelope meets the noise, since nothing else is known before a model is. How far the mass swings
on is what dry friction and damping are known by best: of a decay that ends at twice the noise, to a half more error
than is possible. So once a model leaves no more than noise, its decays go on to where *its* motion is half of that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...recording.recording import Recording
from ..signals.odds import BEYOND_ERRORS, is_noise
from ..signals.signals import response_of
from .limits import STANDS_OUT
from .output_error import OutputError, State
from .prediction import FREE
from .segments import Segment, blank_of


def with_last_swings(problem: OutputError, state: State, recordings: Sequence[Recording]) -> tuple[Segment, ...]:
    """The segments, decays longer by the swings that stand out of the noise in the model alone.

    Only where the model leaves noise of the decay, where that had come down to the noise, and where what it goes on
    over is the model's motion and noise too: not where the mass was caught.

    Args:
        problem: the model over the segments, simulated.
        state: its least squares.
        recordings: of the segments.
    """
    if problem.memory != FREE:
        return problem.segments
    residuals = problem.residuals(state)
    return tuple(
        segment if segment.force is not None else _longer(problem, i, state, residuals[i], recordings)
        for i, segment in enumerate(problem.segments)
    )


def _longer(
    problem: OutputError, i: int, state: State, residual: np.ndarray, recordings: Sequence[Recording]
) -> Segment:
    """One decay as it goes on; as it was where it does not."""
    segment = problem.segments[i]
    recording, noise = recordings[segment.recording], segment.noise
    stop = min(
        (s.start for s in problem.segments if s.recording == segment.recording and s.start >= segment.stop),
        default=recording.n,
    )
    stop = min([stop, segment.stop + segment.n, *(a for a, _ in recording.unknown if a >= segment.stop)])
    if stop == segment.stop or not noise > 0 or not _is_noise(residual, noise):
        return segment
    if float(np.std(segment.response[-segment.cycle :])) > BEYOND_ERRORS * noise:
        return segment
    response = response_of(recording).part(segment.start, stop).samples
    whole = replace(segment, stop=stop, response=response, blank=blank_of(recording)[segment.start : stop])
    made = problem.over([whole]).simulate(0, replace(state, initial=state.initial[[i]]))
    if not np.all(np.isfinite(made)):
        return segment
    stands_out = np.flatnonzero(np.abs(made - made[-1]) > STANDS_OUT * noise)
    end = max(segment.n, int(stands_out[-1]) + 1 if stands_out.size else 0)
    if end == segment.n or not _is_noise((response - made)[segment.n : end], noise):
        return segment
    return whole.part(0, end)


def _is_noise(residual: np.ndarray, noise: float) -> bool:
    return is_noise(np.array([np.mean(residual**2) / noise**2]), np.array([float(residual.size)]))
