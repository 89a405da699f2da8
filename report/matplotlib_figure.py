"""A chart drawn as a file, by matplotlib: for ``--figures`` and for the pictures of the site and of the examples."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, Literal

from .chart import Axis, Band, Box, Chart, Dots, Line, Mark, Note, Panel, Rule
from .style import WIDTH, log_ticks, styled

#: Pixels of a chart to an inch of a figure, and inches of the legend.
_PIXELS, _LEGEND = 86.0, 0.45
#: Kinds of files that can be asked for.
KINDS = ("pdf", "png", "svg")


def drawn(chart: Chart, kind: str) -> bytes:
    """The chart as the content of a file of that kind, one of ``KINDS``; the same chart gives the same bytes."""
    import matplotlib
    from matplotlib.figure import Figure

    with styled():
        matplotlib.rcParams["svg.hashsalt"] = chart.key
        figure = Figure(figsize=(WIDTH, sum(chart.heights) / _PIXELS + _LEGEND), layout="constrained")
        rows = figure.add_gridspec(len(chart.rows), 1, height_ratios=chart.heights)
        for j, panels in enumerate(chart.rows):
            columns = rows[j].subgridspec(1, len(panels), width_ratios=[panel.share for panel in panels])
            for i, panel in enumerate(panels):
                _panel(figure.add_subplot(columns[i]), panel)
        handles: dict[str, Any] = {}
        for axes in figure.axes:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                handles.setdefault(label, handle)
        if handles:
            figure.legend(handles.values(), handles, loc="outside lower center", ncols=4, handlelength=3.0)
        out = io.BytesIO()
        unset = {"png": ("Software",), "pdf": ("CreationDate", "Creator", "Producer"), "svg": ("Date", "Creator")}[kind]
        figure.savefig(out, format=kind, dpi=160, metadata={**dict.fromkeys(unset), "Title": chart.title})
    return out.getvalue()


def save(chart: Chart, path: Path) -> None:
    """Write the chart; the kind follows from the suffix."""
    from ..files.writing import write

    write(path, drawn(chart, path.suffix[1:]))


#: Numbers along an axis as wide as the figure.
_TICKS = 12


def _panel(axes: Any, panel: Panel) -> None:
    for mark in panel.marks:
        _mark(axes, mark)
    axes.set_title(panel.title)
    for name in ("x", "y"):
        _axis(axes, name, panel.x if name == "x" else panel.y, panel.limits(name))
    if panel.y.names is not None and not panel.y.names:
        axes.spines["left"].set_visible(False)


def _axis(axes: Any, name: Literal["x", "y"], of: Axis, ends: tuple[float, float]) -> None:
    axis = axes.xaxis if name == "x" else axes.yaxis
    scale = "log" if of.log else "linear"
    axes.set(**{f"{name}label": of.label, f"{name}scale": scale, f"{name}lim": ends})
    if of.log:
        log_ticks(axis)
    if of.names is not None:
        tilt = 40 if name == "x" and sum(len(word) for _, word in of.names) > 60 else 0
        axis.set_ticks([at for at, _ in of.names], [word for _, word in of.names], rotation=tilt)
    if of.dates:
        from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

        locator = AutoDateLocator(maxticks=6)
        axis.set_major_locator(locator)
        axis.set_major_formatter(ConciseDateFormatter(locator))
    if name == "x" and not (of.log or of.dates or of.names is not None):  # else they run into another
        axes.locator_params(axis="x", nbins=max(3, round(_TICKS * axes.get_position().width)))


def _mark(axes: Any, mark: Mark) -> None:
    match mark:
        case Line():
            axes.plot(mark.x, mark.y, mark.dash, color=mark.color, lw=mark.width, alpha=mark.alpha, label=mark.label)
        case Dots():
            face = "white" if mark.hollow else mark.color
            look = {"linestyle": "none", "marker": mark.marker, "markersize": mark.size, "markerfacecolor": face}
            axes.plot(mark.x, mark.y, markeredgecolor=mark.color, label=mark.label, **look)
        case Band():
            fill = axes.fill_betweenx if mark.across else axes.fill_between
            fill(mark.at, mark.low, mark.high, color=mark.color, alpha=mark.alpha, linewidth=0, label=mark.label)
        case Rule():
            rule = axes.axvline if mark.upright else axes.axhline
            rule(mark.at, color=mark.color, linestyle=mark.dash, linewidth=mark.width, label=mark.label)
        case Box():
            _box(axes, mark)
        case Note():
            place: dict[str, Any] = {
                "xytext": (0, 3) if mark.above else (7, 0),
                "ha": "center" if mark.above else "left",
            }
            axes.annotate(
                mark.text, (mark.x, mark.y), textcoords="offset points", color=mark.color, fontsize=9, **place
            )


def _box(axes: Any, mark: Box) -> None:
    look: dict[str, Any] = {"color": mark.color, "alpha": mark.alpha, "linewidth": 0}
    if mark.x is not None and mark.y is not None:
        axes.fill_between(mark.x, *mark.y, **look)
    elif mark.x is not None:
        axes.axvspan(*mark.x, **look)
    elif mark.y is not None:
        axes.axhspan(*mark.y, **look)
