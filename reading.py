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
    with Path(path).open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"more than {most / 1e6:g} MB", str(path))
    return content
