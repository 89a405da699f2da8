"""Zip archives that are the same bytes for the same contents."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

from ..files.writing import write

_EPOCH = (1980, 1, 1, 0, 0, 0)  # the first date that zip can hold
_UNIX = 3
_REGULAR_FILE = 0o100644 << 16


def write_archive(path: Path, entries: Mapping[str, bytes]) -> Path:
    """Write a zip archive with sorted names and fixed dates; it appears whole or not at all.

    Args:
        path: where to write; missing folders are made.
        entries: name inside (forward slashes) to contents.

    Raises:
        BadInput: where the folder cannot be written.
    """
    write(path, archived(entries))
    return path


def archived(entries: Mapping[str, bytes]) -> bytes:
    """The archive itself."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(entries):
            info = zipfile.ZipInfo(name, _EPOCH)
            info.create_system = _UNIX
            info.external_attr = _REGULAR_FILE
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, entries[name])
    return content.getvalue()
