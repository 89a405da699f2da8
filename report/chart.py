"""A chart as a value: panels with axes, lines, bands, dots and notes. What draws it, a browser or a file, comes later.

A page hands it to the browser (``d3_chart``); ``--figures`` draws it as a file (``matplotlib_figure``). Both read the
same value, so that they show the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from .style import LIGHT

#: Part of an axis that stays free on either side of what is drawn.
_MARGIN = 0.05

Dash = Literal["-", "--", ":", "-."]


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points ``x`` (n,), ``y`` (n,); NaN parts it. Colour as in ``style``, width in pixels."""

    x: np.ndarray
    y: np.ndarray
    color: str
    label: str = ""
    dash: Dash = "-"
    width: float = 1.4
    alpha: float = 1.0


@dataclass(frozen=True, eq=False)
class Dots:
    """A mark at each point ``x`` (n,), ``y`` (n,): a circle ``o`` or a square ``s`` of ``size`` pixels."""

    x: np.ndarray
    y: np.ndarray
    color: str
    label: str = ""
    marker: Literal["o", "s"] = "o"
    size: float = 3.0
    hollow: bool = False


@dataclass(frozen=True, eq=False)
class Band:
    """The area from ``low`` (n,) to ``high`` (n,) over ``at`` (n,), x; ``across``: ``at`` is y and the others x."""

    at: np.ndarray
    low: np.ndarray
    high: np.ndarray
    color: str
    label: str = ""
    alpha: float = 0.3
    across: bool = False


@dataclass(frozen=True)
class Rule:
    """A straight line across the panel, level at y or ``upright`` at x.

    ``choice`` is what a page offers to paste where an upright one is chosen, and ``said`` what it then says of it.
    """

    at: float
    color: str
    label: str = ""
    dash: Dash = "--"
    width: float = 1.1
    upright: bool = False
    choice: str = ""
    said: str = ""


@dataclass(frozen=True)
class Box:
    """A filled rectangle; None: to the edge of the panel. A page says what is ``said`` of it to who points at it."""

    x: tuple[float, float] | None
    y: tuple[float, float] | None
    color: str = LIGHT
    alpha: float = 0.22
    said: str = ""


@dataclass(frozen=True)
class Note:
    """Words beside a point; ``above`` it, centred, or to its right."""

    x: float
    y: float
    text: str
    color: str
    above: bool = False


Mark = Line | Dots | Band | Rule | Box | Note


@dataclass
class Axis:
    """One axis.

    Attributes:
        label: with its unit in brackets.
        log: whether it is logarithmic.
        low, high: ends; None where they follow from what is drawn.
        tight: whether it ends where what is drawn does.
        dates: whether values are days since 1970.
        names: ticks with a name, in place of numbers; none at all where empty.
    """

    label: str = ""
    log: bool = False
    low: float | None = None
    high: float | None = None
    tight: bool = False
    dates: bool = False
    names: Sequence[tuple[float, str]] | None = None

    def set(self, **values: Any) -> None:
        """Several of the attributes."""
        for name, value in values.items():
            setattr(self, name, value)


@dataclass
class Panel:
    """Axes with what is drawn on them; ``share`` is its part of the width of its row.

    ``beyond`` is what lies outside of the view, below the marks: a page shows it to who moves the view, a file never.
    """

    share: float = 1.0
    title: str = ""
    x: Axis = field(default_factory=Axis)
    y: Axis = field(default_factory=Axis)
    marks: list[Mark] = field(default_factory=list)
    beyond: list[Line] = field(default_factory=list)

    def line(self, x: Any, y: Any, color: str, label: str = "", **look: Any) -> None:
        """Add a ``Line``."""
        self.marks.append(Line(np.asarray(x, float), np.asarray(y, float), color, label, **look))

    def dots(self, x: Any, y: Any, color: str, label: str = "", **look: Any) -> None:
        """Add ``Dots``."""
        self.marks.append(Dots(np.asarray(x, float), np.asarray(y, float), color, label, **look))

    def band(self, at: Any, low: Any, high: Any, color: str, label: str = "", **look: Any) -> None:
        """Add a ``Band``."""
        at, low, high = (np.asarray(values, float) for values in (at, low, high))
        self.marks.append(Band(at, low, high, color, label, **look))

    def rule(self, at: float, color: str, label: str = "", **look: Any) -> None:
        """Add a ``Rule``."""
        self.marks.append(Rule(float(at), color, label, **look))

    def goes_on(self, x: np.ndarray, y: np.ndarray, view: slice, color: str, **look: Any) -> None:
        """Add to ``beyond`` what a line through x (n,) and y (n,) is outside of a view, which shows it already."""
        outside = np.array(y, float)
        outside[view.start + 1 : max(view.stop - 1, 0)] = np.nan
        self.beyond.append(Line(np.asarray(x, float), outside, color, **look))

    def limits(self, axis: Literal["x", "y"]) -> tuple[float, float]:
        """Ends of an axis: as they were set, else from what is drawn, with a margin."""
        of = self.x if axis == "x" else self.y
        values = np.concatenate([np.empty(0), *(np.ravel(_extent(mark, axis)) for mark in self.marks)])
        values = values[np.isfinite(values) & ((values > 0) | (not of.log))]
        low, high = (float(values.min()), float(values.max())) if values.size else (1.0, 10.0) if of.log else (0.0, 1.0)
        if of.log:
            room = 1.0 if of.tight else (high / low) ** _MARGIN if high > low else 2.0
            low, high = low / room, high * room
        else:
            room = 0.0 if of.tight else _MARGIN * (high - low)
            room = room if high > low else 0.5 * abs(high) or 0.5
            low, high = low - room, high + room
        low, high = low if of.low is None else of.low, high if of.high is None else of.high
        if not high > low:
            low, high = (low, 10 * low) if of.log else (low, low + (abs(low) or 1.0))
        return low, high

    @property
    def labelled(self) -> list[Mark]:
        """Marks that a legend names, each label once."""
        first: dict[str, Mark] = {}
        for mark in self.marks:
            label = getattr(mark, "label", "")
            if label:
                first.setdefault(label, mark)
        return list(first.values())


@dataclass
class Chart:
    """Panels in rows, with one legend below all of them.

    Attributes:
        key: letters, digits and hyphens, unlike that of any other chart of the page; the name of its file.
        title: what the chart shows, for those who cannot see it.
        rows: of panels; ``heights`` are theirs in pixels.
        linked: whether panels of like abscissa are enlarged together.
        cursors: whether a page shows two cursors, whose range along x it offers to paste; a file shows none.
    """

    key: str
    title: str = ""
    rows: list[tuple[Panel, ...]] = field(default_factory=list)
    heights: list[int] = field(default_factory=list)
    linked: bool = False
    cursors: bool = False

    def row(self, *shares: float, height: int = 270) -> tuple[Panel, ...]:
        """A further row of panels, as wide as ``shares`` says."""
        panels = tuple(Panel(share) for share in shares)
        self.rows.append(panels)
        self.heights.append(height)
        return panels

    @property
    def panels(self) -> list[Panel]:
        """All panels, row by row."""
        return [panel for row in self.rows for panel in row]

    @property
    def labelled(self) -> list[Mark]:
        """Marks that the legend names, each label once."""
        first: dict[str, Mark] = {}
        for panel in self.panels:
            for mark in panel.labelled:
                first.setdefault(mark.label, mark)  # pyright: ignore[reportAttributeAccessIssue]
        return list(first.values())


def _extent(mark: Mark, axis: Literal["x", "y"]) -> Any:
    """What of a mark an axis has to show; rules and notes stand where others are."""
    match mark:
        case Line() | Dots():
            return mark.x if axis == "x" else mark.y
        case Band():
            return mark.at if (axis == "x") != mark.across else np.concatenate([mark.low, mark.high])
        case Box():
            span = mark.x if axis == "x" else mark.y
            return np.array(span if span is not None else (), float)
        case Rule():
            return np.array([mark.at] if mark.upright == (axis == "x") and math.isfinite(mark.at) else (), float)
        case Note():
            return np.empty(0)
