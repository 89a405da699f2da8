"""What is known at the last point of a search, which comes to be asked for again: difference quotients above all.

Where a search has come to rest its offsets are judged there and its jumps are looked for, and a search by other noise
begins: the same runs of the model each time. They are kept in single precision: of responses that are good to 1e-12, a
quotient over a step of 1e-5 is good to 1e-7, and so is a number of that precision.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Generic, TypeVar

import numpy as np

#: One segment's quotient by one unknown: (n,) in single precision, and its size.
Kept = tuple[np.ndarray, float]
What = TypeVar("What")


class KnownAtPoint(Generic[What]):
    """What is known of one point; shared by all problems that are the same but for what is asked of them."""

    def __init__(self) -> None:
        self._point: tuple[Hashable, ...] = ()
        self._kept: dict[Hashable, What] = {}

    def at(self, point: tuple[Hashable, ...]) -> dict[Hashable, What]:
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


def put_quotient(
    moved: Callable[[float, np.ndarray], object],
    ahead: float,
    response: np.ndarray,
    residual: np.ndarray,
    out: np.ndarray,
) -> None:
    """Put a difference quotient into an array (n,); to the other side where ahead it is not finite, else zero.

    Args:
        moved: puts what the model shows with the unknown moved by a step into an array.
        ahead: the step.
        response: measured.
        residual: what the model leaves of it with the unknown where it is.
        out: where the quotient goes.
    """
    room = out if out.dtype == float else np.empty(out.size)
    for step in (ahead, -ahead):
        moved(step, room)
        with np.errstate(invalid="ignore", over="ignore"):  # where it does not simulate to its end
            room -= response
            room += residual
            room /= step
        if np.all(np.isfinite(room)):
            break
    else:
        room.fill(0.0)
    if room is not out:
        out[:] = room


def without_impossible(rows: np.ndarray, limits: Sequence[float]) -> None:
    """Leave out of derivatives (k, n), in their place, the samples at which one of the first goes beyond its limit."""
    large = [max(float(np.max(row)), -float(np.min(row))) > limit for row, limit in zip(rows, limits, strict=False)]
    beyond = [np.abs(row) > limit for row, limit, over in zip(rows, limits, large, strict=False) if over]
    if beyond:
        rows[:, np.any(beyond, axis=0)] = 0.0
