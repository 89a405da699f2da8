"""Prediction error: the response of all segments and its derivatives.

The parameters are shared by all segments, offsets of the sensors by those of one
recording; each segment has an initial state of its own, which is eliminated from the normal equations, so that many
decays cost no more than their own simulation. The memory says how far the model predicts (``prediction``): with an
endless one the response is simulated freely, and this is output error.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, Self, TypeVar

import numpy as np

from ...simulate.core import Core
from ...simulate.force import Force
from ..signals.hilbert import LONG
from ..signals.noise_spectrum import NoiseSpectrum, white
from .adjoint import felt
from .jump_sides import nearer_sides
from .known_quotients import Kept, KnownAtPoint, kept, put_quotient, restore, without_impossible
from .normal_equations import Block, products, pseudo_inverse, shared_information, solve
from .offset import Offset, zeros_along
from .prediction import FREE, prediction_gain
from .release_memory import give_back
from .search_point import State
from .segments import Segment
from .simulating import pool

Item = TypeVar("Item")
T = TypeVar("T")

#: Relative step of the finite differences; the event-exact core is smooth to 1e-12.
_STEP = 1e-5
#: Harmonics and a motion beside its pace may add this much to what a parameter can do.
_MOST_TURN = 2.0


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
        self._known: KnownAtPoint[Kept] = KnownAtPoint()
        #: Of each segment that jumps the signs that its response had.
        self._sides: KnownAtPoint[np.ndarray] = KnownAtPoint()

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
        rows = self.derivatives(state, residuals, single=True)
        return blocks_of(self, rows, residuals, noise, consumed=True)

    def map(self, function: Callable[[Item], T], items: Sequence[Item]) -> list[T]:
        """Results of a function that is mostly simulation or linear algebra, item by item."""
        return list(pool().map(function, items))

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
        added: np.ndarray | None = None,
        out: np.ndarray | None = None,
    ) -> np.ndarray:
        """(n,) response of one segment, its sensor's offset in it, to its own force or another, and what is added."""
        asked, how, shown = self._run(index, state, n, force)
        made = self.core.record(*asked, **how, signs=signs, keep=keep, added=added, out=out)
        if np.any(shown):
            made += shown[: made.size] if shown.ndim else float(shown)
        return made

    def _run(
        self, index: int, state: State, n: int | None = None, force: Force | None = None
    ) -> tuple[tuple[Any, ...], dict[str, Any], np.ndarray]:
        """What the core is asked for along a segment, and what its sensor shows beside the motion."""
        segment = self.segments[index]
        force = force or self.force(segment)
        shown, pushes = zeros_along(self.offsets, state.offsets, segment)
        how: dict[str, Any] = {"start": segment.time, "quantity": segment.quantity}
        how["load"] = -pushes if force is not None else 0.0
        if self.memory != FREE:
            gain = np.zeros(self.core.states)
            gain[:2] = prediction_gain(self.memory, segment.pace, segment.dt, segment.quantity)
            how |= {"gain": gain, "measured": segment.response - shown if np.any(shown) else segment.response}
        step = self.coarse_step if self.coarse else self.max_step
        return (state.values, state.initial[index], force, n or segment.n, segment.dt, step), how, shown

    def felt(self, i: int, state: State, weights: np.ndarray) -> np.ndarray | None:
        """(k, n) derivatives of sums of a segment's response, weighed by (k, n), by each sample of its force.

        None where the linearised motion does not give them: of a prediction, beside jumps of the response, and where
        it does not simulate.
        """
        if self.memory != FREE or self._jumps(i):
            return None
        asked, how, _ = self._run(i, state)
        transitions = self.core.transitions(*asked, **how)
        if not all(np.all(np.isfinite(part)) for part in transitions):
            return None
        return felt(transitions, weights, held=asked[2].hold == "zero")

    def force(self, segment: Segment) -> Force | None:
        """What drives a segment, in pieces of the length that suits the step."""
        return segment.coarse_force if self.coarse else segment.force

    def own(self, segment: Segment) -> tuple[int, ...]:
        """Which of its initial states a segment has to itself: none but phases where it starts at rest."""
        free = self.core.equations.free
        return tuple(i for i in range(self.core.states) if free[i] or not segment.rests)

    def residuals(self, state: State) -> tuple[np.ndarray, ...]:
        """Measured minus response; beside a jump of that, minus the nearer of its two sides (``jump_sides``)."""
        room = [np.empty(segment.n) for segment in self.segments]
        sides = self._sides_at(state)

        def shown_by(i: int) -> np.ndarray:
            response, signs = self._beside_jumps(i, state, room[i])
            if self._jumps(i):
                sides[i] = signs
            return response

        made = self.map(shown_by, range(len(self.segments)))
        return tuple(np.subtract(s.response, shown, out=shown) for s, shown in zip(self.segments, made, strict=True))

    def states(self, index: int, state: State) -> np.ndarray:
        """(n, states) displacement, velocity and inner states along one segment, simulated freely."""
        segment = self.segments[index]
        values, initial = state.values, state.initial[index]
        n, step = segment.n, self.max_step
        return self.core.record(values, initial, segment.force, n, segment.dt, step, start=segment.time, states=True)

    def derivatives(self, state: State, residuals: Sequence[np.ndarray], *, single: bool = False) -> list[np.ndarray]:
        """(shared + states, n) derivatives of each segment's response: free parameters, offsets, its initial state.

        Where the response jumps (an acceleration, when friction turns), all runs of a segment show what their states
        give under the same signs, sample by sample: the jump itself has no derivative. Where small changes decide
        whether friction holds the mass, a difference quotient is no derivative either: samples at which a parameter
        would move the response by more than its phase can turn are left at zero. With ``single`` those of long segments
        come in single precision, to which a quotient is good.
        """
        if max(segment.n for segment in self.segments) >= LONG:
            give_back()
        count = self.shared + self.core.states
        made = [np.zeros((count, s.n), np.float32 if single and s.n >= LONG else float) for s in self.segments]
        sides = self._known_sides(state)
        self.map(lambda i: self._carry(i, state, sides.get(i), made[i]), range(len(self.segments)))
        for i, rows in enumerate(made):
            self.bound(i, rows, state, residuals[i])
        return made

    def quotients(
        self, state: State, residuals: Sequence[np.ndarray], *, backward: bool = False
    ) -> Callable[[int, int, np.ndarray], None]:
        """Puts the difference quotient of one segment's response by one unknown, there, into an array (n,).

        To the other side where the model does not simulate beyond; else zero. Under the same signs as ``derivatives``.
        """
        sides = self._known_sides(state)
        known = {} if backward else self._known.at(self._point(state))

        def quotient(i: int, k: int, out: np.ndarray) -> None:
            unknown = (i, "parameter", self.free[k]) if k < len(self.free) else (i, "own", k - self.shared)
            if unknown in known:
                restore(known[unknown], out)
                return
            ahead = (-self.step if backward else self.step) * self._size(i, k, state)

            def moved(step: float, room: np.ndarray) -> None:
                self.simulate(i, self._moved(i, k, state, step), signs=sides.get(i), out=room)

            put_quotient(moved, ahead, self.segments[i].response, residuals[i], out)
            if not backward and out.size >= LONG and not len(self.free) <= k < self.shared:
                known[unknown] = kept(out)

        return quotient

    def _carry(self, i: int, state: State, signs: np.ndarray | None, out: np.ndarray) -> None:
        """Put the derivatives of a segment's response, carried along one run of it, into an array (unknowns, n)."""
        count, states = len(self.core.parameter_names), self.core.states
        runs: list[tuple[np.ndarray | None, dict[int, int]]] = [(None, {})]  # profile, and place by unknown
        for k in self._moving(self.segments[i]):
            if k < len(self.free):
                runs[0][1][k] = self.free[k]
            elif k >= self.shared:
                runs[0][1][k] = count + k - self.shared
            elif self._is_sensors(k):
                out[k] = self._shown_by(i, k)
            elif self.offsets[k - len(self.free)].channel == "force":
                runs[0][1][k] = count + states
            else:
                shown = self._shown_by(i, k)
                out[k] = shown
                runs.append((np.broadcast_to(shown, out.shape[1]), {k: count + states + 1}))
        asked, how, _ = self._run(i, state)
        for profile, by in runs:
            if not by:
                continue
            _, rows = self.core.record_with_derivatives(
                *asked, **how, signs=signs, by=list(by.values()), profile=profile
            )
            for (k, place), row in zip(by.items(), rows, strict=True):
                if not np.all(np.isfinite(row)):
                    out[k] = 0.0
                elif place < count + states:
                    out[k] = row
                else:  # a zero is taken off the force, or off what was measured
                    out[k] -= row

    def forget(self) -> None:
        """Make room of what is known at the last point, where nobody will ask for it again."""
        self._known.at(())
        self._sides.at(())

    def _point(self, state: State) -> tuple[Hashable, ...]:
        """What a quotient depends on."""
        felt = [self.memory != FREE or offset.channel == "force" for offset in self.offsets]
        how = self.segments, self.memory, self.coarse, self.step
        return (*how, state.values.tobytes(), state.initial.tobytes(), state.offsets[felt].tobytes())

    def _sides_at(self, state: State) -> dict[Hashable, np.ndarray]:
        """Signs of the segments that jump, as far as they were simulated there: a sensor's zero decides them too."""
        return self._sides.at((*self._point(state), state.offsets.tobytes()))

    def _known_sides(self, state: State) -> dict[Hashable, np.ndarray]:
        """Signs of all segments that jump, simulated where they are not known."""
        sides = self._sides_at(state)
        asked = [i for i in range(len(self.segments)) if self._jumps(i) and i not in sides]
        sides.update(zip(asked, self.map(lambda i: self._beside_jumps(i, state)[1], asked), strict=True))
        return sides

    def _moving(self, segment: Segment) -> list[int]:
        """Unknowns by which a segment's response changes at all."""
        idle = {self.shared + own for own in set(range(self.core.states)) - set(self.own(segment))}
        for k, offset in enumerate(self.offsets, start=len(self.free)):
            if offset.recording != segment.recording or (offset.channel == "force" and segment.force is None):
                idle.add(k)
        return [k for k in range(self.shared + self.core.states) if k not in idle]

    def _is_sensors(self, k: int) -> bool:
        """Whether an unknown is what a sensor shows beside a motion that knows nothing of it: needs no simulation."""
        place = k - len(self.free)
        return self.memory == FREE and 0 <= place < len(self.offsets) and self.offsets[place].channel != "force"

    def _shown_by(self, i: int, k: int) -> np.ndarray:
        """() or (n,) what a sensor shows along a segment for each unit of its offset."""
        return zeros_along([self.offsets[k - len(self.free)]], np.ones(1), self.segments[i])[0]

    def bound(self, i: int, rows: np.ndarray, state: State, residual: np.ndarray) -> None:
        """Leave out of a segment's derivatives, in their place, the samples at which they cannot be any.

        A frequency that changes by all of itself turns the phase by 2 pi a cycle, as far back as the model remembers;
        no parameter does more.
        """
        segment = self.segments[i]
        cycles = max(1.0, min(self.memory, segment.n * segment.dt * segment.pace / (2 * np.pi)))
        span = max(float(np.ptp(segment.response)), float(np.ptp(segment.response - residual)))
        limits = [_MOST_TURN * np.pi * cycles * span / self._size(i, k, state) for k in range(len(self.free))]
        without_impossible(rows, limits)

    def _jumps(self, i: int) -> bool:
        """Whether a segment's response jumps where a surface is crossed."""
        return self.segments[i].quantity == "acceleration" and bool(self.core.equations.kinds)

    def _beside_jumps(self, i: int, state: State, out: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """(n,) response of a segment, beside its jumps on the nearer side, and (n, surfaces + 1) the signs it has."""
        segment = self.segments[i]
        keep = self.core.signs(segment.n if self._jumps(i) else 0)
        response = self.simulate(i, state, keep=keep if self._jumps(i) else None, out=out)
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

    def information(self, derivatives: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]) -> np.ndarray:
        """(k, k) information of the free parameters, initial states eliminated."""
        blocks = blocks_of(self, derivatives, [np.zeros(rows.shape[1]) for rows in derivatives], noise)
        return self.of_parameters(shared_information(blocks, self.shared))

    def score(
        self, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(shared,) first step of a search from here, and the standard errors of what it would find."""
        blocks = self.blocks(state, residuals, noise)
        covariance = pseudo_inverse(shared_information(blocks, self.shared))
        return solve(blocks, 0.0, self.shared)[0], np.sqrt(np.maximum(np.diag(covariance), 0.0))

    def of_parameters(self, shared: np.ndarray) -> np.ndarray:
        """(k, k) information on the free parameters, the offsets eliminated."""
        k = len(self.free)
        return shared_information([(shared, np.zeros(self.shared))], k) if self.offsets else shared


def blocks_of(
    problem: OutputError,
    rows: Sequence[np.ndarray],
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum] | None,
    *,
    consumed: bool = False,
) -> list[Block]:
    """Normal matrix and gradient of each segment, from its derivatives and residuals, whitened by the noise.

    With ``consumed`` the derivatives' own memory is used: they are derivatives no more.
    """
    spectra = [white(residual) for residual in residuals] if noise is None else noise
    made = rows if consumed else [own.copy() for own in rows]
    in_lines(problem, made, spectra)
    each = zip(made, residuals, spectra, strict=True)
    return [(products(lines, lines), products(lines, spectrum.lines(residual))) for lines, residual, spectrum in each]


def in_lines(problem: OutputError, rows: Sequence[np.ndarray], spectra: Sequence[NoiseSpectrum]) -> None:
    """Turn each segment's derivatives, in their own place and row by row, into their whitened lines."""

    def whiten(pair: tuple[np.ndarray, NoiseSpectrum]) -> None:
        row, spectrum = pair
        if np.any(row) and (made := spectrum.lines(row, overwrite=True)) is not row:
            row[:] = made

    problem.map(whiten, [(row, spectrum) for own, spectrum in zip(rows, spectra, strict=True) for row in own])
