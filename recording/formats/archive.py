"""Zip archives of limited size, which NPZ and Excel files are."""

from __future__ import annotations

import io
import zipfile

from ..content import too_large

_MOST_ENTRIES = 10_000


def opened(where: str, content: bytes, most: float) -> zipfile.ZipFile:
    """An archive that unpacks to at most ``most`` MB; Python unpacks no entry beyond the size that it declares.

    Raises:
        BadInput: it holds more.
        zipfile.BadZipFile: it is none, or damaged.
    """
    archive = zipfile.ZipFile(io.BytesIO(content))
    entries = archive.infolist()
    if len(entries) > _MOST_ENTRIES or sum(entry.file_size for entry in entries) > most * 1e6:
        raise too_large(where, most)
    return archive
