"""Charts as data for the browser, which draws them with D3 (Bostock, Ogievetsky, Heer 2011) inside the one file.

D3 is read from the installed package ``mpld3``, which ships it; nothing of the package is imported. Beside its data
each chart has its legend and its figures as a table, which need no script.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ..export.render import plain_text
from ..model.display import number
from ..templates import template
from .chart import Axis, Band, Box, Chart, Dots, Line, Mark, Note, Panel, Rule
from .decimate import envelope, thinned
from .even_samples import FEWEST, ROOM, is_even, packed
from .style import ROLES

#: Columns of pixels that a chart is at most worth, and at least; points of all charts of a page.
_MOST, _FEWEST, _ALL = 900, 120, 40_000
#: Steps across an axis to which coordinates are rounded, and digits on a logarithmic one.
_STEPS, _DIGITS = 20_000, 5
_DASHES = {"-": "", "--": "6 3.5", ":": "1.5 2.5", "-.": "7 3 1.5 3"}
#: Of D3 any version will do that has scales, axes and brushes.
_FILES = ("d3.v7.min.js", "d3.v6.min.js", "d3.v5.min.js")


def library() -> str | None:
    """The text of D3; None where the package that ships it is not installed."""
    spec = find_spec("mpld3")
    for folder in () if spec is None else spec.submodule_search_locations or ():
        for name in _FILES:
            path = Path(folder) / "js" / name
            if path.is_file():
                return path.read_text("utf-8")
    return None


def scripts(charts: Sequence[Chart]) -> str:
    """What draws the charts of a page, as script elements: their data, D3, and the drawing itself."""
    d3 = library()
    if not charts or d3 is None:
        return ""
    # neither text can end the element that it stands in
    data = as_json(charts).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    d3 = d3.replace("</script", r"<\/script")
    draw = template("charts.js") + (template("choose.js") if any(chart.cursors for chart in charts) else "")
    return (
        f'<script type="application/json" id="charts">{data}</script>\n<script>{d3}</script>\n<script>{draw}</script>\n'
    )


def as_json(charts: Sequence[Chart]) -> str:
    """The data of the charts, thinned so that a page of many stays small."""
    long = [mark for chart in charts for panel in chart.panels for mark in _drawn(panel) if _is_long(mark)]
    even = sum(_is_even(mark) for mark in long)
    columns = int(min(max(_ALL / 2 / max(len(long) - even, 1), _FEWEST), _MOST))
    room = columns, max(ROOM // max(even, 1), FEWEST)
    made = [
        {
            "key": chart.key,
            "linked": chart.linked,
            "cursors": chart.cursors,
            "rows": [[_panel(panel, *room) for panel in row] for row in chart.rows],
            "heights": chart.heights,
        }
        for chart in charts
    ]
    return json.dumps(made, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def _drawn(panel: Panel) -> list[Mark]:
    return [*panel.beyond, *panel.marks]


def _is_long(mark: Mark) -> bool:
    size = mark.x.size if isinstance(mark, Line | Dots) else 2 * mark.at.size if isinstance(mark, Band) else 0
    return size > 2 * _FEWEST


def _is_even(mark: Mark) -> bool:
    """Whether all samples of a long line are kept, for it to be enlarged."""
    return isinstance(mark, Line) and _is_long(mark) and is_even(mark.x)


def _panel(panel: Panel, columns: int, room: int) -> dict[str, Any]:
    ends = {"x": panel.limits("x"), "y": panel.limits("y")}
    marks = [_mark(mark, panel, ends, columns, room) for mark in _drawn(panel)]
    x, y = (_axis(axis, ends[name]) for axis, name in ((panel.x, "x"), (panel.y, "y")))
    return {"title": plain_text(panel.title), "share": panel.share, "x": x, "y": y, "marks": marks}


def _axis(axis: Axis, ends: tuple[float, float]) -> dict[str, Any]:
    kind = "log" if axis.log else "dates" if axis.dates else "linear"
    made: dict[str, Any] = {"label": plain_text(axis.label), "kind": kind, "ends": [_short(v) for v in ends]}
    if axis.names is not None:
        made["names"] = [[_short(at), plain_text(name)] for at, name in axis.names]
    return made


def _mark(mark: Mark, panel: Panel, ends: dict[str, tuple[float, float]], columns: int, room: int) -> dict[str, Any]:
    made: dict[str, Any] = {"kind": type(mark).__name__.lower(), "color": ROLES[mark.color]}

    def numbers(values: np.ndarray, axis: str) -> list[float | None]:
        return _numbers(values, (panel.x if axis == "x" else panel.y).log, ends[axis])

    match mark:
        case Line() | Dots():
            if isinstance(mark, Line) and _is_even(mark):
                made |= {"even": packed(mark.x, mark.y, room)}
            else:
                x, y = thinned(mark.x, mark.y, columns)
                made |= {"x": numbers(x, "x"), "y": numbers(y, "y")}
            if isinstance(mark, Line):
                made |= {"width": mark.width, "alpha": mark.alpha, "dash": _DASHES[mark.dash]}
            else:
                made |= {"size": mark.size, "hollow": mark.hollow, "marker": mark.marker}
        case Band():
            at, low, high = mark.at, mark.low, mark.high
            if at.size > columns:
                edges = envelope(at, low, columns), envelope(at, high, columns)
                at, low, high = edges[0].time, edges[0].low, edges[1].high
            along, over = ("y", "x") if mark.across else ("x", "y")
            made |= {"at": numbers(at, along), "low": numbers(low, over), "high": numbers(high, over)}
            made |= {"alpha": mark.alpha, "across": mark.across}
        case Rule():
            made |= {"at": _short(mark.at), "upright": mark.upright, "width": mark.width, "dash": _DASHES[mark.dash]}
            made |= {"choice": mark.choice, "said": plain_text(mark.said)} if mark.choice else {}
        case Box():
            made |= {"x": mark.x and [_short(v) for v in mark.x], "y": mark.y and [_short(v) for v in mark.y]}
            made |= {"alpha": mark.alpha} | ({"said": plain_text(mark.said)} if mark.said else {})
        case Note():
            made |= {"x": _short(mark.x), "y": _short(mark.y), "text": plain_text(mark.text), "above": mark.above}
    return made


def _short(value: float) -> float | None:
    return float(f"{value:.7g}") if math.isfinite(value) else None


def _numbers(values: np.ndarray, log: bool, ends: tuple[float, float]) -> list[float | None]:
    """Values to what an axis can show even when it is enlarged; None where there is none."""
    if log:
        return [float(f"{v:.{_DIGITS}g}") if math.isfinite(v) and v > 0 else None for v in values.tolist()]
    decimals = math.ceil(math.log10(_STEPS / (ends[1] - ends[0])))
    return [v if math.isfinite(v) else None for v in np.round(values, decimals).tolist()]


def legend(chart: Chart) -> str:
    """The legend as HTML: a swatch and a name for each series; empty where no series has one."""
    items = [f"<li>{_swatch(mark)}{escape(plain_text(getattr(mark, 'label', '')))}</li>" for mark in chart.labelled]
    return f'<ul class="legend">{"".join(items)}</ul>' if items else ""


def _swatch(mark: Mark) -> str:
    color = f"var(--{ROLES[mark.color]})"
    match mark:
        case Band():
            inner = f'<rect y="3" width="28" height="8" style="fill:{color};opacity:{max(mark.alpha, 0.3):g}"/>'
        case Dots():
            fill = "none" if mark.hollow else color
            inner = f'<circle cx="14" cy="7" r="3.2" style="fill:{fill};stroke:{color}"/>'
        case Line() | Rule():
            width = max(mark.width, 1.4)
            inner = f'<path d="M0 7H28" style="stroke:{color};stroke-width:{width:g};fill:none" stroke-dasharray="'
            inner += f'{_DASHES[mark.dash]}" opacity="{getattr(mark, "alpha", 1.0):g}"/>'
        case _:
            return ""
    return f'<svg viewBox="0 0 28 14" width="28" height="14" aria-hidden="true">{inner}</svg>'


def figures(chart: Chart) -> list[tuple[str, ...]]:
    """What each series shows, in words and numbers: panel, series, abscissa from and to, ordinate least and largest."""
    rows = []
    for panel in chart.panels:
        where = plain_text(panel.title) or plain_text(panel.y.label)
        for mark in panel.marks:
            if isinstance(mark, Line | Dots):
                x, y = mark.x, mark.y
            elif isinstance(mark, Band):
                ends = np.concatenate([mark.low, mark.high])
                x, y = (ends, mark.at) if mark.across else (mark.at, ends)
            elif isinstance(mark, Rule) and not mark.upright:
                x, y = np.array(panel.limits("x")), np.array([mark.at])
            else:
                continue
            name = plain_text(mark.label) or plain_text(panel.y.label).partition(" [")[0]
            rows.append((where, name, _span(x, panel.x), _span(y, panel.y)))
    return rows


def _span(values: np.ndarray, axis: Axis) -> str:
    there = values[np.isfinite(values)]
    unit = plain_text(axis.label).rpartition(" [")[2].rstrip("]") if " [" in axis.label else ""
    if not there.size:
        return "nothing known"
    low, high = float(there.min()), float(there.max())
    ends = _day(low), _day(high)
    if not axis.dates:
        ends = number(low, 4), number(high, 4)
    return f"{' to '.join(dict.fromkeys(ends))}{' ' + unit if unit else ''}"


def _day(days: float) -> str:
    return str(np.datetime64("1970-01-01") + np.timedelta64(int(days), "D")) if abs(days) < 1e6 else ""
