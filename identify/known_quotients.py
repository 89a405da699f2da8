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
    size = max(float(np.max(quotient)), -float(np.min(quotient))) or 1.0
    return np.divide(quotient, size, out=np.empty(quotient.size, np.float32), casting="same_kind"), size


def restore(known: Kept, out: np.ndarray) -> None:
    """Put what was kept into an array (n,)."""
    np.multiply(known[0], known[1], out=out)
