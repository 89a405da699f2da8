"""Where the numbers come from: the recordings with their fingerprints, the files beside the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .blocks import Cell, Table, Text

if TYPE_CHECKING:
    from ..model.oscillator import Provenance


def recordings_table(provenance: Provenance) -> tuple[Table, ...]:
    """The recordings that a model was identified from; nothing where it names none."""
    rows = tuple(
        (str(r.get("file", "")), str(r.get("kind") or ""), Cell(str(r.get("sha256") or "not read from a file"), "code"))
        for r in provenance.recordings
    )
    return (Table(("Recording", "Kind", "SHA-256 of the file"), rows),) if rows else ()


def files_text(files: Sequence[str]) -> tuple[Text, ...]:
    """The names of the files made with a report; nothing where there are none."""
    return (Text("Files made with this report: " + ", ".join(files) + "."),) if files else ()
