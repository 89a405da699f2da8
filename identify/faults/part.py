"""A part of a recording: some of the pieces that it is left out in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..problem.segments import Segment
from ..signals.registry import numerics

_PIECES = numerics(
    24, "pieces of a recording", why="none is shorter than a cycle, which has no amplitude to contradict anything"
)


@dataclass(frozen=True)
class Span:
    """What was fitted of a recording, from when to when, s, and how many pieces that makes."""

    recording: int
    begin: float
    end: float
    pieces: int

    def piece_of(self, segment: Segment) -> np.ndarray:
        """(n,) in which piece each sample of a segment of this recording is."""
        times = segment.time + np.arange(segment.n) * segment.dt
        at = ((times - self.begin) / (self.end - self.begin) * self.pieces + 1e-9).astype(int)
        return np.clip(at, 0, self.pieces - 1)


@dataclass(frozen=True)
class Part:
    """Pieces of a span, as a Python slice of them."""

    span: Span
    first: int
    last: int

    @property
    def recording(self) -> int:
        """Which it is a part of."""
        return self.span.recording

    @property
    def whole(self) -> bool:
        """Whether it is all of it."""
        return self.last - self.first == self.span.pieces

    @property
    def begin(self) -> float:
        """When it begins, s."""
        return self._edge(self.first)

    @property
    def end(self) -> float:
        """When it ends, s."""
        return self._edge(self.last)

    def holds(self, segment: Segment) -> np.ndarray:
        """(n,) which samples of a segment are in it."""
        if segment.recording != self.recording:
            return np.zeros(segment.n, bool)
        piece = self.span.piece_of(segment)
        return (piece >= self.first) & (piece < self.last)

    def apart_from(self, other: Part) -> bool:
        """Whether two parts have nothing in common but the one piece within which the one ends and the other begins."""
        if self.recording != other.recording:
            return True
        shared = min(self.last, other.last) - max(self.first, other.first)
        return shared <= (1 if min(self.last - self.first, other.last - other.first) > 1 else 0)

    @property
    def other_side(self) -> list[Part]:
        """What is left of its recording where that is all before it or all behind, with the piece between the two."""
        if self.whole or self.last - self.first == 1:
            return []
        if self.first == 0:
            return [Part(self.span, self.last - 1, self.span.pieces)]
        return [Part(self.span, 0, self.first + 1)] if self.last == self.span.pieces else []

    def _edge(self, piece: int) -> float:
        return self.span.begin + piece / self.span.pieces * (self.span.end - self.span.begin)


def spans_of(segments: Sequence[Segment]) -> list[Span]:
    """The span of each recording that was fitted."""
    spans = []
    for recording in sorted({segment.recording for segment in segments}):
        own = [segment for segment in segments if segment.recording == recording]
        begin, end = min(s.time for s in own), max(s.time + s.n * s.dt for s in own)
        cycles = int((end - begin) * own[0].pace / (2 * np.pi))
        spans.append(Span(recording, begin, end, max(1, min(_PIECES, cycles))))
    return spans


def parts_of(span: Span) -> list[Part]:
    """All runs of pieces of a span."""
    return [Part(span, first, last) for first in range(span.pieces) for last in range(first + 1, span.pieces + 1)]
