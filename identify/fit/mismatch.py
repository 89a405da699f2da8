"""What a mismatch tells, of which no sample is a witness of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..problem.segments import Segment
from .limits import CYCLES, HARMONICS


def gain_of_mismatch(before: Sequence[np.ndarray], after: Sequence[np.ndarray], segments: Sequence[Segment]) -> float:
    """Gain of log-likelihood from one model to another, both of which leave a mismatch.

    A likelihood that counts every sample is too sure of itself there (White 1982): a stretch of some cycles tells no
    more than the amplitude and phase of the motion's harmonics.

    Args:
        before, after: of each segment, what the two leave.
        segments: of the recordings.
    """
    tiny = np.finfo(float).tiny
    return sum(
        HARMONICS * float(np.log(max(np.mean(old**2), tiny) / max(np.mean(new**2), tiny)))
        for segment, left, leaves in zip(segments, before, after, strict=True)
        for old, new in zip(_stretches(left, segment), _stretches(leaves, segment), strict=True)
    )


def _stretches(residual: np.ndarray, segment: Segment) -> list[np.ndarray]:
    count = max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi * CYCLES)))
    return np.array_split(residual, count)
