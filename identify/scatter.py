"""How far noise scatters the score of a fit: what its standard errors stand on."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..recording.recording import Recording
from ..simulate.force import Force
from .descent import in_lines
from .equivalent import equivalent
from .noise_spectrum import NoiseSpectrum
from .normal_equations import pseudo_inverse, shared_information
from .output_error import OutputError, State
from .rounding import scatter_of_rounding
from .segments import Segment

#: What noise does to a rig is forgotten by a factor e in one time constant of its damping. In stretches of so many it
#: scatters the score independently but for what reaches over their ends, a thirtieth of the variance.
_FORGOTTEN = 30.0
#: Draws between two looks at whether they are enough.
_AT_ONCE = 4


def scatter(
    problem: OutputError,
    state: State,
    noise: Sequence[NoiseSpectrum],
    force_noise: Sequence[float],
    draws: int,
    seed: int = 0,
    remainders: Sequence[NoiseSpectrum] | None = None,
    recordings: Sequence[Recording] = (),
) -> np.ndarray:
    """(k, k) scatter of the free parameters' score, force noise passed through the model as it is.

    The spectrum takes that noise for stationary, which it is not: a rig answers differently at each amplitude of a
    sweep. So the noise is drawn, simulated, and weighed as the fit weighs the residual.

    Args:
        problem: what was fitted.
        state: the maximum of the likelihood.
        noise: spectra that the fit weighed by.
        force_noise: standard deviation of the force noise of each segment (0: none).
        draws: as good as so many of a whole segment; of a long one fewer are, for its stretches are draws of their own.
        seed: of the random numbers.
        remainders: spectra of what is left, where the fit weighed by others and the model leaves more than noise.
        recordings: of the segments, where what a converter of few levels did to them is to be counted in.
    """
    if not problem.free:
        return np.zeros((0, 0))  # nothing but zeros or initial states is to be found: no score, and no need to draw
    residuals = problem.residuals(state)
    derivatives = problem.derivatives(state, residuals)
    in_lines(problem, derivatives, noise)
    shared, free = problem.shared, len(problem.free)
    total, blocks = np.zeros((shared, shared)), []
    for i, segment in enumerate(problem.segments):
        lines = derivatives[i]
        normal = lines @ lines.T
        blocks.append((normal, np.zeros(lines.shape[0])))
        projected = lines[:shared]
        projected -= normal[:shared, shared:] @ pseudo_inverse(normal[shared:, shared:]) @ lines[shared:]
        force = problem.force(segment) if force_noise[i] else None
        informed = projected @ projected.T
        if remainders is None:
            for k, row in enumerate(projected):
                total[k] += projected @ (row if force is None else noise[i].of_sensor(row))
        if remainders is None and force is None and not recordings:
            continue
        weighed = projected
        for k, row in enumerate(projected):
            weighed[k] = noise[i].whitened_twice(row)
        base = segment.response - residuals[i]
        if recordings:
            total += scatter_of_rounding(problem, state, i, weighed, base, recordings, draws, seed)
        if remainders is not None:
            coloured = remainders[i].colour(weighed)
            total += coloured @ coloured.T
        elif force is not None:
            drawn = _of_force(problem, state, i, force, force_noise[i], weighed, base, draws, seed)
            total += informed if drawn is None else drawn
    if shared == free:
        return total
    normal = shared_information(blocks, shared)  # the parameters' score once the offsets have taken their part
    part = normal[:free, free:] @ pseudo_inverse(normal[free:, free:])
    kept = np.hstack([np.eye(free), -part])
    return kept @ total @ kept.T


def _of_force(
    problem: OutputError,
    state: State,
    i: int,
    force: Force,
    level: float,
    weighed: np.ndarray,
    base: np.ndarray,
    draws: int,
    seed: int,
) -> np.ndarray | None:
    """(k, k) scatter of the score by noise of that standard deviation on the force of one segment; None where
    no draw simulates.

    Of stretches that know nothing of one another the scatters add up, and each is known from all draws. These are
    enough once the variances, of sums of squares of normal numbers, are as good as those of ``draws`` sums.
    """
    segment = problem.segments[i]
    edges = np.linspace(0, segment.n, _stretches(segment, problem, state) + 1).astype(int)

    def score(draw: int) -> np.ndarray:
        random = np.random.default_rng([seed, i, draw])
        moved = problem.simulate(i, state, force=force.disturbed(level, random, segment.dt))
        moved -= base
        return np.array([weighed[:, a:b] @ moved[a:b] for a, b in pairwise(edges)])

    scores: list[np.ndarray] = []
    for first in range(0, draws, _AT_ONCE):
        made = problem.map(score, range(first, min(first + _AT_ONCE, draws)))
        scores += [own for own in made if np.all(np.isfinite(own))]  # chatter where friction hardly holds: no score
        if edges.size > 2 and scores and _as_good_as(np.concatenate(scores)) >= draws:
            break
    if not scores:
        return None
    every = np.concatenate(scores)
    return every.T @ every / len(scores)


def _stretches(segment: Segment, problem: OutputError, state: State) -> int:
    """How many stretches of a segment know nothing of one another."""
    values = dict(zip(problem.core.parameter_names, map(float, state.values), strict=True))
    peak = max(np.sqrt(2) * float(np.std(segment.response)) / segment.pace**segment.order, np.finfo(float).tiny ** 0.25)
    damping = abs(equivalent(values, peak, segment.pace, segment.time)[1])
    return max(1, int(segment.n * segment.dt * 0.5 * damping / _FORGOTTEN))


def _as_good_as(scores: np.ndarray) -> float:
    """Equal normal numbers whose variance is known as well as that of the sum of (n, k) normal ones is from these."""
    squares = scores**2
    spread = np.maximum(np.sum(squares**2, axis=0) / 3.0, np.finfo(float).tiny)
    return float(np.min(np.sum(squares, axis=0) ** 2 / spread))
