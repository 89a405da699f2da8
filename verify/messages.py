"""What this process and that of an FMU say to each other: a head as JSON, and numbers as they are.

Neither side runs what the other says: there are no pickles here.
"""

from __future__ import annotations

import json
import struct
from typing import Any, BinaryIO, Protocol

_SIZES = struct.Struct("<QQ")
_LONGEST_HEAD = 64 * 1024**2
_LONGEST_NUMBERS = 16 * 1024**3


class Readable(Protocol):
    """What gives the next ``count`` bytes, or fewer at its end."""

    def read(self, count: int, /) -> bytes:
        """The bytes."""
        ...


def packed(head: dict[str, Any], numbers: bytes = b"") -> bytes:
    """One message as bytes."""
    text = json.dumps(head).encode()
    return _SIZES.pack(len(text), len(numbers)) + text + numbers


def send(stream: BinaryIO, head: dict[str, Any], numbers: bytes = b"") -> None:
    """Send one message."""
    stream.write(packed(head, numbers))
    stream.flush()


def receive(stream: Readable) -> tuple[dict[str, Any], bytes] | None:
    """The next message; None where the other side has gone, or says what is no message."""
    sizes = stream.read(_SIZES.size)
    if len(sizes) < _SIZES.size:
        return None
    length, count = _SIZES.unpack(sizes)
    if length > _LONGEST_HEAD or count > _LONGEST_NUMBERS:
        return None
    text, numbers = stream.read(length), stream.read(count)
    try:
        head = json.loads(text)
    except ValueError:
        return None
    return (head, numbers) if isinstance(head, dict) and len(numbers) == count else None
