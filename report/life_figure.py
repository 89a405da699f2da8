"""The life of a rig in a picture: each parameter over time, what moved in colour, steps marked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import pretty_unit
from .style import GRID, LIGHT, MEASURED, MODEL, drawing, svg

if TYPE_CHECKING:
    from ..change import Life

_COLUMNS, _HEIGHT = 2, 2.1
#: So many names of points stand below an axis; of more only some.
_NAMES = 12


def life_figure(life: Life, key: str = "life") -> str:
    """Each parameter's estimates over the points with two standard errors, and the values that explain them, as SVG.

    Args:
        life: what was watched.
        key: of the picture, of letters, digits and hyphens.
    """
    names = life.estimates.names
    rows = math.ceil(len(names) / _COLUMNS)
    place, dates = places(life)
    moved = () if life.moved is None else life.moved.best.moved
    with drawing(height=_HEIGHT * rows + 0.6) as figure:
        grid = figure.subplots(rows, _COLUMNS, squeeze=False)
        for spare in grid.flat[len(names) :]:
            spare.set_visible(False)
        for axes, name in zip(grid.flat, names, strict=False):
            j = names.index(name)
            values = life.estimates.values[:, j] * life.estimates.scale[j]
            errors = np.sqrt(life.estimates.covariance[:, j, j]) * life.estimates.scale[j]
            color = MODEL if name in moved else MEASURED
            _explained(axes, life, name, place, name in moved)
            shown = np.where(errors < 3 * max(np.ptp(values), float(np.median(errors))), errors, np.nan)
            axes.errorbar(place, values, 2 * shown, fmt="o", markersize=4, color=color, linewidth=1.0, capsize=2)
            for step in life.steps:
                if step.parameter == name:
                    before, after = life.groups[step.state - 1], life.groups[step.state]
                    axes.axvline(0.5 * (place[before[-1]] + place[after[0]]), color=MODEL, linestyle=":", linewidth=1.0)
            axes.set_title(f"{name} [{pretty_unit(life.estimates.units[j])}]{' moved' if name in moved else ''}")
            _axis(axes, life, place, dates)
        return svg(figure, key, f"The parameters of {life.name} over its life")


def _explained(axes: object, life: Life, name: str, place: np.ndarray, moved: bool) -> None:
    """The value in each state given that nothing else moved: a band of two standard errors."""
    values, errors = life.values(name)
    if len(values) < len(life.groups):
        return
    for i, group in enumerate(life.groups):
        ends = place[list(group)]
        low, high = ends.min() - 0.3 * _gap(place), ends.max() + 0.3 * _gap(place)
        axes.fill_between(  # pyright: ignore[reportAttributeAccessIssue]
            [low, high],
            values[i] - 2 * errors[i],
            values[i] + 2 * errors[i],
            color=LIGHT if moved else GRID,
            linewidth=0,
        )


def _gap(place: np.ndarray) -> float:
    steps = np.diff(np.unique(place))
    return float(steps.min()) if steps.size else 1.0


def places(life: Life) -> tuple[np.ndarray, bool]:
    """(n,) where the points stand on an axis, and whether those are days since 1970: by time, number or order."""
    from datetime import datetime

    times = [point.when for point in life.points]
    if all(isinstance(when, int | float) for when in times):
        return np.array(times, float), False
    if all(isinstance(when, str) for when in times):
        return np.array([datetime.fromisoformat(str(when)).timestamp() / 86400 for when in times]), True
    return np.arange(len(times), dtype=float), False


def _axis(axes: object, life: Life, place: np.ndarray, dates: bool) -> None:
    """Below the axis: dates, numbers, or the names of points."""
    if dates:
        from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

        locator = AutoDateLocator(maxticks=6)
        axes.xaxis.set_major_locator(locator)  # pyright: ignore[reportAttributeAccessIssue]
        axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))  # pyright: ignore[reportAttributeAccessIssue]
    elif life.points[0].when is None:
        every = math.ceil(len(place) / _NAMES)
        shown = range(0, len(place), every)
        labels = [life.points[i].name[:14] for i in shown]
        tilt = 40 if max(map(len, labels)) * len(labels) > 36 else 0
        axes.set_xticks(  # pyright: ignore[reportAttributeAccessIssue]
            [place[i] for i in shown], labels, rotation=tilt, ha="right" if tilt else "center"
        )
