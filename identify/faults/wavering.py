"""A recorder whose speed goes up and down: a fault of a recording.

Where a clock may waver: frequencies at which what is left goes with the motion as a wave of the times makes it.

What is recorded too late by a little is off by its rate times that, and where a force went through the same recorder,
by what the rig makes of that, which is the motion itself, wave for wave. So of each frequency the motion and its rate,
times sine and cosine, are held against what is left (least squares, frequency by frequency: Lomb 1976), beside a delay
and a drift of the clock, which have no frequency. Where the motion is large for a while only, no window is needed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...recording.as_recorded import InUnit
from ..problem.chain import Fault
from ..problem.segments import Segment
from ..signals.registry import budget, numerics
from .fault import moved_in_time, times_of, tone, with_error

_SAMPLES = numerics(12, "samples a cycle", why="of the motion; three harmonics")
_CYCLES = budget(400, "cycles in a record", why="faster waves are lines, as hum is")
_FINE = numerics(4, "frequencies a line width", why="so that no peak falls between two")
_PEAKS = budget(2, "peaks", why="the highest are tried")
_SLOWEST = numerics(3, "cycles in a record", why="a slower wave is asked for by itself: it is no peak")


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

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        size = float(np.hypot(*sizes))
        share = 2 * np.pi * self.place
        return (
            f"its clock wavers by {with_error(100 * share * size, 100 * share * float(np.max(errors)))} %, "
            f"{self.place:.3g} times a second: the recorder's speed or its sampling is uneven; record it with a steady "
            "clock, or leave it out"
        )


def waves_of_time(residual: np.ndarray, segment: Segment) -> list[float]:
    """Frequencies, Hz, at which a clock may waver; none where the motion has few cycles.

    Args:
        residual: what a model leaves (n,) of a segment.
        segment: it.
    """
    every = max(1, int(2 * np.pi / (segment.pace * segment.dt * _SAMPLES)))
    motion = segment.response - residual
    rate = np.gradient(motion, segment.dt)[::every] / segment.pace
    motion, left = motion[::every] - np.mean(motion), residual[::every]
    span = segment.n * segment.dt
    phase = 2 * np.pi * np.arange(left.size) * every * segment.dt / span
    moved = np.stack([motion, rate])
    # a delay and a drift, and what the parameters do, which is the same
    known = np.linalg.qr(np.concatenate([moved, moved * phase]).T)[0]
    left = left - known @ (known.T @ left)
    most = min(segment.pace * span / (2 * 2 * np.pi), _CYCLES)
    waves = np.arange(_SLOWEST, most, 1.0 / _FINE)
    gains = np.array([_explained(left, moved, known, wave * phase) for wave in waves])
    inner = np.flatnonzero((gains[1:-1] >= gains[:-2]) & (gains[1:-1] > gains[2:])) + 1 if gains.size > 2 else []
    return [float(waves[at] / span) for at in sorted(inner, key=lambda at: -gains[at])[:_PEAKS]]


def _explained(left: np.ndarray, moved: np.ndarray, known: np.ndarray, turn: np.ndarray) -> float:
    """By how much less is left, in squares, with the motion and its rate times sine and cosine of (n,)."""
    columns = np.concatenate([moved * np.sin(turn), moved * np.cos(turn)])
    columns = columns - (columns @ known) @ known.T
    toward = columns @ left
    return float(toward @ np.linalg.lstsq(columns @ columns.T, toward, rcond=1e-10)[0])
