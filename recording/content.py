"""The bytes of a recording's file: a regular file of a size that is limited, unpacked where it is compressed."""

from __future__ import annotations

import errno
import gzip
import io
import stat
import zlib
from pathlib import Path

from ..errors import BadInput
from ..files.reading import at_once

#: The largest file that is read, unpacked, in MB: ten million samples as text. ``--max-size`` sets another.
MOST_MB = 500.0


def content_of(path: Path, most: float = MOST_MB) -> bytes:
    """The bytes of a file as it lies there, at most ``most`` MB.

    Raises:
        BadInput: where it is not there, no regular file, larger, or cannot be read.
    """
    try:
        found = path.stat()
        if stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path} is a folder, not a recording; name a file in it")
        if not stat.S_ISREG(found.st_mode):
            raise BadInput(f"{path} is a pipe or a device, which may never end; save it as a file first")
        if found.st_size > most * 1e6:
            raise too_large(str(path), most)
        with open(path, "rb", opener=at_once) as file:
            content = file.read(int(most * 1e6) + 1)
        if content is None:  # what the kernel shows as a file and lets wait, such as /proc/kmsg
            raise BadInput(f"{path} is a pipe or a device, which may never end; save it as a file first")
    except FileNotFoundError:
        raise BadInput(f"{path} does not exist; check the name and the folder") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        if getattr(error, "errno", None) == errno.ELOOP:
            raise BadInput(f"{path} is a link that leads back to itself; name the file that it is meant for") from None
        reason = getattr(error, "strerror", None) or error
        raise BadInput(f"{path} cannot be read ({reason}); check its permissions") from None
    if len(content) > most * 1e6:  # it grows while it is read
        raise too_large(str(path), most)
    return content


def unpacked(where: str, content: bytes, most: float = MOST_MB) -> bytes:
    """The content, unpacked where it is gzipped, at most ``most`` MB.

    Raises:
        BadInput: where it is damaged, or unpacks to more.
    """
    if content[:2] != b"\x1f\x8b":
        return content
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            plain = file.read(int(most * 1e6) + 1)
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise BadInput(f"{where} is a gzip file that is cut short or damaged; copy it again") from None
    if len(plain) > most * 1e6:
        raise too_large(where, most)
    return plain


def too_large(where: str, most: float) -> BadInput:
    """What is said of a file that holds more than ``most`` MB."""
    return BadInput(f"{where} holds more than {most:g} MB; record less at once, or raise the limit with --max-size")
