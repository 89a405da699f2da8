"""Whether one of several recordings is of another rig: it agrees with a model of its own, and the others with theirs.

What the family lacks makes recordings of different levels disagree too. So the others must be two at least, and agree
with one model to their noise; the one must agree with its own to its noise; and its frequency must be another by more
than a lab cannot keep constant.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..errors import BadInput
from ..recording.recording import Recording
from .delivered import Fit
from .odds import BEYOND_ERRORS
from .start import hilbert_start
from .weighed import ABOVE_NOISE

#: Physical limit: a natural frequency that differs by less than this part is one that a lab cannot keep constant.
KEPT = 1e-3
#: Two recordings that disagree do not say which of them is the stranger.
_FEWEST = 3


def stranger_among(
    recordings: Sequence[Recording], fitted: Callable[[Sequence[Recording]], Fit]
) -> tuple[int, str] | None:
    """The place of the recording of another rig among several, and what is said of it; None where there is none.

    Args:
        recordings: of which one model leaves more than noise.
        fitted: the fit of some of them alone, from starts of their own.
    """
    if len(recordings) < _FEWEST:
        return None
    odd = _oddest(recordings)
    if odd is None:
        return None
    others = [recording for i, recording in enumerate(recordings) if i != odd]
    try:
        theirs = fitted(others)
        if not _is_noise(theirs):
            return None
        own = fitted([recordings[odd]])
    except BadInput:
        return None
    here, there = own.oscillator.omega0, theirs.oscillator.omega0
    apart = abs(math.log(here.value / there.value))
    error = math.hypot((here.std or 0.0) / here.value, (there.std or 0.0) / there.value)
    if not _is_noise(own) or apart < max(KEPT, BEYOND_ERRORS * error):
        return None
    return (
        odd,
        f"it agrees with one rig, {here.value / (2 * math.pi):.4g} Hz, all others with "
        f"another, {there.value / (2 * math.pi):.4g} Hz, each to its noise, and not together: it is of another rig, "
        "or the rig was changed between; leave it out",
    )


def _oddest(recordings: Sequence[Recording]) -> int | None:
    """Index of the recording whose own frequency is farthest from that of the others; None where they have none."""
    logarithms = []
    for recording in recordings:
        try:
            logarithms.append(math.log(hilbert_start([recording]).omega0))
        except (BadInput, ValueError):
            return None
    apart = np.abs(np.array(logarithms) - np.median(logarithms))
    return int(np.argmax(apart)) if np.max(apart) > KEPT else None


def _is_noise(fit: Fit) -> bool:
    """Whether no more than noise is left in any stretch."""
    return max(stretch.over_noise for stretch in fit.segments) <= ABOVE_NOISE
