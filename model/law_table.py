"""The whole table of effects as text for docs/laws.md, made from the library."""

from __future__ import annotations

from .law import Law
from .law_trial import PATHS
from .laws import LIBRARY

_HEAD = "| law | what it is | equation | backbone and damping | stores | source |\n|---|---|---|---|---|---|"


def law_table() -> str:
    """Markdown: a heading and a table for each path, in the order of the library."""
    parts = []
    for path in PATHS:
        rows = [_row(law) for law in LIBRARY.values() if law.path == path]
        if rows:
            parts.append("\n".join([f"### {path.capitalize()}", "", _HEAD, *rows]))
    return "\n\n".join(parts) + "\n"


def _row(law: Law) -> str:
    equation = "<br>".join(f"`{line}`" for line in law.in_words(str).split("; "))
    stores = "–" if law.force is None else "no" if law.stored is None else "yes"
    cells = [f"`{law.name}`", law.sentence, equation, law.curves, stores, law.source]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
