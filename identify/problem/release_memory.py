"""Long arrays go back to the system as soon as they are free.

The C library keeps what it may need again: of arrays of a megabyte to thirty, which come and go by the dozen in a long
fit, more than is in use. Told of a size from which on each block is mapped by itself, it gives that back at once. Where
the library is not glibc nothing happens, and nothing is lost by it.
"""

from __future__ import annotations

import ctypes
from functools import cache

from ..signals.registry import budget

_MAPPED_FROM = budget(2**22, "bytes", why="of half a million samples; shorter blocks cost less where they are kept")


@cache
def give_back_at_once() -> None:
    """From here on, in this process."""
    try:
        library = ctypes.CDLL(None)
        for size in (-1, -3):  # M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of malloc.h
            library.mallopt(size, _MAPPED_FROM)
        library.malloc_trim(0)
    except (AttributeError, OSError, TypeError):  # another C library, or none that can be asked (Windows)
        return
