"""The truth of a suite, sealed: written once, known by its SHA-256, opened only where that is still the same."""

from __future__ import annotations

import gzip
import hashlib
import json
from pathlib import Path
from typing import Any

NAME = "truth.sealed"


class SealBroken(Exception):
    """The file is not the one whose hash was given."""


def seal(path: Path, truth: dict[str, Any]) -> str:
    """Write the truth as gzipped JSON, the same truth as the same bytes, and give its SHA-256."""
    text = json.dumps(truth, sort_keys=True, indent=1)
    path.write_bytes(gzip.compress(text.encode(), mtime=0))
    return sha256(path)


def sha256(path: Path) -> str:
    """Give the SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def open_sealed(path: Path, expected: str) -> dict[str, Any]:
    """Read the truth back; raises SealBroken where the file's SHA-256 is not `expected`."""
    content = path.read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    if digest != expected.strip().lower():
        raise SealBroken(
            f"{path}: its SHA-256 is {digest}, not {expected}; the truth was changed after the suite was made"
        )
    return json.loads(gzip.decompress(content))
