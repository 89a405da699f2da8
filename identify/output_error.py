"""Prediction error: the response of all segments, its derivatives, and the Levenberg-Marquardt search.

Levenberg (1944), Marquardt (1963). The parameters are shared by all segments, offsets of the sensors by those of one
recording; each segment has an initial state of its own, which is eliminated from the normal equations, so that many
decays cost no more than their own simulation. The memory says how far the model predicts (``prediction``): with an
endless one the response is simulated freely, and this is output error.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Self, TypeVar

import numpy as np

from ..simulate.core import Core
from ..simulate.force import Force
from .descent import Descent, blocks_of
from .jump_sides import nearer_sides
from .noise_spectrum import NoiseSpectrum
from .normal_equations import Block, pseudo_inverse, shared_information, solve
from .offset import Offset, zeros_along
from .prediction import FREE, prediction_gain
from .segments import Segment

T = TypeVar("T")

#: Relative step of the finite differences; the event-exact core is smooth to 1e-12.
_STEP = 1e-5
MOST_STEPS = 40
#: Harmonics and a motion beside its pace may add this much to what a parameter can do.
_MOST_TURN = 2.0


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
        offsets: (offsets,) of the sensors, in the order of ``OutputError.offsets``.
    """

    values: np.ndarray
    initial: np.ndarray
    offsets: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False)
class Outcome:
    """Where the search ended.

    Attributes:
        state: best point.
        cost: negative log-likelihood, but for what does not depend on the parameters.
        information: (k, k) information matrix of the free parameters, all else eliminated.
        residuals: measured minus response, one (n,) array a segment.
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
    """The response of all segments by one core.

    Args:
        core: compiled equations.
        segments: what to reproduce.
        free: indices of the parameters to be found, in the core's order.
        scale: (parameters,) typical sizes, for the finite differences of parameters near zero.
        state_scale: (states,) typical displacement, velocity and inner states.
        max_step: longest internal step of the simulation, s.
        bounds: (2, parameters) lowest and highest values, where there are any.
        step: of the finite differences, as a part of a value or of its typical size.
        offsets: the sensors' offsets to be found.
        memory: how far the model predicts, in cycles; see ``prediction``.
        coarse_step: longest internal step of a search that only leads to where a fit begins, s; see ``coarsely``.
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
        offsets: Sequence[Offset] = (),
        memory: float = FREE,
        coarse_step: float | None = None,
    ) -> None:
        self.core = core
        self.segments = tuple(segments)
        self.free = tuple(free)
        self.scale = scale
        self.state_scale = state_scale
        self.max_step = max_step
        self.coarse_step = coarse_step or max_step
        #: Whether it simulates with that step, and with the force in fewer pieces.
        self.coarse = False
        self.bounds = bounds
        self.step = step
        self.offsets = tuple(offsets)
        self.memory = memory
        #: Free parameters and offsets: what segments share.
        self.shared = len(self.free) + len(self.offsets)
        self._pool = _pool()

    def predicting(self, memory: float) -> OutputError:
        """The same with another memory."""
        other = copy(self)
        other.memory = memory
        return other

    def coarsely(self, coarse: bool = True) -> Self:
        """The same, simulated as coarsely as a search may that only leads to where a fit begins; or not."""
        other = copy(self)
        other.coarse = coarse
        return other

    def over(self, segments: Sequence[Segment]) -> OutputError:
        """The same over other segments."""
        other = copy(self)
        other.segments = tuple(segments)
        return other

    def with_offsets(self, offsets: Sequence[Offset]) -> OutputError:
        """The same with other offsets."""
        other = copy(self)
        other.offsets = tuple(offsets)
        other.shared = len(other.free) + len(other.offsets)
        return other

    def blocks(
        self, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum] | None
    ) -> list[Block]:
        """Normal matrix and gradient of each segment at a point, whitened by the noise."""
        return blocks_of(self, self.derivatives(state, residuals), residuals, noise)

    def map(self, function: Callable[[int], T], items: Sequence[int]) -> list[T]:
        """Results of a function that is mostly linear algebra, item by item."""
        return list(self._pool.map(function, items))

    def keeping(self, state: State) -> OutputError:
        """The same with all parameters and offsets as they are: only initial states are to be found."""
        other = self.with_offsets(())
        other.free, other.shared = (), 0
        less = []
        for segment in self.segments:
            shown, pushes = zeros_along(self.offsets, state.offsets, segment)
            force = segment.force if segment.force is None or not pushes else segment.force.shifted(-pushes)
            less.append(replace(segment, response=segment.response - shown, force=force))
        other.segments = tuple(less)
        return other

    def shared_information(
        self, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]
    ) -> np.ndarray:
        """(shared, shared) information on free parameters and offsets, initial states eliminated."""
        return shared_information(self.blocks(state, residuals, noise), self.shared)

    def simulate(
        self,
        index: int,
        state: State,
        n: int | None = None,
        force: Force | None = None,
        signs: np.ndarray | None = None,
        keep: np.ndarray | None = None,
    ) -> np.ndarray:
        """(n,) response of one segment, its sensor's offset in it, to its own force or to another."""
        segment = self.segments[index]
        force = force or self.force(segment)
        shown, pushes = zeros_along(self.offsets, state.offsets, segment)
        if force is not None and pushes:
            force = force.shifted(-pushes)
        measured = gain = None
        if self.memory != FREE:
            own = prediction_gain(self.memory, segment.pace, segment.dt, segment.quantity)
            gain = np.zeros(self.core.states)
            gain[:2] = own
            measured = segment.response - shown
        made = self.core.record(
            state.values,
            state.initial[index],
            force,
            n or segment.n,
            segment.dt,
            self.coarse_step if self.coarse else self.max_step,
            start=segment.time,
            measured=measured,
            gain=gain,
            signs=signs,
            keep=keep,
            quantity=segment.quantity,
        )
        return made + (shown[: made.size] if shown.ndim else float(shown)) if np.any(shown) else made

    def force(self, segment: Segment) -> Force | None:
        """What drives a segment, in pieces of the length that suits the step."""
        return segment.coarse_force if self.coarse else segment.force

    def own(self, segment: Segment) -> tuple[int, ...]:
        """Which of its initial states a segment has to itself: none but phases where it starts at rest."""
        free = self.core.equations.free
        return tuple(i for i in range(self.core.states) if free[i] or not segment.rests)

    def parallel(self, jobs: Sequence[Callable[[], np.ndarray]]) -> list[np.ndarray]:
        """Results of jobs that are mostly simulation."""
        return list(self._pool.map(lambda job: job(), jobs))  # the core releases the interpreter lock

    def residuals(self, state: State) -> tuple[np.ndarray, ...]:
        """Measured minus response; beside a jump of that, minus the nearer of its two sides (``jump_sides``)."""
        every = range(len(self.segments))
        made = self.parallel([lambda i=i: self._beside_jumps(i, state)[0] for i in every])
        return tuple(segment.response - response for segment, response in zip(self.segments, made, strict=True))

    def states(self, index: int, state: State) -> np.ndarray:
        """(n, states) displacement, velocity and inner states along one segment, simulated freely."""
        segment = self.segments[index]
        values, initial = state.values, state.initial[index]
        n, step = segment.n, self.max_step
        return self.core.record(values, initial, segment.force, n, segment.dt, step, start=segment.time, states=True)

    def derivatives(
        self, state: State, residuals: Sequence[np.ndarray], *, backward: bool = False, raw: bool = False
    ) -> list[np.ndarray]:
        """(shared + states, n) derivatives of each segment's response: free parameters, offsets, its initial state.

        Where the response jumps (an acceleration, when friction turns), all runs of a segment show what their states
        give under the same signs, sample by sample: the jump itself has no derivative. Where a hair decides whether
        friction holds the mass, a difference quotient is no derivative either: samples at which a parameter would move
        the response by more than its phase can turn are left at zero, unless the ``raw`` quotients are asked for.
        """
        jobs: list[Callable[[], np.ndarray]] = []
        jumping = [i for i in range(len(self.segments)) if self._jumps(i)]
        taken = self.parallel([lambda i=i: self._beside_jumps(i, state)[1] for i in jumping])
        signs = dict(zip(jumping, taken, strict=True))

        def slope(i: int, k: int, base: np.ndarray) -> np.ndarray:
            """Difference quotient; to the other side where the model does not simulate beyond; else zero."""
            ahead = (-self.step if backward else self.step) * self._size(i, k, state)
            for step in (ahead, -ahead):
                moved = (self.simulate(i, self._moved(i, k, state, step), signs=signs.get(i)) - base) / step
                if np.all(np.isfinite(moved)):
                    return moved
            return np.zeros_like(base)

        for i, segment in enumerate(self.segments):
            base = segment.response - residuals[i]
            idle = {self.shared + own for own in set(range(self.core.states)) - set(self.own(segment))}
            idle |= {
                len(self.free) + place
                for place, offset in enumerate(self.offsets)
                if offset.recording != segment.recording or (offset.channel == "force" and segment.force is None)
            }
            for k in range(self.shared + self.core.states):
                if k in idle:
                    jobs.append(lambda base=base: np.zeros_like(base))
                elif self._is_sensors(k):
                    jobs.append(lambda base=base, i=i, k=k: np.zeros_like(base) + self._shown_by(i, k))
                else:
                    jobs.append(lambda i=i, k=k, base=base: slope(i, k, base))
        rows = iter(self.parallel(jobs))
        jacobians = [np.stack([next(rows) for _ in range(self.shared + self.core.states)]) for _ in self.segments]
        if raw:
            return jacobians
        bases = [segment.response - residual for segment, residual in zip(self.segments, residuals, strict=True)]
        return [
            self._bounded(i, made, state, base) for i, (made, base) in enumerate(zip(jacobians, bases, strict=True))
        ]

    def _is_sensors(self, k: int) -> bool:
        """Whether an unknown is what a sensor shows beside a motion that knows nothing of it: needs no simulation."""
        place = k - len(self.free)
        return self.memory == FREE and 0 <= place < len(self.offsets) and self.offsets[place].channel != "force"

    def _shown_by(self, i: int, k: int) -> np.ndarray:
        """() or (n,) what a sensor shows along a segment for each unit of its offset."""
        return zeros_along([self.offsets[k - len(self.free)]], np.ones(1), self.segments[i])[0]

    def _bounded(self, i: int, rows: np.ndarray, state: State, made: np.ndarray) -> np.ndarray:
        """Derivatives of a segment without the samples at which they cannot be any.

        A frequency that changes by all of itself turns the phase by 2 pi a cycle, as far back as the model remembers;
        no parameter does more.
        """
        segment = self.segments[i]
        cycles = max(1.0, min(self.memory, segment.n * segment.dt * segment.pace / (2 * np.pi)))
        limit = _MOST_TURN * 2 * np.pi * cycles * max(float(np.ptp(segment.response)), float(np.ptp(made))) / 2
        sizes = np.array([self._size(i, k, state) for k in range(len(self.free))])
        beyond = np.any(np.abs(rows[: len(self.free)]) * sizes[:, None] > limit, axis=0)
        return np.where(beyond, 0.0, rows) if np.any(beyond) else rows

    def _jumps(self, i: int) -> bool:
        """Whether a segment's response jumps where a surface is crossed."""
        return self.segments[i].quantity == "acceleration" and bool(self.core.equations.kinds)

    def _beside_jumps(self, i: int, state: State) -> tuple[np.ndarray, np.ndarray]:
        """(n,) response of a segment, beside its jumps on the nearer side, and (n, surfaces + 1) the signs it has."""
        segment, keep = self.segments[i], self.core.signs(self.segments[i].n)
        response = self.simulate(i, state, keep=keep if self._jumps(i) else None)
        if self.memory != FREE or not self._jumps(i):  # what a prediction corrects by is as simulated
            return response, keep
        return nearer_sides(segment, response, keep, lambda signs: self.simulate(i, state, signs=signs))

    def _size(self, i: int, k: int, state: State) -> float:
        """What the step of an unknown is measured by."""
        if k < len(self.free):
            place = self.free[k]
            return max(abs(float(state.values[place])), float(self.scale[place]))
        if k < self.shared:
            place = k - len(self.free)
            return max(abs(float(state.offsets[place])), self.offsets[place].scale)
        own = k - self.shared
        return max(abs(float(state.initial[i, own])), float(self.state_scale[own]))

    def _moved(self, i: int, k: int, state: State, step: float) -> State:
        """The point with one unknown of a segment moved."""
        if k < len(self.free):
            values = state.values.copy()
            values[self.free[k]] += step
            return replace(state, values=values)
        if k < self.shared:
            offsets = state.offsets.copy()
            offsets[k - len(self.free)] += step
            return replace(state, offsets=offsets)
        initial = state.initial.copy()
        initial[i, k - self.shared] += step
        return replace(state, initial=initial)

    def search(
        self,
        state: State,
        noise: Sequence[NoiseSpectrum] | None = None,
        *,
        tolerance: float = 1e-3,
        most: int = MOST_STEPS,
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
        descent = Descent(self, state, noise)
        while descent.taken < most and not descent.resting:
            descent.step(tolerance)
        information = np.zeros((len(self.free), len(self.free)))
        if informed or descent.resting:
            information = self._of_parameters(shared_information(descent.blocks, self.shared))
        return Outcome(descent.state, descent.cost, information, descent.residuals, descent.taken, descent.resting)

    def information(self, derivatives: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]) -> np.ndarray:
        """(k, k) information of the free parameters, initial states eliminated."""
        blocks = []
        for rows, spectrum in zip(derivatives, noise, strict=True):
            lines = spectrum.lines(rows)
            blocks.append((lines @ lines.T, np.zeros(rows.shape[0])))
        return self._of_parameters(shared_information(blocks, self.shared))

    def score(
        self, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(shared,) first step of a search from here, and the standard errors of what it would find."""
        blocks = self.blocks(state, residuals, noise)
        covariance = pseudo_inverse(shared_information(blocks, self.shared))
        return solve(blocks, 0.0, self.shared)[0], np.sqrt(np.maximum(np.diag(covariance), 0.0))

    def _of_parameters(self, shared: np.ndarray) -> np.ndarray:
        """(k, k) information on the free parameters, the offsets eliminated."""
        k = len(self.free)
        return shared_information([(shared, np.zeros(self.shared))], k) if self.offsets else shared
