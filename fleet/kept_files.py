"""The files of an entry: whether they are those that were written, and whether their places can be written again."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from ..errors import BadInput
from ..files.reading import content_of
from .sealed_json import digest

#: The one folder in an entry's.
DIAGNOSIS = "diagnosis"
#: More than any file of an entry: its pages are some MB.
_MOST_BYTES = 500_000_000


def leads_out(name: str) -> bool:
    """Whether a name is none of a file below a folder: absolute, with ``..`` or a drive, or empty."""
    path = PurePosixPath(name)
    return not path.parts or path.is_absolute() or ".." in path.parts or any(c in name for c in "\\:\0")


def changed_file(place: Path, files: Mapping[str, str]) -> str | None:
    """What is wrong with the files below a folder, in words; None where all are as their hashes say.

    Args:
        place: the entry's folder.
        files: hash of each by its name below that.
    """
    for name, known in files.items():
        if leads_out(name):
            return f"{name!r} leads out of its folder"
        try:
            if any(step.is_symlink() for step in (place / name, *(place / name).parents[: len(Path(name).parts)])):
                return f"{name} is a link"
            if digest(content_of(place / name, _MOST_BYTES)) != known:
                return f"{name} was changed"
        except (OSError, ValueError) as problem:
            return f"{name} cannot be read ({getattr(problem, 'strerror', None) or problem})"
    return None


def check_writable(place: Path, lock: Path) -> None:
    """See that nothing but regular files and plain folders lies where an entry is written.

    Raises:
        BadInput: where a link does, which would be followed, or a folder in a file's place.
    """
    found = [place, lock]
    if place.is_dir() and not place.is_symlink():
        found += [Path(one) for one in os.scandir(place)]
        found += [Path(one) for folder in found[2:] if folder.is_dir() for one in os.scandir(folder)]
    for one in found:
        if not os.path.lexists(one):
            continue
        mode = one.lstat().st_mode
        is_folder = one in (place, place / DIAGNOSIS)
        if not (stat.S_ISDIR(mode) if is_folder else stat.S_ISREG(mode)):
            kind = "a link" if stat.S_ISLNK(mode) else "a folder" if stat.S_ISDIR(mode) else "no regular file"
            raise BadInput(f"{one}: is {kind}, where dashpot batch keeps its own; remove it and run again")
