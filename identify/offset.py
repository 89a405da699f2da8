"""What a sensor shows at zero."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Offset:
    """What a sensor shows at zero, all through one recording: of the ``response`` or of the ``force``.

    ``scale`` is its size for finite differences, ``guess`` where the search begins.
    """

    recording: int
    channel: str
    scale: float
    guess: float = 0.0


@dataclass(frozen=True)
class FoundOffset:
    """An offset that stands out: of which recording and channel, its value and its standard error."""

    recording: int
    channel: str
    value: float
    std: float
