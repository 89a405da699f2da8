"""Whether one of several recordings is of another rig: it agrees with a model of its own, and the others with theirs.

What the family lacks makes recordings of different levels disagree too. So the others must be two at least, and agree
with one model to their noise; the one must agree with its own to its noise; and its frequency must be another by more
than a lab cannot keep constant, or, where the others move as far, any of its parameters by more than its errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ...errors import BadInput
from ...recording.recording import Recording
from ..fit.reported_result import Fit
from ..signals.limits import SEVERAL
from ..signals.odds import ABOVE_NOISE, BEYOND_ERRORS
from ..start.start import hilbert_start
from .limits import KEPT

Fitted = Callable[[Sequence[Recording]], Fit]


def stranger_among(recordings: Sequence[Recording], fitted: Fitted) -> tuple[int, str] | None:
    """The place of the recording of another rig among several, and what is said of it; None where there is none.

    Args:
        recordings: of which one model leaves more than noise.
        fitted: the fit of some of them alone, from starts of their own.
    """
    if len(recordings) < SEVERAL or (odd := _oddest(recordings)) is None:
        return None
    own = of_one_rig([recordings[odd]], fitted)
    words = None if own is None else difference_in_words(odd, own, recordings, fitted)
    return None if words is None else (odd, words)


def of_one_rig(recordings: Sequence[Recording], fitted: Fitted) -> Fit | None:
    """The fit of some recordings alone where it leaves no more than noise; else None."""
    try:
        fit = fitted(recordings)
    except BadInput:
        return None
    return fit if max(stretch.over_noise for stretch in fit.segments) <= ABOVE_NOISE else None


def difference_in_words(
    odd: int, own: Fit, recordings: Sequence[Recording], fitted: Fitted, *, alike: bool = False
) -> str | None:
    """What is said of a recording whose rig is another than that of the others; None where it is not.

    Args:
        odd: its place.
        own: its fit, which leaves no more than noise.
        recordings: all of them.
        fitted: the fit of some of them alone.
        alike: whether the others move as far and are driven as hard, so that no lack of physics makes it differ; then
            it is one in another parameter too.
    """
    if len(recordings) < SEVERAL:
        return None
    theirs = of_one_rig([recording for i, recording in enumerate(recordings) if i != odd], fitted)
    if theirs is None:
        return None
    here, there = own.oscillator.omega0, theirs.oscillator.omega0
    apart = abs(math.log(here.value / there.value))
    error = math.hypot((here.std or 0.0) / here.value, (there.std or 0.0) / there.value)
    if apart >= max(KEPT, BEYOND_ERRORS * error):
        values = (f"{here.value / (2 * math.pi):.4g} Hz", f"{there.value / (2 * math.pi):.4g} Hz")
    else:
        values = _farthest(own, theirs) if alike else None
    if values is None:
        return None
    return (
        f"it agrees with one rig, {values[0]}, all others with another, {values[1]}, each to its noise, and not "
        "together: it is of another rig, or the rig was changed between; leave it out"
    )


def _farthest(own: Fit, theirs: Fit) -> tuple[str, str] | None:
    """The parameter in which two fits differ by most of its errors, in words of each; None where none does beyond."""
    rivals = theirs.oscillator.parameters()
    pairs = {name: (p, rivals[name]) for name, p in own.oscillator.parameters().items() if name in rivals}
    apart = {
        name: abs(p.value - q.value) / math.hypot(p.std, q.std) for name, (p, q) in pairs.items() if p.std and q.std
    }
    name = max(apart, key=lambda key: apart[key], default=None)
    if name is None or apart[name] < BEYOND_ERRORS:
        return None
    here, there = (f"{name} {p.value:.4g} {p.unit}" for p in pairs[name])
    return here, there


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
