"""What ``dashpot.look`` gives: one dictionary a record, which prints in words and shows itself with a mouse."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.arguments import path_of
from .look import Seen, described, look, look_at_object

if TYPE_CHECKING:
    from ..report.blocks import Page

#: Height of the frame in a notebook, in pixels, until the page in it says its own.
_HEIGHT = 900


class Look(list[dict[str, Any]]):
    """What would be read of recordings: one dictionary a record, as ``dashpot look --json`` has it.

    It prints in words. In a notebook it shows the recordings, to be enlarged, with cursors for ``part`` and modes to
    click; that is one page in a frame, which asks nothing of Python. ``save("look.html")`` writes it.
    """

    def __init__(self, seen: Iterable[Seen] = ()) -> None:
        self._seen = tuple(seen)
        super().__init__(one.entry for one in self._seen)

    def __repr__(self) -> str:
        return "\n\n".join(described(entry) for entry in self)

    def _repr_html_(self) -> str:
        page = escape(page_of(self._seen, python=True).html)
        look = f"width: 100%; height: {_HEIGHT}px; border: 0"
        frame = f'<iframe srcdoc="{page}" title="Recordings" allow="clipboard-write" style="{look}"></iframe>'
        words = f"<details><summary>In words</summary><pre>{escape(repr(self))}</pre></details>"
        return frame + words

    def save(self, path: str | Path) -> Path:
        """Write the page with what it needs, one HTML file, as ``dashpot look --page``; returns the path.

        Raises:
            BadInput: the place cannot be written.
        """
        from ..files.writing import write

        target = path_of(path, "a file for the page")
        write(target, page_of(self._seen).html)
        return target


def page_of(seen: Sequence[Seen], *, python: bool = False) -> Page:
    """The page of what was seen, those that were refused among them.

    Args:
        seen: records in order.
        python: whether what is chosen is written for a call of Python, not for a command.
    """
    from ..report.look_page import Shown, look_page

    shown = [
        Shown(one.file, one.entry["record"], facts, recording, one.part, how)
        for one in seen
        for facts, recording, how in zip(one.entry["recordings"], one.recordings, one.how, strict=True)
    ]
    return look_page(shown, python=python)


def looked_at(given: Sequence[Any], options: Mapping[str, Any]) -> Look:
    """What would be read of files, and of whatever else is a recording; raises BadInput."""
    seen: list[Seen] = []
    for place, one in enumerate(given):
        if isinstance(one, str | os.PathLike):
            seen += look(path_of(one, "a recording"), options, place)
        else:
            seen += look_at_object(one, options)
    return Look(seen)
