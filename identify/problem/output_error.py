"""Prediction error: the response of all segments and its derivatives.

The parameters are shared by all segments, offsets of the sensors by those of one
recording; each segment has an initial state of its own, which is eliminated from the normal equations, so that many
decays cost no more than their own simulation. The memory says how far the model predicts (``prediction``): with an
endless one the response is simulated freely, and this is output error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, Self, TypeVar

import numpy as np

from ...simulate.core import Core
from ...simulate.force import Force
from ...simulate.sides import Sides
from ...simulate.threads import pool
from ..motion.blows import ContactForce
from ..signals.hilbert import LONG
from ..signals.noise_spectrum import NoiseSpectrum, white
from ..signals.registry import numerics
from . import chain
from .adjoint import felt
from .chain import Fault
from .jump_sides import nearer_sides, put_on_same_sides
from .normal_equations import Block, products, shared_information
from .offset import Offset, zeros_along
from .prediction import FREE, prediction_gain
from .search_point import State
from .segments import Segment

Item = TypeVar("Item")
T = TypeVar("T")

_MOST_TURN = numerics(
    2.0, "times what a phase can turn", why="harmonics and a motion beside its pace may add this much"
)
_STEP = numerics(1e-5, "of a fault's size", why="of its difference quotient: the event-exact core is smooth to 1e-12")


class OutputError:
    """The response of all segments by one core.

    Args:
        core: compiled equations.
        segments: what to reproduce.
        free: indices of the parameters to be found, in the core's order.
        scale: (parameters,) typical sizes, of parameters near zero.
        state_scale: (states,) a hundredth of a typical displacement, velocity and inner states.
        max_step: longest internal step of the simulation, s.
        bounds: (2, parameters) lowest and highest values, where there are any.
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
        self.offsets = tuple(offsets)
        self.memory = memory
        #: Of the recordings; their sizes stand behind the offsets.
        self.faults: tuple[Fault, ...] = ()
        #: Free parameters and offsets: what segments share.
        self.shared = len(self.free) + len(self.offsets)

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

    def with_faults(self, faults: Sequence[Fault]) -> OutputError:
        """The same with further faults, their sizes behind the offsets."""
        first = {segment.recording: segment for segment in reversed(self.segments)}
        sizes = [Offset(f.recording, "fault", f.scale(first[f.recording])) for f in faults for _ in range(f.count)]
        other = self.with_offsets((*self.offsets, *sizes))
        other.faults = (*self.faults, *faults)
        return other

    def sized(self, index: int, state: State) -> chain.Sized:
        """The faults of a segment's recording, and their sizes."""
        sizes = chain.sizes_of(self.faults, state.offsets) if self.faults else ()
        of = self.segments[index].recording
        return [pair for pair in zip(self.faults, sizes, strict=True) if pair[0].recording == of]

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

    def simulate(
        self,
        index: int,
        state: State,
        n: int | None = None,
        force: Force | None = None,
        added: np.ndarray | None = None,
        out: np.ndarray | None = None,
        sides: Sides | None = None,
    ) -> np.ndarray:
        """(n,) response of one segment as its chain shows it, to its own force or another, and what is added."""
        asked, how, shown = self._run(index, state, n, force)
        raw = self.core.record(*asked, **how, added=added, out=out, sides=sides)
        _show(shown, raw, sides)
        made = chain.shown(raw, self.segments[index], self.sized(index, state), sides)
        if out is not None and made is not out:
            out[:] = made
            return out
        return made

    def _run(
        self, index: int, state: State, n: int | None = None, force: Force | None = None
    ) -> tuple[tuple[Any, ...], dict[str, Any], np.ndarray]:
        """What the core is asked for along a segment, and what its sensor shows beside the motion."""
        segment = chain.meant(self.segments[index], self.sized(index, state))
        force = force or self.force(segment)
        shown, pushes = zeros_along(self.offsets, state.offsets, segment)
        how: dict[str, Any] = {"start": segment.time, "quantity": segment.quantity}
        how["load"] = -pushes if force is not None else 0.0
        if self.memory != FREE:
            gain = np.zeros(self.core.states)
            gain[:2] = prediction_gain(self.memory, segment.pace, segment.dt, segment.quantity)
            how |= {"gain": gain, "measured": segment.response - shown if np.any(shown) else segment.response}
        step = self.coarse_step if self.coarse else self.max_step
        values = self.values(state.values, segment)
        return (values, state.initial[index], force, n or segment.n, segment.dt, step), how, shown

    def values(self, common: np.ndarray, segment: Segment) -> np.ndarray:
        """(parameters,) of the rig along a segment, of those that are common to all recordings."""
        if not segment.differs:
            return common
        differs = dict(segment.differs)
        return common + [differs.get(name, 0.0) for name in self.core.parameter_names]

    def felt(self, i: int, state: State, weights: np.ndarray) -> Iterator[tuple[slice, np.ndarray]] | None:
        """Derivatives of sums of a segment's response, weighted by (k, n), by each sample of its force, in parts.

        None where the linearised motion does not give them, as where it does not simulate, or through faults.
        """
        if self.faults:
            return None
        transitions = self.transitions(i, state)
        if not all(np.all(np.isfinite(part)) for part in transitions):
            return None
        force = self.force(self.segments[i])
        if isinstance(force, ContactForce):  # whose noise counts during contacts alone
            touches = force.contacts(self.segments[i].n)
            return ((part, own * touches[part]) for part, own in felt(transitions, weights, held=True))
        return felt(transitions, weights, held=force is not None and force.hold == "zero")

    def transitions(self, i: int, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The linearised motion of a segment, beside its jumps on the nearer side; see ``Core.transitions``."""
        asked, how, zero = self._run(i, state)
        sides = self.sides(i)
        single = self.segments[i].n >= LONG
        response, (moved, pushed, shown, direct) = self.core.transitions(*asked, **how, sides=sides, single=single)
        if sides is not None and sides.at.size:
            _show(zero, response, sides)
            taken = nearer_sides(self.segments[i], response, sides)
            at, other = sides.at[taken], sides.derivatives[:, taken]
            shown[at], direct[at] = other[:-1].T, other[-1]
        return moved, pushed, shown, direct

    def force(self, segment: Segment) -> Force | None:
        """What drives a segment, in pieces of the length that suits the step."""
        return segment.coarse_force if self.coarse else segment.force

    def free_states(self, segment: Segment) -> tuple[int, ...]:
        """Which of its initial states a segment has to itself: none but phases where it starts at rest."""
        free = self.core.equations.free
        return tuple(i for i in range(self.core.states) if free[i] or not segment.rests)

    def residuals(self, state: State) -> tuple[np.ndarray, ...]:
        """Measured minus response; beside a jump of that, minus the nearer of its two sides (``jump_sides``).

        Zero, as the derivatives are, where nothing was measured.
        """
        made = self.map(lambda i: self.response(i, state), range(len(self.segments)))
        return tuple(self._left(i, shown) for i, shown in enumerate(made))

    def _left(self, i: int, shown: np.ndarray) -> np.ndarray:
        """(n,) what a response leaves of a segment, in its place: zero where nothing was measured."""
        segment = self.segments[i]
        left = np.subtract(segment.response, shown, out=shown)
        if segment.blank is not None:
            left[segment.blank & np.isfinite(left)] = 0.0
        return left

    def response(self, index: int, state: State) -> np.ndarray:
        """(n,) response of one segment, beside its jumps on the nearer side."""
        sides = self.sides(index)
        made = self.simulate(index, state, sides=sides)
        if sides is not None:
            taken = nearer_sides(self.segments[index], made, sides)
            made[sides.at[taken]] = sides.shown[taken]
        return made

    def sides(self, index: int) -> Sides | None:
        """Room for the other sides of a response's jumps; None where it has none.

        Only an acceleration jumps where a surface is crossed, and what a prediction corrects by is as simulated.
        """
        jumps = self.segments[index].quantity == "acceleration" and bool(self.core.equations.kinds)
        return Sides() if jumps and self.memory == FREE else None

    def states(self, index: int, state: State) -> np.ndarray:
        """(n, states) displacement, velocity and inner states along one segment, simulated freely."""
        segment = self.segments[index]
        values, initial = self.values(state.values, segment), state.initial[index]
        n, step = segment.n, self.max_step
        return self.core.record(values, initial, segment.force, n, segment.dt, step, start=segment.time, states=True)

    def derivatives(self, state: State, residuals: Sequence[np.ndarray], *, single: bool = False) -> list[np.ndarray]:
        """(shared + states, n) derivatives of each segment's response: free parameters, offsets, its initial state.

        From one run of each segment, in which they go along (``Core.record_with_derivatives``). Where small changes
        decide whether friction holds the mass, they grow beyond bounds: samples at which a parameter would move the
        response by more than its phase can turn are left at zero. With ``single`` those of long segments come in single
        precision.
        """
        rows = self._rows(single=single)

        def fill(i: int) -> None:
            self.carry(i, state, self._moving(self.segments[i]), rows[i])
            self._bound(i, rows[i], state, residuals[i])

        self.map(fill, range(len(self.segments)))
        return rows

    def residuals_with_derivatives(
        self, state: State, *, single: bool = False
    ) -> tuple[tuple[np.ndarray, ...], list[np.ndarray]]:
        """``residuals``, to the bit, and ``derivatives`` from the same run of each segment."""
        rows = self._rows(single=single)

        def fill(i: int) -> np.ndarray:
            residual = self._left(i, self.carry(i, state, self._moving(self.segments[i]), rows[i]))
            self._bound(i, rows[i], state, residual)
            return residual

        return tuple(self.map(fill, range(len(self.segments)))), rows

    def _rows(self, *, single: bool) -> list[np.ndarray]:
        """Room for the derivatives of each segment's response."""
        count = self.shared + self.core.states
        return [np.zeros((count, s.n), np.float32 if single and s.n >= LONG else float) for s in self.segments]

    def carry(self, index: int, state: State, unknowns: Sequence[int], rows: np.ndarray) -> np.ndarray:
        """Put the derivatives of the first samples of a segment's response by some unknowns in their rows (k, n).

        Args:
            index: of the segment.
            state: where.
            unknowns: free parameters, offsets, initial states, counted as the rows are.
            rows: (shared + states, n) room.

        Returns:
            (n,) response, as ``response`` has it.
        """
        sides = self.sides(index)
        response, places = self._carried(index, state, unknowns, rows, sides)
        if sides is not None and sides.at.size:
            taken = nearer_sides(self.segments[index], response, sides)
            response[sides.at[taken]] = sides.shown[taken]
            rows[np.array(places, int)[:, None], sides.at[taken]] = sides.derivatives[:, taken]
        return response

    def _carried(
        self, index: int, state: State, unknowns: Sequence[int], rows: np.ndarray, sides: Sides | None
    ) -> tuple[np.ndarray, list[int]]:
        """As ``carry``, as simulated; the rows to which the derivatives of other sides belong."""
        core = self.core
        load = core.unknowns.index("load")
        by: dict[int, int] = {}  # an unknown of the core, and the row in which it goes
        zeros, sizes = [], []
        for k in unknowns:
            if k < len(self.free):
                by[self.free[k]] = k
            elif k >= self.shared:
                by[len(core.parameter_names) + k - self.shared] = k
            elif self.offsets[k - len(self.free)].channel == "force":
                by[load] = k
            elif self.offsets[k - len(self.free)].channel == "fault":
                sizes.append(k)
            else:
                zeros.append(k)
        asked, how, shown = self._run(index, state, rows.shape[1])
        places = list(by.values())
        response, _ = core.record_with_derivatives(*asked, **how, by=list(by), out=rows, rows=places, sides=sides)
        _show(shown, response, sides)
        if load in by:  # what the load cell shows too much pushes too little
            rows[by[load]] *= -1.0
            if sides is not None and sides.at.size:
                sides.derivatives[places.index(by[load])] *= -1.0
        segment, faults = self.segments[index], self.sized(index, state)
        for k in zeros:
            line = zeros_along([self.offsets[k - len(self.free)]], np.ones(1), chain.meant(segment, faults))[0]
            rows[k] = line[: response.size] if line.ndim else line
        if zeros and self.memory != FREE:  # which corrects by what the sensor shows
            _, (by_zero, by_drift) = core.record_with_derivatives(*asked, **how, by=[load + 1, load + 2])
            for k in zeros:
                offset, time = self.offsets[k - len(self.free)], segment.time
                rows[k] -= by_zero if offset.channel == "response" else (time - offset.middle) * by_zero + by_drift
        if not faults:
            return response, places
        made = chain.shown(response, segment, faults, sides)
        nothing = chain.shown(np.zeros(response.size), segment, faults)
        for k in set(unknowns) - set(sizes):  # what the chain makes of a response is straight in it
            rows[k] = chain.shown(rows[k], segment, faults) - nothing
        for k in sizes:
            rows[k] = self._by_size(index, state, k - len(self.free), response, made, sides)
        return made, places

    def _by_size(
        self, index: int, state: State, place: int, raw: np.ndarray, made: np.ndarray, own: Sides | None
    ) -> np.ndarray:
        """(n,) quotient of a segment's response, ``made`` of ``raw``, by a fault's size among the offsets."""
        step = _STEP * max(abs(float(state.offsets[place])), self.offsets[place].scale)
        offsets = state.offsets.copy()
        offsets[place] += step
        ahead = replace(state, offsets=offsets)
        ends = np.cumsum([fault.count for fault in self.faults])
        fault = self.faults[int(np.searchsorted(ends, place - (len(offsets) - ends[-1]), "right"))]
        if self.memory == FREE and not fault.moves:
            return (chain.shown(raw, self.segments[index], self.sized(index, ahead)) - made) / step
        sides = self.sides(index)
        moved = self.simulate(index, ahead, made.size, sides=sides)
        if own is not None and sides is not None:
            put_on_same_sides(made, own, moved, sides)
        return (moved - made) / step

    def _moving(self, segment: Segment) -> list[int]:
        """Unknowns by which a segment's response changes at all."""
        idle = {self.shared + own for own in set(range(self.core.states)) - set(self.free_states(segment))}
        for k, offset in enumerate(self.offsets, start=len(self.free)):
            if offset.recording != segment.recording or (offset.channel == "force" and segment.force is None):
                idle.add(k)
        return [k for k in range(self.shared + self.core.states) if k not in idle]

    def _bound(self, i: int, rows: np.ndarray, state: State, residual: np.ndarray) -> None:
        """Leave out of a segment's derivatives, in their place, the samples at which they cannot be any, or are asked.

        A frequency that changes by all of itself turns the phase by 2 pi a cycle, as far back as the model remembers;
        no parameter does more.
        """
        segment = self.segments[i]
        cycles = max(1.0, min(self.memory, segment.n * segment.dt * segment.pace / (2 * np.pi)))
        span = max(float(np.ptp(segment.response)), float(np.ptp(segment.response - residual)))
        sizes = np.maximum(np.abs(state.values), self.scale)[list(self.free)]
        beyond = np.zeros(segment.n, bool)
        for k, row in enumerate(rows):
            limit = _MOST_TURN * np.pi * cycles * span / sizes[k] if k < len(sizes) else np.finfo(row.dtype).max
            if not max(float(np.max(row)), -float(np.min(row))) <= limit:  # or it does not simulate to its end
                beyond |= ~(np.abs(row) <= limit)
        if segment.blank is not None:
            beyond |= segment.blank
        if np.any(beyond):
            rows[:, beyond] = 0.0

    def size(self, i: int, k: int, state: State) -> float:
        """What the step of an unknown is measured by."""
        if k < len(self.free):
            place = self.free[k]
            return max(abs(float(state.values[place])), float(self.scale[place]))
        if k < self.shared:
            place = k - len(self.free)
            return max(abs(float(state.offsets[place])), self.offsets[place].scale)
        own = k - self.shared
        return max(abs(float(state.initial[i, own])), float(self.state_scale[own]))

    def of_parameters(self, shared: np.ndarray) -> np.ndarray:
        """(k, k) information on the free parameters, the offsets eliminated."""
        k = len(self.free)
        return shared_information([(shared, np.zeros(self.shared))], k) if self.offsets else shared


def _show(shown: np.ndarray, made: np.ndarray, sides: Sides | None) -> None:
    """Put what a sensor shows at zero, () or (n,), on a response, in its place, and on the other sides of its jumps."""
    if np.any(shown):
        made += shown[: made.size] if shown.ndim else float(shown)
        if sides is not None:
            sides.shown += shown[sides.at] if shown.ndim else float(shown)


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
