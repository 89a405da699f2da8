"""This side's ends of the pipes to a process that may stop, or hand its own ends on to processes that outlive it.

Such an end is closed neither by the other process's end nor, while another thread reads it, by a call of close: a
buffered stream is locked for as long as it is read. So no call here waits in the system for longer than a moment.
Where pipes cannot be waited for with a time limit (Windows, where ends are not handed on either), they are plain ones.
"""

from __future__ import annotations

import contextlib
import os
import select
import time
from collections.abc import Callable

#: Longest wait in the system, s; what has to be noticed meanwhile is looked at then.
MOMENT = 0.2
_PLAIN = os.name != "posix"


class Reader:
    """The reading end; ``read`` is called by one thread, ``end`` by any other.

    Args:
        descriptor: open; the thread that reads closes it.

    Attributes:
        ended: whether ``end`` was called.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor, self.ended = descriptor, False

    def read(self, count: int) -> bytes:
        """The next bytes: ``count``, or fewer where the other side has closed or ``end`` was called.

        Raises:
            OSError: as the system refuses.
        """
        parts = bytearray()
        while len(parts) < count and not self.ended:
            if not _PLAIN and not select.select([self._descriptor], [], [], MOMENT)[0]:
                continue
            part = os.read(self._descriptor, min(count - len(parts), 1 << 20))
            if not part:
                break
            parts += part
        return bytes(parts)

    def end(self) -> None:
        """Let ``read`` return within a moment."""
        self.ended = True

    def close(self) -> None:
        """Close the descriptor: by the thread that reads, when it reads no more."""
        with contextlib.suppress(OSError):
            os.close(self._descriptor)


class Writer:
    """The writing end.

    Args:
        descriptor: open; it is closed by ``close``.
        given_up: asked while the other side takes nothing; true ends the writing.
    """

    def __init__(self, descriptor: int, given_up: Callable[[], bool]) -> None:
        self._descriptor, self._given_up = descriptor, given_up
        if not _PLAIN:
            os.set_blocking(descriptor, False)

    def write(self, content: bytes, limit: float) -> bool:
        """Write all of it.

        Args:
            content: what to write.
            limit: longest time, s, in which the other side takes nothing.

        Returns:
            Whether all was taken: False where it takes nothing for so long, or was given up.

        Raises:
            OSError: the other side has closed.
        """
        rest, taken = memoryview(content), time.monotonic()
        while rest:
            if not _PLAIN and not select.select([], [self._descriptor], [], MOMENT)[1]:
                if self._given_up() or time.monotonic() - taken > limit:
                    return False
                continue
            with contextlib.suppress(BlockingIOError):
                rest = rest[os.write(self._descriptor, rest) :]
                taken = time.monotonic()
        return True

    def close(self) -> None:
        """Close the descriptor."""
        with contextlib.suppress(OSError):
            os.close(self._descriptor)
