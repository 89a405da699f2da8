"""Output error: the simulated response of all segments, its derivatives, and the Levenberg-Marquardt search.

Levenberg (1944), Marquardt (1963). The parameters are shared by all segments; each segment has an initial state of
its own, which is eliminated from the normal equations (a bordered block-diagonal system), so that many decays cost
no more than their own simulation.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..simulate.core import STEPS_PER_PERIOD, Core
from ..simulate.force import Force
from .noise_spectrum import NoiseSpectrum, white
from .reach import nearest_reach
from .segments import Segment

#: Normal matrix and gradient of one segment: shared parameters, then its initial state.
Block = tuple[np.ndarray, np.ndarray]
#: Relative step of the finite differences; the event-exact core is smooth to 1e-12.
_STEP = 1e-5
_MOST_ITERATIONS = 40


@cache
def _pool() -> ThreadPoolExecutor:
    """The threads that simulate; one set for all searches of the process."""
    return ThreadPoolExecutor(max_workers=os.cpu_count() or 1)


@dataclass(frozen=True, eq=False)
class State:
    """A point of the search.

    Attributes:
        values: (parameters,), shared by all segments.
        initial: (segments, states) initial states as ``Core.begin`` takes them.
    """

    values: np.ndarray
    initial: np.ndarray


@dataclass(frozen=True, eq=False)
class Outcome:
    """Where the search ended.

    Attributes:
        state: best point.
        cost: negative log-likelihood, but for what does not depend on the parameters.
        information: (k, k) information matrix of the free parameters, initial states eliminated.
        residuals: measured minus simulated, one (n,) array a segment.
        iterations: steps taken.
        converged: whether the search came to rest rather than to its limit of steps.
    """

    state: State
    cost: float
    information: np.ndarray
    residuals: tuple[np.ndarray, ...]
    iterations: int
    converged: bool


class OutputError:
    """Simulation of all segments with one core.

    Args:
        core: compiled equations.
        segments: what to reproduce.
        free: indices of the parameters to be found, in the core's order.
        scale: (parameters,) typical sizes, for the finite differences of parameters near zero.
        state_scale: (states,) typical displacement, velocity and inner states.
        max_step: longest internal step of the simulation, s.
        bounds: (2, parameters) lowest and highest values, where there are any.
        step: of the finite differences, as a part of a value or of its typical size.
    """

    def __init__(
        self,
        core: Core,
        segments: Sequence[Segment],
        free: Sequence[int],
        scale: np.ndarray,
        state_scale: np.ndarray,
        max_step: float,
        bounds: np.ndarray | None = None,
        step: float = _STEP,
    ) -> None:
        self.core = core
        self.segments = tuple(segments)
        self.free = tuple(free)
        self.scale = scale
        self.state_scale = state_scale
        self.max_step = max_step
        self.bounds = bounds
        self.step = step
        self._pool = _pool()

    def simulate(
        self,
        index: int,
        values: np.ndarray,
        initial: np.ndarray,
        n: int | None = None,
        force: Force | None = None,
    ) -> np.ndarray:
        """(n,) response of one segment, to its own force or to another."""
        segment = self.segments[index]
        return self.core.record(
            values,
            initial,
            force or segment.force,
            n or segment.n,
            segment.dt,
            self.max_step,
            start=segment.time,
        )

    def own(self, segment: Segment) -> tuple[int, ...]:
        """Which of its initial states a segment has to itself: none but phases where it starts at rest."""
        free = self.core.equations.free
        return tuple(i for i in range(self.core.states) if free[i] or not segment.rests)

    def _parallel(self, jobs: Sequence[Callable[[], np.ndarray]]) -> list[np.ndarray]:
        return list(self._pool.map(lambda job: job(), jobs))  # the core releases the interpreter lock

    def residuals(self, state: State) -> tuple[np.ndarray, ...]:
        """Measured minus simulated."""
        jobs = [
            (lambda i=i: self.segments[i].response - self.simulate(i, state.values, state.initial[i]))
            for i in range(len(self.segments))
        ]
        return tuple(self._parallel(jobs))

    def states(self, index: int, values: np.ndarray, initial: np.ndarray) -> np.ndarray:
        """(n, states) displacement, velocity and inner states along one segment."""
        segment = self.segments[index]
        n, step = segment.n, self.max_step
        return self.core.record(values, initial, segment.force, n, segment.dt, step, start=segment.time, states=True)

    def derivatives(self, state: State, residuals: Sequence[np.ndarray], *, backward: bool = False) -> list[np.ndarray]:
        """(free + states, n) derivatives of each segment's response: the free parameters, then its initial state."""
        jobs: list[Callable[[], np.ndarray]] = []

        def slope(i: int, k: int, base: np.ndarray) -> np.ndarray:
            """Difference quotient; to the other side where the model does not simulate beyond; else zero."""
            own = k - len(self.free)
            here = state.initial[i, own] if own >= 0 else state.values[self.free[k]]
            size = self.state_scale[own] if own >= 0 else self.scale[self.free[k]]
            ahead = (-self.step if backward else self.step) * max(abs(here), size)
            for step in (ahead, -ahead):
                values, initial = state.values.copy(), state.initial[i].copy()
                if own >= 0:
                    initial[own] += step
                else:
                    values[self.free[k]] += step
                moved = (self.simulate(i, values, initial) - base) / step
                if np.all(np.isfinite(moved)):
                    return moved
            return np.zeros_like(base)

        for i, segment in enumerate(self.segments):
            base = segment.response - residuals[i]
            known = set(range(self.core.states)) - set(self.own(segment))
            for k in range(len(self.free) + self.core.states):
                if k - len(self.free) in known:
                    jobs.append(lambda base=base: np.zeros_like(base))
                else:
                    jobs.append(lambda i=i, k=k, base=base: slope(i, k, base))
        rows = iter(self._parallel(jobs))
        return [np.stack([next(rows) for _ in range(len(self.free) + self.core.states)]) for _ in self.segments]

    def settle(self, state: State, cycles: float = 3.0) -> State:
        """Better initial states from the first few cycles of each segment, the parameters as they are."""
        rate = max(2 * np.pi / (self.max_step * STEPS_PER_PERIOD), np.finfo(float).tiny)
        initial = state.initial.copy()
        for i, segment in enumerate(self.segments):
            own = self.own(segment)
            if not own:
                continue
            n = int(np.clip(cycles / rate / segment.dt * 2 * np.pi, 8, segment.n))

            def misfit(candidate: np.ndarray, i: int = i, n: int = n) -> float:
                left = self.segments[i].response[:n] - self.simulate(i, state.values, candidate, n)
                return float(np.sum(left**2))

            initial[i] = nearest_reach(initial[i], self.core.reaches(state.values), own, misfit)
            for _ in range(4):
                base = self.simulate(i, state.values, initial[i], n)
                rows = []
                for k in own:
                    moved = initial[i].copy()
                    moved[k] += self.state_scale[k]
                    rows.append((self.simulate(i, state.values, moved, n) - base) / self.state_scale[k])
                jacobian = np.array(rows).T
                residual = segment.response[:n] - base
                if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
                    break
                scale = self.state_scale[list(own)]
                trial = initial[i].copy()
                trial[list(own)] += np.linalg.lstsq(jacobian * scale, residual)[0] * scale
                after = segment.response[:n] - self.simulate(i, state.values, trial, n)
                if not np.sum(after**2) < np.sum(residual**2):
                    break
                initial[i] = trial
        return State(state.values, initial)

    def search(
        self,
        state: State,
        noise: Sequence[NoiseSpectrum] | None = None,
        *,
        tolerance: float = 1e-3,
        most: int = _MOST_ITERATIONS,
        informed: bool = True,
    ) -> Outcome:
        """Minimise the negative log-likelihood from ``state``.

        Args:
            state: where to start.
            noise: one spectrum per segment; None takes each segment's noise for white, with the level that the residual
                itself shows (the likelihood concentrated over the levels).
            tolerance: the search is over when the next step promises a smaller gain of log-likelihood; a gain of
                0.5 is a step of one standard error.
            most: steps it may take.
            informed: whether the information at the end is wanted where the last step was the last allowed.
        """
        residuals = self.residuals(state)
        cost = _cost(residuals, noise)
        damping, converged, taken = 1e-4, False, 0
        blocks = self._blocks(state, residuals, noise)
        while taken < most and not converged:
            taken += 1
            for _ in range(14):
                shared, own = _solve(blocks, damping, len(self.free))
                gain = 0.5 * _promise(blocks, shared, own)
                if gain < tolerance:
                    converged = True
                    break
                values = state.values.copy()
                values[list(self.free)] += shared
                if self.bounds is not None:
                    values = np.clip(values, *self.bounds)
                trial = State(values, state.initial + own)
                trial_residuals = self.residuals(trial)
                trial_cost = _cost(trial_residuals, noise)
                if trial_cost < cost:
                    better = cost - trial_cost > 0.25 * gain
                    damping = max(damping / 10.0, 1e-12) if better else damping * 2.0
                    state, residuals, cost = trial, trial_residuals, trial_cost
                    if informed or taken < most:
                        blocks = self._blocks(state, residuals, noise)
                    break
                damping *= 8.0
            else:
                converged = True  # no step in any direction helps: the maximum, to the precision of the derivatives
        return Outcome(state, cost, _information(blocks, len(self.free)), residuals, taken, converged)

    def scatter(
        self, state: State, noise: Sequence[NoiseSpectrum], force_noise: Sequence[float], draws: int, seed: int = 0
    ) -> np.ndarray:
        """(k, k) scatter of the score, force noise passed through the model as it is.

        The spectrum takes that noise for stationary, which it is not: a rig answers differently at each amplitude of a
        sweep. So the noise is drawn, simulated, and weighed as the fit weighs the residual.

        Args:
            state: the maximum of the likelihood.
            noise: spectra that the fit weighed by.
            force_noise: standard deviation of the force noise of each segment (0: none).
            draws: how many times.
            seed: of the random numbers.
        """
        residuals = self.residuals(state)
        derivatives = self.derivatives(state, residuals)
        k = len(self.free)
        total = np.zeros((k, k))
        for i, segment in enumerate(self.segments):
            jacobian = noise[i].whiten(derivatives[i])
            own = jacobian[k:] @ jacobian.T
            projected = jacobian[:k] - own[:, :k].T @ pseudo_inverse(own[:, k:]) @ jacobian[k:]
            if segment.force is None or force_noise[i] == 0.0:
                total += projected @ projected.T
                continue
            sensor = noise[i].sensor_part(projected)
            total += sensor @ sensor.T
            weighed = noise[i].whiten(projected)
            base = segment.response - residuals[i]
            random = np.random.default_rng([seed, i])
            noises = [segment.force.disturbed(force_noise[i], random, segment.dt) for _ in range(draws)]

            def moved(force: Force, i: int = i, base: np.ndarray = base, weighed: np.ndarray = weighed) -> np.ndarray:
                return weighed @ (self.simulate(i, state.values, state.initial[i], force=force) - base)

            scores = np.array(self._parallel([lambda f=f, m=moved: m(f) for f in noises]))
            total += scores.T @ scores / draws
        return total

    def information(self, derivatives: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]) -> np.ndarray:
        """(k, k) information of the free parameters, initial states eliminated."""
        blocks = []
        for rows, spectrum in zip(derivatives, noise, strict=True):
            white_rows = spectrum.whiten(rows)
            blocks.append((white_rows @ white_rows.T, np.zeros(rows.shape[0])))
        return _information(blocks, len(self.free))

    def _blocks(
        self, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum] | None
    ) -> list[Block]:
        derivatives = self.derivatives(state, residuals)

        def block(i: int) -> Block:
            spectrum = white(residuals[i]) if noise is None else noise[i]
            whitened = spectrum.whiten(np.vstack([derivatives[i], residuals[i]]))
            jacobian, residual = whitened[:-1], whitened[-1]
            return jacobian @ jacobian.T, jacobian @ residual

        return list(self._pool.map(block, range(len(self.segments))))


def _cost(residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum] | None) -> float:
    if not all(np.all(np.isfinite(residual)) for residual in residuals):
        return np.inf
    if noise is None:
        return sum(0.5 * r.size * float(np.log(max(np.mean(r**2), np.finfo(float).tiny))) for r in residuals)
    return sum(0.5 * float(np.sum(s.whiten(r) ** 2)) for r, s in zip(residuals, noise, strict=True))


def _promise(blocks: Sequence[Block], shared: np.ndarray, own: np.ndarray) -> float:
    """What the linearised model expects a step to gain, twice."""
    total = 0.0
    for (normal, gradient), initial in zip(blocks, own, strict=True):
        step = np.concatenate([shared, initial])
        total += float(2.0 * gradient @ step - step @ normal @ step)
    return total


def _solve(blocks: Sequence[Block], damping: float, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Step of the shared parameters (k,) and of the initial states (s, 2), damped in the scale of each unknown."""
    matrix, right = np.zeros((k, k)), np.zeros(k)
    kept = []
    for normal, gradient in blocks:
        own = _damped(normal[k:, k:], damping)
        inverse = pseudo_inverse(own)
        border = normal[:k, k:]
        matrix += normal[:k, :k] - border @ inverse @ border.T
        right += gradient[:k] - border @ inverse @ gradient[k:]
        kept.append((inverse, border, gradient[k:]))
    whole = np.array([np.diag(normal)[:k] for normal, _ in blocks]).sum(axis=0)
    shared = pseudo_inverse(matrix + damping * np.diag(whole)) @ right
    own_steps = np.array([inverse @ (gradient - border.T @ shared) for inverse, border, gradient in kept])
    return shared, own_steps


def _damped(normal: np.ndarray, damping: float) -> np.ndarray:
    return normal + damping * np.diag(np.diag(normal))


def pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric information matrix in the scale of its own diagonal; directions without information: 0."""
    if not matrix.size or not np.all(np.isfinite(matrix)):
        return np.zeros_like(matrix)
    diagonal = np.diag(matrix)
    size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    eigenvalues, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    kept = eigenvalues > 1e-14 * max(float(eigenvalues[-1]), np.finfo(float).tiny)
    inverse = np.where(kept, 1.0 / np.where(kept, eigenvalues, 1.0), 0.0)
    return (vectors * inverse) @ vectors.T / np.outer(size, size)


def _information(blocks: Sequence[Block], k: int) -> np.ndarray:
    total = np.zeros((k, k))
    for normal, _ in blocks:
        border = normal[:k, k:]
        total += normal[:k, :k] - border @ pseudo_inverse(normal[k:, k:]) @ border.T
    return total
