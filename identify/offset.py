"""What a sensor shows at zero, and how fast that drifts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .segments import Segment


@dataclass(frozen=True)
class Offset:
    """What a sensor shows at zero, all through one recording: of the ``response`` or of the ``force``.

    The channel ``drift`` is that of the response, by which it moves in a second, about the time ``middle`` (s).
    ``scale`` is its size for finite differences, ``guess`` where the search begins, ``taken`` what of it was taken off
    the recording before.
    """

    recording: int
    channel: str
    scale: float
    guess: float = 0.0
    middle: float = 0.0
    taken: float = 0.0


@dataclass(frozen=True)
class FoundOffset:
    """An offset that stands out: of which recording and channel, its value and its standard error; see ``Offset``."""

    recording: int
    channel: str
    value: float
    std: float
    middle: float = 0.0


def zeros_along(offsets: Sequence[Offset], values: np.ndarray, segment: Segment) -> tuple[np.ndarray, float]:
    """What the sensors show at zero along a segment: the response's, () or where it drifts (n,), and the force's."""
    shown = np.zeros(())
    pushes = 0.0
    for offset, value in zip(offsets, values, strict=True):
        if offset.recording != segment.recording:
            continue
        if offset.channel == "response":
            shown = shown + float(value)
        elif offset.channel == "drift":
            shown = shown + float(value) * (segment.time + np.arange(segment.n) * segment.dt - offset.middle)
        else:
            pushes = float(value)
    return shown, pushes
