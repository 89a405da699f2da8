"""The life of a rig in a picture: each parameter over time, what moved in colour, steps marked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.display import pretty_unit
from .style import GRID, LIGHT, MEASURED, MODEL, drawing, svg

if TYPE_CHECKING:
    from ..change import Life

_WIDTH, _HEIGHT = 4.6, 2.1
#: So many names of points stand below an axis; of more only some.
_NAMES = 8


def life_figure(life: Life, key: str = "life") -> str:
    """Each parameter's estimates over the points with two standard errors, and the values that explain them.

    Each is an SVG of its own, so that they stand beside each other where there is room and below each other on a phone.

    Args:
        life: what was watched.
        key: of the picture, of letters, digits and hyphens.
    """
    names = life.estimates.names
    moved = () if life.moved is None else life.moved.best.moved
    ordered = sorted(names, key=lambda name: name not in moved)
    drawn = [_parameter(life, name, f"{key}-{i}", moved=name in moved) for i, name in enumerate(ordered)]
    return f'<div class="several">{"".join(drawn)}</div>'


def _parameter(life: Life, name: str, key: str, *, moved: bool) -> str:
    place, dates = places(life)
    j = life.estimates.names.index(name)
    values = life.estimates.values[:, j] * life.estimates.scale[j]
    errors = np.sqrt(life.estimates.covariance[:, j, j]) * life.estimates.scale[j]
    # an error many times the picture would leave nothing else to be seen
    shown = np.where(errors < 3 * max(np.ptp(values), float(np.median(errors))), errors, np.nan)
    with drawing(width=_WIDTH, height=_HEIGHT) as figure:
        axes = figure.subplots()
        _explained(axes, life, name, place, moved)
        color = MODEL if moved else MEASURED
        axes.errorbar(place, values, 2 * shown, fmt="o", markersize=4, color=color, linewidth=1.0, capsize=2)
        for step in life.steps:
            if step.parameter == name:
                before, after = life.groups[step.state - 1], life.groups[step.state]
                axes.axvline(0.5 * (place[before[-1]] + place[after[0]]), color=MODEL, linestyle=":", linewidth=1.0)
        axes.set_title(f"{name} [{pretty_unit(life.estimates.units[j])}]{' moved' if moved else ''}")
        _axis(axes, life, place, dates)
        return svg(figure, key, f"{name} of {life.name} over its life")


def _explained(axes: Any, life: Life, name: str, place: np.ndarray, moved: bool) -> None:
    """The value in each state given that nothing else moved: a band of two standard errors."""
    values, errors = life.values(name)
    if len(values) < len(life.groups):
        return
    for i, group in enumerate(life.groups):
        ends = place[list(group)]
        low, high = ends.min() - 0.3 * _gap(place), ends.max() + 0.3 * _gap(place)
        axes.fill_between(
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


def _axis(axes: Any, life: Life, place: np.ndarray, dates: bool) -> None:
    """Below the axis: dates, numbers, or the names of points."""
    if dates:
        from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

        locator = AutoDateLocator(maxticks=6)
        axes.xaxis.set_major_locator(locator)
        axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))
    elif life.points[0].when is None:
        every = math.ceil(len(place) / _NAMES)
        shown = range(0, len(place), every)
        labels = [life.points[i].name[:14] for i in shown]
        tilt = 40 if max(map(len, labels)) * len(labels) > 36 else 0
        axes.set_xticks([place[i] for i in shown], labels, rotation=tilt, ha="right" if tilt else "center")
