"""Files that are read whole: regular ones of a size that is limited, so that no pipe and no device is waited for."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path


def content_of(path: str | os.PathLike[str], most: int) -> bytes:
    """The bytes of a file.

    Args:
        path: its place; links are followed.
        most: how many bytes it may have.

    Raises:
        OSError: where it cannot be read, is no regular file, or holds more; ``strerror`` says which.
        ValueError: where the name holds a null byte.
    """
    mode = Path(path).stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # what opening a folder gives says enough
        raise OSError(errno.EINVAL, "a pipe or a device, which may never end", str(path))
    with open(path, "rb", opener=at_once) as file:
        content = file.read(most + 1)
    if content is None:  # what the kernel shows as a file and lets wait, such as /proc/kmsg
        raise OSError(errno.EINVAL, "a pipe or a device, which may never end", str(path))
    if len(content) > most:
        raise OSError(errno.EFBIG, f"more than {most / 1e6:g} MB", str(path))
    return content


def at_once(path: str, flags: int) -> int:
    """A file opened so that reading never waits for what is not there yet."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
