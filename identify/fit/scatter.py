"""How far noise scatters the score of a fit: what its standard errors stand on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ...recording.recording import Recording
from ...simulate.force import Force
from ..motion.blows import ContactForce
from ..problem.data import equivalent_resonance, measured_share
from ..problem.linearised import Linearised
from ..problem.normal_equations import products, pseudo_inverse
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..problem.rounding import measure_rounding, scatter_of_rounding
from ..signals.noise_spectrum import NoiseSpectrum, force_noise_left
from ..signals.registry import numerics
from ..signals.signals import drive_of, noise_levels

_STRAIGHT = numerics(
    0.5, "of an error", why="by which a draw may differ from what the adjoint says: jumps are no noise"
)


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
    sweep. So the noise is drawn, simulated, and weighted as the fit weighs the residual. The sensor's is taken from
    what is left, which is less by what the fit took of it (``NoiseSpectrum.widened``).

    Args:
        problem: what was fitted.
        state: the maximum of the likelihood.
        noise: spectra that the fit weighted by.
        force_noise: standard deviation of the force noise of each segment (0: none).
        draws: how many times; 0: none, as the linearised motion passes it on.
        seed: of the random numbers.
        remainders: spectra of what is left, where the fit weighted by others and the model leaves more than noise.
        recordings: of the segments, where what a converter of few levels did to them is to be counted in.
    """
    if not problem.free:
        return np.zeros((0, 0))  # nothing but zeros or initial states is to be found: no score, and no need to draw
    for recording in recordings:
        measure_rounding(recording)  # which takes memory of its own
    residuals = problem.residuals(state)
    linearised = Linearised.of(problem, state, residuals, noise)
    total = np.zeros((problem.shared, problem.shared))
    covariance = pseudo_inverse(linearised.shared.normal)
    for i, segment in enumerate(problem.segments):
        projected, taken = linearised.projected(i, covariance)
        wider = noise[i].widened(taken)
        force = problem.force(segment) if force_noise[i] else None
        informed = products(projected, projected)
        if remainders is None:
            for k, row in enumerate(projected):
                of_sensor = row if force is None else noise[i].of_sensor(row)
                total[k] += products(projected, of_sensor * wider)
        del taken, wider
        if remainders is None and force is None and not recordings:
            continue
        weighted = projected
        for k, row in enumerate(projected):
            weighted[k] = noise[i].whitened_twice(row)
        base = np.subtract(segment.response, residuals[i], out=residuals[i])
        if recordings and draws:
            total += scatter_of_rounding(problem, state, i, weighted, base, recordings, draws, seed)
        if remainders is not None:
            coloured = remainders[i].colour(weighted)
            total += products(coloured, coloured)
        elif force is not None:
            drawn = _of_force(problem, state, i, force, force_noise[i], weighted, base, draws, seed)
            total += informed if drawn is None else drawn
    # the parameters' score once the offsets have taken their part
    kept = linearised.shared.reduction(slice(len(problem.free), None))
    return kept @ total @ kept.T


def noise_on_forces(
    problem: OutputError, state: State, residuals: Sequence[np.ndarray], recordings: Sequence[Recording]
) -> list[float]:
    """Standard deviation of the noise on samples of the force of each segment, also where levels are their means.

    Of a force that shows signal where noise is measured no more than what is left has room for (``force_noise_left``);
    else it is known better than the resonance that passes it on, which glides with the amplitude.
    """
    values = dict(zip(problem.core.parameter_names, map(float, state.values), strict=True))
    levels = []
    for segment, residual in zip(problem.segments, residuals, strict=True):
        recording = recordings[segment.recording]
        level, drive = max(noise_levels(recording)[1], recording.force_noise), drive_of(recording)
        if drive is not None and drive.hides_its_noise and segment.force is not None and problem.memory == FREE:
            passed = equivalent_resonance(segment, values) / values["mass"] ** 2
            level = force_noise_left(residual, passed, level, measured_share(segment))
        levels.append(level)
    return levels


def _of_force(
    problem: OutputError,
    state: State,
    i: int,
    force: Force,
    level: float,
    weighted: np.ndarray,
    base: np.ndarray,
    draws: int,
    seed: int,
) -> np.ndarray | None:
    """(k, k) scatter of the score by noise of that standard deviation on the force of one segment; None where
    no draw simulates, or none is asked for and no adjoint gives it.

    Where the linearised motion passes the noise on, its adjoint gives it (``adjoint``): one draw that is simulated says
    whether it does. Else noise is drawn and simulated, and each draw scored over the whole segment.
    """
    segment = problem.segments[i]
    count = segment.n if force.hold != "zero" else force.pieces.shape[0] + 1
    kept = _levels(force, segment.n)

    def drawn(draw: int) -> tuple[np.ndarray, np.ndarray]:
        added = level * np.random.default_rng([seed, i, draw]).standard_normal(count)
        if kept is not None:
            added[: segment.n] = _averaged(added[None, : segment.n], kept)[0]
        if isinstance(force, ContactForce):
            moved = problem.simulate(i, state, force=force.with_added(added, segment.dt))
        else:
            moved = problem.simulate(i, state, force=force, added=added)
        moved -= base
        return added[: segment.n], products(weighted, moved)

    tried = drawn(0) if draws else None
    felt = problem.felt(i, state, weighted)
    if felt is not None:
        spread, expected = np.zeros((len(weighted), len(weighted))), np.zeros(len(weighted))
        for part, own in felt if kept is None else [(slice(None), _averaged(_whole(felt, segment.n), kept))]:
            spread += own @ own.T
            if tried is not None:
                expected += own @ tried[0][part]
        if tried is None or np.all(np.abs(expected - tried[1]) <= _STRAIGHT * level * np.sqrt(np.diag(spread))):
            return level**2 * spread
    if tried is None:
        return None
    scores = np.array(problem.map(lambda draw: drawn(draw)[1], range(draws)))
    scores = scores[np.all(np.isfinite(scores), axis=1)]  # a draw may end in chatter where friction hardly holds
    return scores.T @ scores / len(scores) if len(scores) else None


def _levels(force: Force, n: int) -> np.ndarray | None:
    """(m + 1,) samples at which the levels of a held force begin, and n; None where each sample has its own."""
    if force.hold != "zero":
        return None
    edges = 1 + np.flatnonzero(np.diff(force.pieces[:n, 0]))
    return None if edges.size >= n - 1 else np.concatenate([[0], edges, [n]])


def _averaged(rows: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Rows (k, n), each with its mean over each level."""
    size = np.diff(kept)
    return np.repeat(np.add.reduceat(rows, kept[:-1], axis=1) / size, size, axis=1)


def _whole(parts: Iterable[tuple[slice, np.ndarray]], n: int) -> np.ndarray:
    """(k, n) of parts that are given one by one."""
    known = list(parts)
    whole = np.zeros((known[0][1].shape[0], n))
    for part, rows in known:
        whole[:, part] = rows
    return whole
