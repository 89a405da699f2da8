"""The unknowns of a least-squares problem by kind and name, and their rows in the derivatives of each segment."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .output_error import OutputError
from .search_point import State


@dataclass(frozen=True)
class Unknown:
    """A number that the search finds.

    Attributes:
        kind: ``parameter`` of the model, ``chain`` (what a sensor of one recording does), or ``initial`` (an initial
            state of one segment).
        name: of the parameter, of the channel with the recording's index, or of the initial state.
        segment: index of the segment whose initial state it is; None for what segments share.
        size: typical size, in the unit of the unknown.
        low, high: bounds.
    """

    kind: Literal["parameter", "chain", "initial"]
    name: str
    segment: int | None = None
    size: float = 1.0
    low: float = -np.inf
    high: float = np.inf


@dataclass(frozen=True)
class Unknowns:
    """All unknowns of a problem, in the order of the rows of its derivatives: shared ones first.

    Attributes:
        shared: parameters, then what the sensors do; rows 0, 1, .. of each segment.
        states: names of the initial states, whose rows follow. A state that a segment knows has a row of zeros.
        of_segments: of each segment the initial states that are to be found.
    """

    shared: tuple[Unknown, ...]
    states: tuple[str, ...]
    of_segments: tuple[tuple[Unknown, ...], ...]

    @staticmethod
    def of(problem: OutputError, state: State) -> Unknowns:
        """The unknowns of a problem; their sizes as finite differences take them at ``state``."""
        names = problem.core.parameter_names
        bounds = np.array([[-np.inf], [np.inf]]) if problem.bounds is None else problem.bounds
        low, high = np.broadcast_to(bounds, (2, len(names))).tolist()
        shared = [
            Unknown("parameter", names[parameter], None, problem.size(0, k, state), low[parameter], high[parameter])
            for k, parameter in enumerate(problem.free)
        ]
        for k, offset in enumerate(problem.offsets, start=len(shared)):
            name = f"{offset.channel} of recording {offset.recording + 1}"
            again = any(unknown.name == name for unknown in shared)  # of a fault with several sizes
            shared.append(Unknown("chain", f"{name}, unknown {k}" if again else name, None, problem.size(0, k, state)))
        first = len(shared)
        states = tuple(f"initial state {j + 1}" for j in range(problem.core.states))
        own = tuple(
            tuple(
                Unknown("initial", states[j], i, problem.size(i, first + j, state))
                for j in problem.free_states(segment)
            )
            for i, segment in enumerate(problem.segments)
        )
        return Unknowns(tuple(shared), states, own)

    def __iter__(self) -> Iterator[Unknown]:
        """All that are to be found: shared ones, then those of each segment."""
        yield from self.shared
        for own in self.of_segments:
            yield from own

    @property
    def parameters(self) -> tuple[Unknown, ...]:
        """The model's own."""
        return tuple(unknown for unknown in self.shared if unknown.kind == "parameter")

    def initial(self, i: int) -> tuple[Unknown, ...]:
        """The initial states that segment ``i`` has to find for itself."""
        return self.of_segments[i]

    def index(self, unknown: Unknown) -> int:
        """The row of an unknown in the derivatives of each segment that it belongs to; ValueError where it has none."""
        if unknown.segment is None:
            return self.shared.index(unknown)
        return len(self.shared) + self.states.index(unknown.name)
