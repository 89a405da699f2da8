"""The response of all segments as a chain with faults shows it: the faults' sizes are found with the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...simulate.core import Sides
from ...simulate.force import Force
from ..problem.jump_sides import put_on_same_sides
from ..problem.offset import Offset
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..signals.registry import numerics
from .fault import Fault

_STEP = numerics(1e-5, "of a size", why="of its difference quotient: the event-exact core is smooth to 1e-12")


class FaultyFit(OutputError):
    """As ``OutputError``, with the sizes of faults behind the sensors' offsets.

    Args:
        problem: without these faults; it may have others.
        faults: of its recordings.
    """

    def __init__(self, problem: OutputError, faults: Sequence[Fault]) -> None:
        self.__dict__.update(problem.__dict__)
        known = problem.faults if isinstance(problem, FaultyFit) else ()
        self.faults = (*known, *faults)
        self.plain = problem.plain if isinstance(problem, FaultyFit) else len(problem.offsets)
        self.offsets = (*problem.offsets, *(self._offset(fault) for fault in faults for _ in range(fault.count)))
        self.shared = len(self.free) + len(self.offsets)

    def _offset(self, fault: Fault) -> Offset:
        first = next(segment for segment in self.segments if segment.recording == fault.recording)
        return Offset(fault.recording, "fault", fault.scale(first))

    def moved_to(self, places: Sequence[float]) -> FaultyFit:
        """The same with the faults at other places."""
        other = copy(self)
        other.faults = tuple(
            replace(fault, place=float(place)) for fault, place in zip(self.faults, places, strict=True)
        )
        return other

    def sizes(self, offsets: np.ndarray) -> list[np.ndarray]:
        """Sizes of each fault among the offsets (offsets,) of a state, or standard errors of both."""
        ends = self.plain + np.cumsum([0, *(fault.count for fault in self.faults)])
        return [offsets[a:b] for a, b in pairwise(ends)]

    def with_sizes(self, state: State) -> State:
        """A point of the search without these faults, with all their sizes zero."""
        missing = len(self.offsets) - len(state.offsets)
        return replace(state, offsets=np.concatenate([state.offsets, np.zeros(missing)]))

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
        """(n,) response of one segment as the chain shows it; see ``OutputError.simulate``."""
        sound, within = self._sound(index, state)
        raw = sound.simulate(index, within, n, force, added, out, sides)
        made = self._shown(raw, index, state, sides)
        if out is not None and made is not out:
            out[:] = made
            return out
        return made

    def _carried(
        self, index: int, state: State, unknowns: Sequence[int], rows: np.ndarray, sides: Sides | None
    ) -> tuple[np.ndarray, list[int]]:
        """See ``OutputError``: what goes along through the chain, and difference quotients by the faults' sizes."""
        sound, within = self._sound(index, state)
        behind = self.shared - sound.shared
        moved = {k: k - behind for k in unknowns if k >= self.shared} | {k: k for k in unknowns if k < sound.shared}
        inner = np.zeros((len(rows) - behind, rows.shape[1]))
        raw, places = sound._carried(index, within, list(moved.values()), inner, sides)
        made = self._shown(raw, index, state, sides)
        outer = {place: k for k, place in moved.items()}
        nothing = self._shown(np.zeros(raw.size), index, state)
        for k, place in moved.items():  # what the chain makes of a response is straight in it
            rows[k] = self._shown(inner[place], index, state) - nothing
        for k in unknowns:
            if sound.shared <= k < self.shared:
                rows[k] = self._by_size(index, state, k - len(self.free), raw, made, sides)
        return made, [outer[place] for place in places]

    def _by_size(
        self, index: int, state: State, place: int, raw: np.ndarray, made: np.ndarray, own: Sides | None
    ) -> np.ndarray:
        """(n,) quotient of a segment's response, ``made`` of ``raw``, by a fault's size among the offsets."""
        step = _STEP * max(abs(float(state.offsets[place])), self.offsets[place].scale)
        offsets = state.offsets.copy()
        offsets[place] += step
        ahead = replace(state, offsets=offsets)
        last = self.plain + np.cumsum([fault.count for fault in self.faults])
        if self.memory == FREE and not self.faults[int(np.searchsorted(last, place, "right"))].moves:
            return (self._shown(raw, index, ahead) - made) / step
        sides = self.sides(index)
        moved = self.simulate(index, ahead, made.size, sides=sides)
        if own is not None and sides is not None:
            put_on_same_sides(made, own, moved, sides)
        return (moved - made) / step

    def _sound(self, index: int, state: State) -> tuple[OutputError, State]:
        """The problem without the chain's faults, that segment as it was meant to be, and the point in it."""
        segment = self.segments[index]
        for fault, sizes in self._own(index, state):
            segment = fault.meant(segment, sizes)
        sound = object.__new__(OutputError)
        sound.__dict__.update(self.__dict__)
        sound.offsets = self.offsets[: self.plain]
        sound.shared = len(self.free) + self.plain
        sound.segments = (*self.segments[:index], segment, *self.segments[index + 1 :])
        return sound, replace(state, offsets=state.offsets[: self.plain])

    def _own(self, index: int, state: State) -> list[tuple[Fault, np.ndarray]]:
        """The faults of a segment's recording, and their sizes."""
        recording = self.segments[index].recording
        pairs = zip(self.faults, self.sizes(state.offsets), strict=True)
        return [(fault, sizes) for fault, sizes in pairs if fault.recording == recording]

    def _shown(self, raw: np.ndarray, index: int, state: State, sides: Sides | None = None) -> np.ndarray:
        """(n,) what the chain shows of a segment's response (n,), the other sides of its jumps in their place."""
        made, segment, own = raw, self.segments[index], self._own(index, state)
        for fault, sizes in own:
            made = fault.shown(made, segment, sizes)
        if own and sides is not None and sides.at.size:
            factor = np.ones(raw.size)
            for fault, sizes in own:
                factor *= fault.shown(np.ones(raw.size), segment, sizes) - fault.shown(
                    np.zeros(raw.size), segment, sizes
                )
            sides.shown = made[sides.at] + factor[sides.at] * (sides.shown - raw[sides.at])
            sides.derivatives = sides.derivatives * factor[sides.at]
        return made

    def shown_beside(self, index: int, state: State, made: np.ndarray) -> np.ndarray:
        """As ``simulate``, where ``made`` (n,) is that with all sizes of the last fault zero.

        A fault that moves no mass needs no simulation, unless something is predicted.
        """
        fault, sizes, segment = self.faults[-1], self.sizes(state.offsets)[-1], self.segments[index]
        if self.memory != FREE or (fault.moves and fault.meant(segment, sizes) is not segment):
            return self.simulate(index, state)
        return fault.shown(made, segment, sizes)

    def felt(self, i: int, state: State, weights: np.ndarray) -> np.ndarray | None:
        """None: what a chain shows need not be linear."""
        return None
