"""Both sides of the jumps in a response, as a run of the engine hands them out."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

import numpy as np


class _SidesShown(ctypes.Structure):
    """``dp_sides_shown`` of engine/record.c."""

    _fields_: ClassVar = [
        *((name, ctypes.c_long) for name in ("count", "room", "width")),
        ("at", ctypes.POINTER(ctypes.c_long)),
        ("shown", ctypes.POINTER(ctypes.c_double)),
    ]


class Sides:
    """What samples beside a jump of the response are on its other side; filled by the run that it is given to.

    A sample with a jump before it and one behind it is there once for each way in which its surfaces may be.

    Attributes:
        at: (m,) which samples.
        shown: (m,) response there.
        derivatives: (k, m) its derivatives, where the run had some.
    """

    def __init__(self) -> None:
        self.at = np.zeros(0, int)
        self.shown = np.zeros(0)
        self.derivatives = np.zeros((0, 0))


def done(library: ctypes.CDLL) -> Any:
    """What gives back the memory that a run of the engine took for sides."""
    library.dp_sides_done.argtypes = [ctypes.POINTER(_SidesShown)]
    return library.dp_sides_done


@contextmanager
def filled(given_back: Any, sides: Sides | None, asked: Any, count: int) -> Iterator[None]:
    """Have a run fill ``sides``, with ``count`` derivatives.

    Args:
        given_back: see ``done``.
        sides: None leaves them out.
        asked: ``dp_recording`` of engine/record.c.
        count: of unknowns that derivatives are taken by.

    Raises:
        MemoryError: where there is none for them.
    """
    if sides is None:
        yield
        return
    shown = _SidesShown(width=1 + count)
    asked.sides = ctypes.addressof(shown)
    try:
        yield
        if shown.room < 0:
            raise MemoryError("no memory is left for the other sides of the jumps in a response")
        if shown.count:
            sides.at = np.ctypeslib.as_array(shown.at, (shown.count,)).astype(int)
            made = np.ctypeslib.as_array(shown.shown, (shown.count, 1 + count)).T.copy()
            sides.shown, sides.derivatives = made[0], made[1:]
    finally:
        given_back(ctypes.byref(shown))
