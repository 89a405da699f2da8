"""The JSON of a fleet: written with a hash of itself, read as nothing but plain data that is as it was written.

The hash finds what was changed by accident or by hand, at any byte. It is no signature: who makes a whole new file can
make its hash too, so what is read is held against its form as well.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

_HASH = "sha256"
#: The deepest that a fleet's files go is 5: entries, their recordings, the numbers of one.
MOST_DEPTH = 16
#: A whole number of JSON that a double holds as it is has at most 16 digits.
_MOST_DIGITS = 16


def plain(content: bytes) -> Any:
    """Plain data from JSON in UTF-8.

    Raises:
        ValueError: it is none; a number is not finite or longer than a double; a name stands twice in one object; it
            is deeper than ``MOST_DEPTH``; or a text cannot be written again.
    """
    try:
        found = json.loads(
            content.decode("utf-8"),
            parse_constant=_not_finite,
            parse_float=_finite,
            parse_int=_whole,
            object_pairs_hook=_distinct,
        )
    except RecursionError:
        raise ValueError("it is too deep") from None
    if _depth(found) > MOST_DEPTH:
        raise ValueError("it is too deep")
    return found


def sealed(document: Mapping[str, Any]) -> str:
    """The text that is written: one line of JSON, its last member the hash of the others."""
    text = _text(document)
    return _text({**document, _HASH: hashlib.sha256(text.encode()).hexdigest()}) + "\n"


def unsealed(content: bytes) -> dict[str, Any]:
    """What was sealed; raises ValueError where it is not as ``sealed`` wrote it, to the byte."""
    document = plain(content)
    if not isinstance(document, dict) or document.pop(_HASH, None) is None or sealed(document).encode() != content:
        raise ValueError("it is not as it was written")
    return document


def digest(content: bytes) -> str:
    """The hash by which a file is known."""
    return hashlib.sha256(content).hexdigest()


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def _not_finite(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _finite(word: str) -> float:
    value = float(word)
    if not math.isfinite(value):
        raise ValueError(f"{word[:20]} is too large")
    return value


def _whole(word: str) -> int:
    if len(word.lstrip("-")) > _MOST_DIGITS:
        raise ValueError(f"{word[:20]} is too large")
    return int(word)


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a name stands twice")
    return found


def _depth(data: Any) -> int:
    """How deep lists and objects lie in one another; a text that is no Unicode raises ValueError on the way."""
    level, depth = [data], 0
    while level:
        depth += 1
        if depth > MOST_DEPTH:
            return depth
        inner: list[Any] = []
        for one in level:
            if isinstance(one, dict):
                inner += [*one, *one.values()]
            elif isinstance(one, list):
                inner += one
            elif isinstance(one, str):
                one.encode()  # a lone surrogate cannot be written
        level = inner
    return depth - 1
