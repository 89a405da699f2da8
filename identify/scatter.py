"""How far noise scatters the score of a fit: what its standard errors stand on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..recording.recording import Recording
from ..simulate.force import Force
from .noise_spectrum import NoiseSpectrum
from .normal_equations import pseudo_inverse, shared_information
from .output_error import OutputError, State
from .rounding import scatter_of_rounding


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
        draws: how many times.
        seed: of the random numbers.
        remainders: spectra of what is left, where the fit weighed by others and the model leaves more than noise.
        recordings: of the segments, where what a converter of few levels did to them is to be counted in.
    """
    residuals = problem.residuals(state)
    derivatives = problem.derivatives(state, residuals)
    shared, free = problem.shared, len(problem.free)
    total, blocks = np.zeros((shared, shared)), []
    for i, segment in enumerate(problem.segments):
        jacobian = noise[i].whiten(derivatives[i])
        blocks.append((jacobian @ jacobian.T, np.zeros(jacobian.shape[0])))
        own = jacobian[shared:] @ jacobian.T
        projected = jacobian[:shared] - own[:, :shared].T @ pseudo_inverse(own[:, shared:]) @ jacobian[shared:]
        base, weighed = segment.response - residuals[i], noise[i].whiten(projected)
        if recordings:
            total += scatter_of_rounding(problem, state, i, weighed, base, recordings, draws, seed)
        if remainders is not None:
            coloured = remainders[i].colour(weighed)
            total += coloured @ coloured.T
            continue
        if (force := problem.force(segment)) is None or force_noise[i] == 0.0:
            total += projected @ projected.T
            continue
        sensor = noise[i].sensor_part(projected)
        total += sensor @ sensor.T

        def score(
            draw: int, i: int = i, force: Force = force, base: np.ndarray = base, weighed: np.ndarray = weighed
        ) -> np.ndarray:
            random = np.random.default_rng([seed, i, draw])
            disturbed = force.disturbed(force_noise[i], random, problem.segments[i].dt)
            return weighed @ (problem.simulate(i, state, force=disturbed) - base)

        scores = np.array(problem.map(score, range(draws)))
        scores = scores[np.all(np.isfinite(scores), axis=1)]  # a draw may end in chatter where friction hardly holds
        total += scores.T @ scores / len(scores) if len(scores) else projected @ projected.T
    if shared == free:
        return total
    normal = shared_information(blocks, shared)  # the parameters' score once the offsets have taken their part
    part = normal[:free, free:] @ pseudo_inverse(normal[free:, free:])
    kept = np.hstack([np.eye(free), -part])
    return kept @ total @ kept.T
