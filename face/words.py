"""How results show themselves: in a few lines of text, and in a notebook as a table and a picture."""

from __future__ import annotations

from contextlib import suppress
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..model import Oscillator

#: Notes that are shown; those of a model are all in its ``notes``.
_NOTES = 3
_STYLE = "font-family: system-ui, sans-serif; line-height: 1.5"


def model_text(o: Oscillator, notes: Sequence[str]) -> str:
    """A model in a few lines: parameters with errors, what they make of a machine, what it leaves, notes."""
    from ..model.show import columns_text, machine_table, parameter_cells

    lines = [f"{o.name}: {o.equation()}"]
    lines += columns_text([cells[:5] for cells in parameter_cells(o)])
    if machine := machine_table(o):
        lines += ["as the machine has it", *columns_text([cells[:5] for cells in machine])]
    return "\n".join([*lines, *_left(o), *(f"note: {note}" for note in notes[:_NOTES]), *_more(notes)])


def _left(o: Oscillator) -> list[str]:
    from ..model.fit_state import left_of

    return [f"leaves {left.of_noise}, {left.of_motion} of {left.file}" for left in left_of(o)[:4]]


def _more(notes: Sequence[str]) -> list[str]:
    more = len(notes) - _NOTES
    return [f"and {more} more in .notes"] if more > 0 else []


def model_html(o: Oscillator, notes: Sequence[str], picture: Callable[[], str]) -> str:
    """The same as tables, with the backbone as SVG where the model says for which amplitudes it holds."""
    from ..errors import BadInput
    from ..model.show import machine_table, parameter_cells

    parts = [f"<p><b>{escape(o.name)}</b>: <i>{escape(o.equation())}</i></p>"]
    parts.append(_table(parameter_cells(o)))
    if machine := machine_table(o):
        parts.append(_table(machine, f"As the machine has it{o.over_what_drives}"))
    parts += [f"<p>{escape(line)}</p>" for line in (*_left(o), *notes[:_NOTES], *_more(notes))]
    with suppress(BadInput):  # where no amplitudes are known to draw over
        parts.append(picture())
    return f'<div style="{_STYLE}">{"".join(parts)}</div>'


def _table(rows: list[tuple[str, ...]], caption: str = "") -> str:
    body = "".join(
        f"<tr><th style='text-align: left'>{escape(name)}</th>"
        + "".join(f"<td style='text-align: right'>{escape(cell)}</td>" for cell in cells[:3])
        + "".join(f"<td style='text-align: left'>{escape(cell)}</td>" for cell in cells[3:])
        + "</tr>"
        for name, *cells in rows
    )
    head = f"<caption style='text-align: left'>{escape(caption)}</caption>" if caption else ""
    return f"<table>{head}{body}</table>"


def paragraph(text: str) -> str:
    """A sentence for a notebook."""
    return f'<p style="{_STYLE}">{escape(text)}</p>'


def preformatted(text: str) -> str:
    """Lines of text for a notebook."""
    return f"<pre>{escape(text)}</pre>"
