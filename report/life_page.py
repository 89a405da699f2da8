"""Lives of rigs on one page: what moved and when, a picture over time, a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..change.life_wording import plus_minus, repeatability_words, sentences
from ..model.display import full_stop, pretty_unit
from .blocks import Block, Cell, Items, Page, Section, Table, Text, picture
from .life_figure import life_figure

if TYPE_CHECKING:
    from ..change import Life

#: Pictures of a page; of more rigs than that the rest is told in words, so that the page stays below 1 MB.
_MOST = 12


def life_page(lives: Sequence[Life]) -> Page:
    """The page.

    Args:
        lives: one for each rig; those that changed come first.
    """
    ordered = sorted(lives, key=lambda life: not life.changed)
    changed = [life for life in lives if life.changed]
    lead = [_first(life) for life in ordered] if len(lives) <= _MOST else [_first(life) for life in ordered[:_MOST]]
    if len(lives) > 1:
        lead.insert(0, Text(f"{len(changed)} of {len(lives)} rigs changed.", "bad" if changed else "good"))
    sections = [
        Section(life.name, tuple(_blocks(life, f"life-{i}", drawn=i < _MOST))) for i, life in enumerate(ordered)
    ]
    title = f"The life of {lives[0].name}" if len(lives) == 1 else "The lives of a fleet"
    return Page(title, sections, lead=lead)


def _first(life: Life) -> Block:
    found = sentences(life)
    return Text(" ".join(found), "bad" if life.changed else "good", f"{'▲' if life.changed else '✓'} {life.name}:")


def _blocks(life: Life, key: str, *, drawn: bool) -> list[Block]:
    blocks: list[Block] = []
    if drawn:
        caption = (
            "Dots: each model's own value, with two of its stated standard errors where they fit the picture. Bands: "
            "the value in each state given that only what is marked moved, with two errors as they were judged. "
            "Dotted: steps."
        )
        blocks.append(picture(lambda: life_figure(life, key), caption))
    blocks.append(_table(life))
    notes = [repeatability_words(life), *(full_stop(note) for note in life.notes)]
    blocks.append(Items(tuple(notes)))
    return blocks


def _table(life: Life) -> Table:
    names = life.estimates.names
    moved = () if life.moved is None else life.moved.best.moved
    timed = any(point.when is not None for point in life.points)
    marked = any(point.state is not None for point in life.points)
    units = [pretty_unit(unit) for unit in life.estimates.units]
    head = (
        "Test",
        *(["State"] if marked else []),
        *(["When"] if timed else []),
        *(f"{n} [{u}]" for n, u in zip(names, units, strict=True)),
    )
    rows = []
    for point in life.points:
        parameters = point.model.parameters()
        when = [] if not timed else ["" if point.when is None else str(point.when).removesuffix("T00:00:00+00:00")]
        cells = [Cell(plus_minus(parameters[name]).replace("-", "−"), "bad" if name in moved else "") for name in names]
        rows.append((point.name, *([point.state or ""] if marked else []), *when, *cells))
    return Table(
        head, tuple(rows), tuple(range(len(head) - len(names), len(head))), "As each model states it, ± one error."
    )
