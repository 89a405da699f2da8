"""The life of a rig in a picture: each parameter over time, what moved in colour, steps marked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import pretty_unit
from .chart import Box, Chart, Panel
from .style import GRID, LIGHT, MEASURED, MODEL

if TYPE_CHECKING:
    from ..change import Life

#: So many names of points stand below an axis; of more only some.
_NAMES = 8


def life_figure(life: Life, key: str = "life") -> Chart:
    """Each parameter's estimates over the points with two standard errors, and the values that explain them.

    Args:
        life: what was watched.
        key: of the chart, of letters, digits and hyphens.
    """
    names = life.estimates.names
    moved = () if life.moved is None else life.moved.best.moved
    ordered = sorted(names, key=lambda name: name not in moved)
    chart = Chart(key, f"The parameters of {life.name} over its life", linked=True)
    for pair in zip(ordered[::2], [*ordered[1::2], *([None] * (len(ordered) % 2))], strict=True):
        for panel, name in zip(chart.row(*[1.0] * sum(n is not None for n in pair), height=200), pair, strict=False):
            if name is not None:
                _parameter(panel, life, name, moved=name in moved)
    return chart


def _parameter(panel: Panel, life: Life, name: str, *, moved: bool) -> None:
    place, dates = places(life)
    j = life.estimates.names.index(name)
    values = life.estimates.values[:, j] * life.estimates.scale[j]
    errors = np.sqrt(life.estimates.covariance[:, j, j]) * life.estimates.scale[j]
    # an error many times the picture would leave nothing else to be seen
    shown = np.where(errors < 3 * max(np.ptp(values), float(np.median(errors))), errors, np.nan)
    _explained(panel, life, name, place, moved)
    color = MODEL if moved else MEASURED
    panel.dots(place, values, color, size=4.5)
    panel.line(*_bars(place, values - 2 * shown, values + 2 * shown), color, width=1.0)
    for step in life.steps:
        if step.parameter == name:
            before, after = life.groups[step.state - 1], life.groups[step.state]
            middle = 0.5 * (place[before[-1]] + place[after[0]])
            panel.rule(middle, MODEL, dash=":", width=1.0, upright=True)
    panel.title = f"{name} [{pretty_unit(life.estimates.units[j])}]{' moved' if moved else ''}"
    panel.x.dates = dates
    if not dates and life.points[0].when is None:
        every = math.ceil(len(place) / _NAMES)
        panel.x.names = [(float(place[i]), life.points[i].name[:14]) for i in range(0, len(place), every)]


def _bars(x: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A line that goes up at each x (n,) from low to high, with gaps between."""
    return np.repeat(x, 3), np.stack([low, high, np.full(x.size, np.nan)], axis=1).ravel()


def _explained(panel: Panel, life: Life, name: str, place: np.ndarray, moved: bool) -> None:
    """The value in each state given that nothing else moved: a band of two standard errors."""
    values, errors = life.values(name)
    if len(values) < len(life.groups):
        return
    for i, group in enumerate(life.groups):
        ends = place[list(group)]
        low, high = float(ends.min() - 0.3 * _gap(place)), float(ends.max() + 0.3 * _gap(place))
        band = (float(values[i] - 2 * errors[i]), float(values[i] + 2 * errors[i]))
        panel.marks.append(Box((low, high), band, LIGHT if moved else GRID, 0.9))


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
