"""The response of all segments as a chain with faults shows it: the faults' sizes are found with the parameters."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...simulate.force import Force
from ..problem.offset import Offset
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from .fault import Fault


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
        signs: np.ndarray | None = None,
        keep: np.ndarray | None = None,
        added: np.ndarray | None = None,
        out: np.ndarray | None = None,
    ) -> np.ndarray:
        """(n,) response of one segment as the chain shows it; see ``OutputError.simulate``."""
        own = [
            (fault, sizes)
            for fault, sizes in zip(self.faults, self.sizes(state.offsets), strict=True)
            if fault.recording == self.segments[index].recording
        ]
        segment = self.segments[index]
        for fault, sizes in own:
            segment = fault.meant(segment, sizes)
        sound = copy(self)
        sound.offsets = self.offsets[: self.plain]
        sound.segments = (*self.segments[:index], segment, *self.segments[index + 1 :])
        state = replace(state, offsets=state.offsets[: self.plain])
        made = OutputError.simulate(sound, index, state, n, force, signs, keep, added, out)
        for fault, sizes in own:
            made = fault.shown(made, self.segments[index], sizes)
        if out is not None and made is not out:
            out[:] = made
            return out
        return made

    def shown_beside(self, index: int, state: State, made: np.ndarray) -> np.ndarray:
        """As ``simulate``, where ``made`` (n,) is that with all sizes of the last fault zero.

        A fault that moves no mass needs no simulation, unless something is predicted.
        """
        fault, sizes, segment = self.faults[-1], self.sizes(state.offsets)[-1], self.segments[index]
        if self.memory != FREE or (fault.moves and fault.meant(segment, sizes) is not segment):
            return self.simulate(index, state)
        return fault.shown(made, segment, sizes)

    def derivatives(self, state: State, residuals: Sequence[np.ndarray], *, single: bool = False) -> list[np.ndarray]:
        """As ``OutputError.derivatives``, by difference quotients: what a chain shows need not be smooth."""
        quotient = self.quotients(state, residuals)
        made = [np.zeros((self.shared + self.core.states, s.n)) for s in self.segments]
        places = [(i, k) for i, segment in enumerate(self.segments) for k in self._moving(segment)]
        self.map(lambda place: quotient(*place, made[place[0]][place[1]]), places)
        for i, rows in enumerate(made):
            self.bound(i, rows, state, residuals[i])
        return made

    def felt(self, i: int, state: State, weights: np.ndarray) -> np.ndarray | None:
        """None: what a chain shows need not be linear."""
        return None

    def _point(self, state: State) -> tuple[Hashable, ...]:
        """What a quotient depends on: the faults too, of which nothing is known again."""
        return (object(),)

    def _is_sensors(self, k: int) -> bool:
        """Whether an unknown is what a sensor shows beside a motion that knows nothing of it: a fault may change it."""
        return False
