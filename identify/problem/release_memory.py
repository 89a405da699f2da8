"""Memory that was freed goes back to the system between the stages of a long fit.

The C library keeps what it may need again: of arrays of a megabyte to thirty, which come and go by the dozen in a long
fit, half as much again as is in use. Where the library is not glibc nothing happens, and nothing is lost by it.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache


@cache
def _trim() -> Callable[[int], int] | None:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):  # another C library, or none that can be asked (Windows)
        return None


def give_back() -> None:
    """Give back what is free; costs milliseconds."""
    trim = _trim()
    if trim is not None:
        trim(0)
