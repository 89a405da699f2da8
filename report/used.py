"""What of the recordings the fit used, what it did not, and why."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import full_stop, number
from .blocks import Block, Table

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..identify.problem.segments import Segment
    from ..recording.recording import Recording
    from .time_history import Left, Taken

#: Words of the notes that say why something was not used.
_WHY = ("left out", "left aside", "not used", "is not used", "too short", "clipped", "noise alone")
#: So many stretches are named.
_SHOWN = 4
_FREE = "no free motion: at rest, being moved, or faded into the noise"
_DRIVEN = "left to the sides of jumps and damage, or too short to simulate"


def used_table(identification: Identification) -> list[Block]:
    """A row a recording: how much of it was fitted, where the rest lies, and why it was not."""
    rows = []
    for i, recording in enumerate(identification.recordings):
        where, why, lost = left(identification, i)
        share = f"{number(100 * (1 - lost / recording.n), 3)} %"
        rows.append((recording.name, share, where or "nothing", why))
    caption = (
        "What no stretch of the fit covers says nothing of the parameters. Where a recording is missing here that was "
        "given, it was refused when it was read."
    )
    return [Table(("Recording", "Fitted", "Not used", "Why"), tuple(rows), (1,), caption)]


def taken(identification: Identification, i: int) -> list[Taken]:
    """What the fit takes of recording ``i``, in order, as ``joined``."""
    return joined([(segment.kind, segment.start, segment.stop) for segment in _segments(identification, i)])


def joined(pieces: Sequence[Taken]) -> list[Taken]:
    """Stretches in order; those of a kind that follow one another are one."""
    found: list[Taken] = []
    for kind, start, stop in sorted(pieces, key=lambda piece: piece[1]):
        if found and found[-1][0] == kind and start <= found[-1][2]:
            found[-1] = (kind, found[-1][1], max(stop, found[-1][2]))
        else:
            found.append((kind, start, stop))
    return found


def left_pieces(identification: Identification, i: int) -> list[Left]:
    """What the fit leaves of recording ``i``, in order, each stretch with its reason."""
    from ..identify.problem.why_left import why_left

    recording, segments = identification.recordings[i], _segments(identification, i)
    pace = segments[0].pace if segments else identification.oscillator.omega0.value
    said = _said(recording, _notes(identification))
    return [
        (start, stop, said.rstrip(".") or why_left(recording, start, stop, pace))
        for start, stop in unused(recording, [(segment.start, segment.stop) for segment in segments])
    ]


def left(identification: Identification, i: int) -> tuple[str, str, int]:
    """What the fit leaves of recording ``i``: its times and the reason, in words, and how many samples; or nothing."""
    recording = identification.recordings[i]
    gaps = unused(recording, [(segment.start, segment.stop) for segment in _segments(identification, i)])
    if not gaps:
        return "", "", 0
    return _spans(recording, gaps), _why(recording, _notes(identification)), sum(stop - start for start, stop in gaps)


def _notes(identification: Identification) -> tuple[str, ...]:
    return (*identification.notes, *(note for r in identification.recordings for note in r.notes))


def _segments(identification: Identification, i: int) -> list[Segment]:
    return [part.segment for part in identification.fit.segments if part.segment.recording == i]


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
    return ranges + (f" and {len(gaps) - _SHOWN} more, each shorter" if len(gaps) > _SHOWN else "")


def _at(recording: Recording, sample: int) -> str:
    return number(recording.start + sample / recording.fs, 4)


def _why(recording: Recording, notes: Sequence[str]) -> str:
    """What was said of it, else what is always left out of such a recording."""
    if said := _said(recording, notes):
        return said
    driven = recording.force is not None and bool(np.any(recording.force))
    return _DRIVEN if driven else _FREE


def _said(recording: Recording, notes: Sequence[str]) -> str:
    """What notes say of what is left of it; empty where none does."""
    said = [note for note in notes if note.startswith(f"{recording.name}: ") and any(word in note for word in _WHY)]
    return " ".join(full_stop(note.removeprefix(f"{recording.name}: ")) for note in dict.fromkeys(said))
