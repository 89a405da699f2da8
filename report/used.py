"""What of the recordings the fit used, what it did not, and why."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import full_stop, number
from .blocks import Block, Table

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..recording.recording import Recording

#: Words of the notes that say why something was not used.
_WHY = ("left out", "left aside", "not used", "is not used", "too short", "clipped", "noise alone")
#: So many stretches are named.
_SHOWN = 4
_FREE = "no free motion: at rest, being moved, or faded into the noise"
_DRIVEN = "left to the sides of jumps and damage, or too short to simulate"


def used_table(identification: Identification) -> list[Block]:
    """A row a recording: how much of it was fitted, where the rest lies, and why it was not."""
    rows = []
    notes = (*identification.notes, *(note for r in identification.recordings for note in r.notes))
    for i, recording in enumerate(identification.recordings):
        gaps = unused(recording, [(s.segment.start, s.segment.stop) for s in identification.fit.segments
                                  if s.segment.recording == i])  # fmt: skip
        lost = sum(stop - start for start, stop in gaps)
        share = f"{number(100 * (1 - lost / recording.n), 3)} %"
        why = _why(recording, notes) if lost else ""
        rows.append((recording.name, share, _spans(recording, gaps) if lost else "nothing", why))
    caption = (
        "What no stretch of the fit covers says nothing of the parameters. Where a recording is missing here that was "
        "given, it was refused when it was read."
    )
    return [Table(("Recording", "Fitted", "Not used", "Why"), tuple(rows), (1,), caption)]


def unused(recording: Recording, used: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Stretches (start, stop) of samples that none of the used ones covers, in order."""
    free = np.ones(recording.n, bool)
    for start, stop in used:
        free[start:stop] = False
    edges = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]]).astype(int)))
    # a sample between two stretches belongs to both
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1]


def _spans(recording: Recording, gaps: Sequence[tuple[int, int]]) -> str:
    largest = sorted(sorted(gaps, key=lambda gap: gap[0] - gap[1])[:_SHOWN])
    ranges = ", ".join(f"{_at(recording, a)} to {_at(recording, b)} s" for a, b in largest)
    return ranges + (f" and {len(gaps) - _SHOWN} shorter ones" if len(gaps) > _SHOWN else "")


def _at(recording: Recording, sample: int) -> str:
    return number(recording.start + sample / recording.fs, 4)


def _why(recording: Recording, notes: Sequence[str]) -> str:
    """What was said of it, else what is always left out of such a recording."""
    said = [note for note in notes if note.startswith(f"{recording.name}: ") and any(word in note for word in _WHY)]
    if said:
        return " ".join(full_stop(note.removeprefix(f"{recording.name}: ")) for note in dict.fromkeys(said))
    driven = recording.force is not None and bool(np.any(recording.force))
    return _DRIVEN if driven else _FREE
