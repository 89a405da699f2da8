"""Recordings of a command, read with each note on them said."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..recording import Recording


def read_all(files: tuple[Path, ...], options: dict[str, Any], say: Callable[[str], None]) -> list[Recording]:
    """The recordings, all of a file that holds several, each note on them said."""
    from ..recording import recordings_of

    recordings = recordings_of(files, **options)
    for recording in recordings:
        for note in recording.notes:
            say(f"note: {note}")
    return recordings
