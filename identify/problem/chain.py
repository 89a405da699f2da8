"""Faults of a measuring chain, each in a few sizes, and how a segment and its response go through them.

A fault is a nuisance, as a sensor's zero is one: it changes what is recorded in a known way and knows nothing of the
rig. So a model is run along what the signals were meant to be, and its response is shown as the faulty chain would.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...recording.as_recorded import InUnit
from ...simulate.sides import Sides
from .segments import Segment


@dataclass(frozen=True)
class Fault(ABC):
    """One fault of one recording.

    Attributes:
        recording: index of the recording.
        place: from when it is there, s, or its frequency, Hz; nan where it has neither.
    """

    recording: int
    place: float = np.nan

    #: How many sizes it has, and whether the motion itself depends on them or only what is shown of it.
    count = 1
    moves = False
    #: Whether ``place`` is a time, or a frequency, or one of a few cycles a record; whether the force's channel has it.
    timed = False
    tonal = False
    slow = False
    forced = False

    @abstractmethod
    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """The segment as a sound chain would have recorded it."""

    def shown(self, made: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """(n,) what the chain shows of a response (n,)."""
        return made

    def scale(self, segment: Segment) -> float:
        """Size of a hundredth of the motion, for finite differences."""
        return 1e-2

    @abstractmethod
    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """Kind, place and size in words."""


def sizes_of(faults: Sequence[Fault], offsets: np.ndarray) -> list[np.ndarray]:
    """Sizes of each fault, which stand last among the offsets (offsets,) of a state; or standard errors of both."""
    counts = [fault.count for fault in faults]
    return [offsets[a:b] for a, b in pairwise(len(offsets) - sum(counts) + np.cumsum([0, *counts]))]


#: The faults of one recording, each with its sizes.
Sized = Sequence[tuple[Fault, np.ndarray]]


def meant(segment: Segment, faults: Sized) -> Segment:
    """The segment as a sound chain would have recorded it."""
    for fault, sizes in faults:
        segment = fault.meant(segment, sizes)
    return segment


def shown(raw: np.ndarray, segment: Segment, faults: Sized, sides: Sides | None = None) -> np.ndarray:
    """(n,) what the chain shows of a segment's response (n,), the other sides of its jumps in their place."""
    made = raw
    for fault, sizes in faults:
        made = fault.shown(made, segment, sizes)
    if faults and sides is not None and sides.at.size:
        factor = np.ones(raw.size)
        for fault, sizes in faults:
            factor *= fault.shown(np.ones(raw.size), segment, sizes) - fault.shown(np.zeros(raw.size), segment, sizes)
        sides.shown = made[sides.at] + factor[sides.at] * (sides.shown - raw[sides.at])
        sides.derivatives = sides.derivatives * factor[sides.at]
    return made
