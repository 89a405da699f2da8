"""An envelope that beats because several modes ring at once: it rises again and again, and yet nothing pushes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .envelope import Envelope, smooth

#: An envelope that rises by a quarter is pushed, or it beats.
_RISES = 1.25
#: Beats follow one another at equal intervals, within this part; a hand that pushes again does not.
_EVEN = 0.2
#: So many crests show an interval twice.
_FEWEST_CRESTS = 3


def without_beats(envelope: Envelope) -> tuple[Envelope, bool]:
    """The envelope's mean over a beat where it beats, and whether it does.

    Two modes that decay beat in crests at even intervals, each lower than the one before.
    """
    crests = _crests(envelope)
    gaps = np.diff(crests)
    heights = envelope.size[crests]
    if crests.size < _FEWEST_CRESTS or np.ptp(gaps) > _EVEN * np.mean(gaps) or np.any(np.diff(heights) >= 0):
        return envelope, False
    # a Blackman kernel of three beats has no transmission at their frequency
    mean = np.sqrt(np.maximum(smooth(envelope.size**2, round(3 * float(np.mean(gaps)))), 0))
    return replace(envelope, size=mean), True


def _crests(envelope: Envelope) -> np.ndarray:
    """Highest samples (m,) between falls and rises by a quarter, above the noise; the record's first sample is none."""
    step = max(1, envelope.period // 8)
    size = envelope.size[::step]
    crests: list[int] = []
    high = low = 0
    falls = True
    for i, level in enumerate(size.tolist()):
        if falls:
            low = i if level < size[low] else low
            if level > max(_RISES * size[low], 2 * envelope.floor):
                falls, high = False, i
        else:
            high = i if level > size[high] else high
            if level < size[high] / _RISES:
                crests.append(high)
                falls, low = True, i
    return np.array(crests, int) * step
