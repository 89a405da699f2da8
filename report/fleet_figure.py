"""The parameters of a fleet as pictures to be enlarged: each over the entries, whose names stand below."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..model.display import pretty_unit
from .chart import Chart
from .style import FREE, MEASURED

#: Entries of a fleet that have their names below each panel, of a larger one every so many; letters of a name.
_NAMED, _LETTERS = 200, 24


def fleet_figure(
    names: Sequence[str], columns: Mapping[tuple[str, str], Sequence[float | None]], key: str = "fleet"
) -> Chart:
    """Each parameter's values over the entries, with their median, all enlarged together.

    Args:
        names: of the entries, in the manifest's order.
        columns: by name and unit of a parameter its value in each entry, None where there is none.
        key: name of the chart within its page.
    """
    chart = Chart(key, "The parameters over the entries, in the manifest's order", linked=True)
    shown = list(columns.items())
    places = np.arange(1.0, len(names) + 1.0)
    every = math.ceil(len(names) / _NAMED) or 1
    ticks = tuple((float(place), name[:_LETTERS]) for place, name in zip(places[::every], names[::every], strict=True))
    for pair in (shown[i : i + 2] for i in range(0, len(shown), 2)):
        for panel, ((name, unit), values) in zip(chart.row(*[1.0] * len(pair), height=200), pair, strict=True):
            known = np.array([math.nan if value is None else value for value in values], float)
            known = np.concatenate([known, np.full(len(names) - known.size, math.nan)])
            panel.dots(places, known, FREE, size=4.5)
            if np.any(np.isfinite(known)):
                panel.rule(float(np.nanmedian(known)), MEASURED, "median")
            panel.title = f"{name} [{pretty_unit(unit)}]"
            panel.x.set(low=0.5, high=len(names) + 0.5, names=ticks)
    return chart
