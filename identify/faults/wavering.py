"""A recorder whose speed goes up and down: a fault of a recording."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..problem.chain import Fault
from ..problem.segments import Segment
from .fault import moved_in_time, times_of, tone, with_error


class Wavering(Fault):
    """Both channels run ahead of the file's times, and behind, by a sine of one frequency; sine and cosine in s."""

    count = 2
    moves = tonal = slow = True

    def _ahead(self, times: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """(n,) s by which what the file has at some times is later; nothing where the segment begins."""
        return tone(times, self.place, sizes) - tone(np.array(segment.time), self.place, sizes)

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``: the force as it was at even times."""
        force = segment.force
        if force is None:
            return segment
        times = segment.time + np.arange(len(force.pieces) + 1) * segment.dt / force.fine
        # what the file has at t was at t + ahead(t); the file's time of an even one follows by repetition
        ahead = self._ahead(times - self._ahead(times, segment, sizes), segment, sizes)
        return replace(segment, force=moved_in_time(force, ahead, segment.dt))

    def shown(self, made: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Fault``."""
        from scipy.interpolate import CubicSpline

        if not np.all(np.isfinite(made)):
            return made
        times = times_of(segment)[: made.size]
        return CubicSpline(times, made)(np.clip(times + self._ahead(times, segment, sizes), times[0], times[-1]))

    def scale(self, segment: Segment) -> float:
        """See ``Fault``; in seconds."""
        return 1e-2 / segment.pace

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, unit: str, force_unit: str) -> str:
        """See ``Fault``."""
        size = float(np.hypot(*sizes))
        share = 2 * np.pi * self.place
        return (
            f"its clock wavers by {with_error(100 * share * size, 100 * share * float(np.max(errors)))} %, "
            f"{self.place:.3g} times a second: the recorder's speed or its sampling is uneven; record it with a steady "
            "clock, or leave it out"
        )
