"""What a result is kept under: a hash of all that it follows from."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import stat
from pathlib import Path

from .. import __version__
from ..errors import BadInput
from ..recording.beside_form import NAME
from ..recording.read import place_of
from .manifest import Entry


def key_of(entry: Entry) -> str:
    """32 hexadecimal digits that change where the result of an entry may.

    They stand for the contents of recordings, held-out recordings, files beside these that say how they are read, start
    model and law files, how they are read and identified, the names that the result bears, and the version of dashpot.
    Where files lie, and what the manifest says of rig, state and time, makes no other result.

    Raises:
        BadInput: where a file cannot be read.
    """
    content = {
        "software": __version__,
        "name": entry.name,
        "recordings": [_file(name) for name in entry.recordings],
        "holdout": [_file(name) for name in entry.holdout],
        "reading": dict(entry.reading),
        "how": dict(entry.how),
        "start": None if entry.start is None else _digest(Path(entry.start)),
        "laws": [_digest(Path(law)) for law in entry.laws],
    }
    beside = [_beside(name) for name in (*entry.recordings, *entry.holdout)]
    content |= {"beside": beside} if any(beside) else {}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]


def _file(name: str) -> tuple[str, str]:
    """The name of a recording, with the record that is meant, and its content."""
    path, _, record = name.partition("#")
    whole = Path(name) if Path(name).exists() else Path(path)
    return f"{whole.name}#{record}" if record and whole == Path(path) else whole.name, _digest(whole)


def _beside(name: str) -> str:
    """The content of a file that says how a recording beside it is read; "" where there is none."""
    place = place_of(name)[0].parent / NAME
    return _digest(place) if place.is_file() else ""


def _digest(path: Path) -> str:
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would be waited for
            raise OSError(errno.EINVAL, "is no regular file", os.fspath(path))
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError) as problem:
        raise BadInput(
            f"{path}: cannot be read ({getattr(problem, 'strerror', None) or problem}); check the path"
        ) from None
