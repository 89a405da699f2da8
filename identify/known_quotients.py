"""Difference quotients of long segments at the last point of a search, which what comes after it asks for again.

Where a search has come to rest its offsets are judged there and its jumps are looked for, and a search by other noise
begins: the same runs of the model each time. They are kept in single precision: of responses that are good to 1e-12, a
quotient over a step of 1e-5 is good to 1e-7, and so is a number of that precision.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

#: One segment's quotient by one unknown: (n,) in single precision, and its size.
Kept = tuple[np.ndarray, float]


class KnownQuotients:
    """Those of one point; shared by all problems that are the same but for what is asked of them."""

    def __init__(self) -> None:
        self._point: tuple[Hashable, ...] = ()
        self._kept: dict[Hashable, Kept] = {}

    def at(self, point: tuple[Hashable, ...]) -> dict[Hashable, Kept]:
        """What is known at a point; what was known at another one is forgotten."""
        if point != self._point:
            self._point, self._kept = point, {}
        return self._kept


def kept(quotient: np.ndarray) -> Kept:
    """A quotient (n,) as it is kept."""
    size = float(np.max(np.abs(quotient))) or 1.0
    return (quotient / size).astype(np.float32), size


def restored(known: Kept) -> np.ndarray:
    """(n,) of what was kept."""
    made = known[0].astype(float)
    made *= known[1]
    return made
