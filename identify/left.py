"""What a fitted model leaves of its recordings, by stretch and as a whole, and whether that is much."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..model.fit_state import FOLLOWS, LACKING, Left
from ..model.left import share_of_motion, times_the_noise
from ..recording.recording import Recording
from .fit.limits import QUIET
from .fit.reported_result import Fit, SegmentFit


def left_of_recording(fit: Fit, index: int) -> Left | None:
    """What the model leaves of a recording, its stretches together, simulated freely; None where none was fitted."""
    parts = [s for s in fit.segments if s.segment.recording == index]
    return left_of_parts(parts) if parts else None


def left_of_parts(parts: Sequence[SegmentFit]) -> Left:
    """What the model leaves of stretches, all together, simulated freely; to the four digits of the model file."""
    left = [part.left for part in parts]
    measured = [np.asarray(part.segment.response, float) for part in parts]
    share, times = share_of_motion(left, measured), times_the_noise(left, [part.noise for part in parts])
    return Left("", float(f"{share:.4g}"), float(f"{times:.4g}"))


def stretch_words(part: SegmentFit, fit: Fit, recordings: Sequence[Recording]) -> str:
    """A stretch by its recording, and by its times where that has several: what one leaves is not the whole."""
    segment = part.segment
    name = recordings[segment.recording].name
    if sum(other.segment.recording == segment.recording for other in fit.segments) == 1:
        return name
    return f"{name}, where it is worst, {segment.time:.4g} to {segment.time + segment.n * segment.dt:.4g} s"


def has_lost(part: SegmentFit, fit: Fit) -> bool:
    """Whether the simulation does not follow the motion of a segment that carries some, noise aside."""
    off = part.nrmse > FOLLOWS and part.over_noise > LACKING
    return off and not is_quiet(part.segment.response, fit)


def beside_noise(part: SegmentFit) -> float:
    """What a simulation leaves beside noise, over the motion's standard deviation."""
    return part.nrmse * float(np.sqrt(max(1.0 - part.over_noise**-2, 0.0)))


def is_quiet(response: np.ndarray, fit: Fit) -> bool:
    """Whether a motion (n,) is far below the loudest of the fit."""
    loudest = max(float(np.std(s.segment.response)) for s in fit.segments)
    return float(np.std(response)) < QUIET * loudest
