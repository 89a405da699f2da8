"""What a page is made of: sections of text, tables, pictures and code. The template knows these and nothing else.

Everything is plain text and is escaped where it is put into the page, but for what this package draws itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

from ..errors import BadInput
from ..export.render import plain_text
from ..files.made_by import made_by
from ..templates import template
from .chart import Chart
from .d3_chart import figures, legend, scripts


@dataclass(frozen=True)
class Text:
    """A paragraph; ``tone``: ``good``, ``bad``, ``warn``, ``note``, ``equation`` or plain; ``lead``: its bold start."""

    kind: ClassVar[str] = "text"
    text: str
    tone: str = ""
    lead: str = ""


@dataclass(frozen=True)
class Cell:
    """One cell; ``tone`` is ``good``, ``bad``, ``quiet``, ``code``, ``level0`` to ``level4`` (shades) or plain.

    ``link`` is a file beside the page that the text leads to, ``svg`` a small picture ahead of the text.
    """

    text: str
    tone: str = ""
    link: str = ""
    svg: str = ""


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        head: of the columns.
        rows: cells, as text where they need no tone; the first of each row is its name.
        numeric: columns that are set flush right.
        caption: what it shows.
        cards: whether each row becomes a card of its own on a narrow screen, for tables with sentences in them.
    """

    kind: ClassVar[str] = "table"
    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    numeric: tuple[int, ...] = ()
    caption: str = ""
    cards: bool = False

    def cells(self) -> list[list[Cell]]:
        """Rows with every cell as a Cell."""
        return [[cell if isinstance(cell, Cell) else Cell(cell) for cell in row] for row in self.rows]


@dataclass(frozen=True)
class Figure:
    """A picture, and the sentences below it."""

    kind: ClassVar[str] = "figure"
    chart: Chart
    caption: str

    @property
    def legend(self) -> str:
        """The legend as HTML."""
        return legend(self.chart)

    @property
    def figures(self) -> Table:
        """What it shows as a table, for those who cannot see it."""
        head = ("Where", "Series", "Over", "Least to largest")
        return Table(head, tuple(figures(self.chart)), cards=True)


@dataclass(frozen=True)
class Items:
    """A list of sentences."""

    kind: ClassVar[str] = "items"
    items: tuple[str, ...]


@dataclass(frozen=True)
class Code:
    """Lines of a program, with a sentence ahead."""

    kind: ClassVar[str] = "code"
    lead: str
    text: str


@dataclass(frozen=True)
class Chosen:
    """What a reader chooses in two charts, as options to paste: a part by cursors and a mode by a click.

    Attributes:
        time, spectrum: keys of the charts; the former with ``cursors``, the latter with rules that are a ``choice``.
        part, mode: the options, with {} for what was chosen.
        command: what they go into, at {}, each behind ``join`` and a blank.
        modes: what is said where no mode is chosen; empty: nothing.
        whole: what the option is where all that is shown is chosen; empty where it then needs none.
    """

    kind: ClassVar[str] = "chosen"
    time: str
    spectrum: str
    part: str
    mode: str
    command: str
    modes: str = ""
    join: str = ""
    whole: str = ""


Block = Text | Table | Figure | Items | Code | Chosen


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it; ``folded`` where a reader has to ask for it."""

    title: str
    blocks: tuple[Block, ...]
    folded: bool = False


def picture(draw: Callable[[], Chart], caption: str) -> Block:
    """A picture, or in words why there is none: a report must come out whatever the numbers are."""
    try:
        return Figure(draw(), caption)
    except BadInput as problem:
        return Text(f"No picture here: {problem}.", "note")


@dataclass(frozen=True)
class Page:
    """A page in one piece.

    Attributes:
        title: heading.
        sections: in order; empty ones are left out.
        lead: blocks ahead of the first section.
        footer: last line, before what says which program made the page, and how.
        numbered: whether the figures are; not where the headings have numbers of their own.
    """

    title: str
    sections: Sequence[Section]
    lead: Sequence[Block] = ()
    footer: str = ""
    numbered: bool = True

    @property
    def charts(self) -> list[Chart]:
        """All its charts, in order."""
        blocks = [*self.lead, *(block for section in self.sections for block in section.blocks)]
        return [block.chart for block in blocks if isinstance(block, Figure)]

    def _foot(self) -> str:
        return " ".join(part for part in (self.footer, made_by().sentence()) if part)

    @property
    def html(self) -> str:
        """The page as HTML, with nothing loaded from anywhere: the same text for the same results."""
        shown = [section for section in self.sections if section.blocks]
        made = {"sections": shown, "lead": list(self.lead), "footer": self._foot(), "numbered": self.numbered}
        drawing = scripts(self.charts)
        return _template().render(
            title=plain_text(self.title), scripts=drawing, lost=bool(self.charts) and not drawing, **made
        )


@cache
def _template() -> Any:
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.finalize = lambda value: plain_lines(value) if type(value) is str else value
    return environment.from_string(template("report.html.j2"))


def plain_lines(text: str) -> str:
    """``text`` line by line without characters that a page cannot hold."""
    return "\n".join(
        line[: len(line) - len(line.lstrip(" "))] + plain_text(line.strip(" ")) for line in text.split("\n")
    )
