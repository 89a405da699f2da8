"""Where a model fails: the ranges against what was recorded, and the harmonics of what it leaves over."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..model import units
from ..model.display import Scale, full_stop, number, percent_text, scale_of
from .blocks import Block, Section, Table, Text, picture
from .chart import Box, Chart, Note
from .depends_on import depends_on_blocks
from .style import BEFORE, GRID

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Location

#: Path of a law, as an engineer says it.
PATHS = {
    "restoring": "in the spring",
    "dissipation": "in the damping",
    "memory": "in a force that remembers the motion before",
    "inertia": "in a further mass that moves along",
    "excitation": "between the recorded force and the mass",
    "measurement": "between the mass and the record",
    "either": "in the path of the force or in that of the record",
    "environment": "from outside, or changing with time",
}
_MOST_HARMONICS = 12
#: Shares from here on are written above their bars.
_LABELLED = 0.005


@dataclass(frozen=True)
class _Range:
    """One range: where the model fails, and what was recorded in all recordings (None where that is not known)."""

    name: str
    scale: Scale
    fails: tuple[float, float]
    whole: tuple[float, float] | None


def location_section(diagnosis: Diagnosis) -> Section:
    """Statement, ranges as picture and table, harmonic shares."""
    title = "Where the given model fails"
    place = diagnosis.location
    if place is None:
        return Section(
            title,
            (
                Text(
                    "Nowhere: nothing is left that follows the motion."
                    if diagnosis.remainder is None
                    else "not stated."
                ),
            ),
        )
    blocks: list[Block] = [Text(full_stop(place.statement) or "not stated.", "note", "It fails:")]
    ranges = _ranges(diagnosis, place)
    shares = {order: share for order, share in sorted(place.harmonics.items()) if math.isfinite(share)}
    if ranges or shares:
        parts = [
            *(["Bars: where the mismatch lies (coloured) within what was recorded (grey)"] if ranges else []),
            *(["Below: its power by harmonics of the motion (0: its mean)"] if shares else []),
        ]
        caption = ". ".join(parts if len(parts) > 1 else [parts[0].partition(": ")[2].capitalize()]) + "."
        blocks.append(picture(lambda: location_figure(ranges, shares), caption))
    rows = [
        (r.name, *_ends(r.fails, r.scale), *(_ends(r.whole, r.scale) if r.whole else ("", "")), r.scale.unit)
        for r in ranges
    ]
    if rows:
        head = ("Range", "Fails from", "to", "Recorded from", "to", "Unit")
        blocks.append(Table(head, tuple(rows), (1, 2, 3, 4)))
    if place.path in PATHS:
        blocks.append(Text(f"It lies {PATHS[place.path]} (path: {place.path})."))
    else:
        blocks.append(Text("It does not show where in the rig the mismatch lies."))
    blocks += depends_on_blocks(place)
    if place.recordings:
        blocks.append(Text("It shows in " + ", ".join(place.recordings) + "."))
    return Section(title, tuple(blocks))


def _ends(ends: tuple[float, float], scale: Scale) -> tuple[str, str]:
    return number(ends[0] * scale.factor), number(ends[1] * scale.factor)


def _ranges(diagnosis: Diagnosis, place: Location) -> list[_Range]:
    """The ranges that are known; those without extent or with ends that are no numbers are left out."""
    from ..diagnose.place.recorded_ranges import recorded_ranges

    unit = diagnosis.model.response.displacement_unit
    recorded = recorded_ranges(diagnosis.records, diagnosis.model)
    entries = [
        ("Displacement", unit, place.displacement, recorded.displacement),
        ("Velocity", units.compose("X/s", unit), place.velocity, recorded.velocity),
        ("Amplitude", unit, place.amplitude, recorded.amplitude),
        ("Frequency", "Hz", place.frequency_hz, recorded.frequency_hz),
        ("Time", "s", place.time_s, recorded.time_s),
    ]
    return [
        _Range(name, _scale(symbol, fails, whole), (float(fails[0]), float(fails[1])), whole)
        for name, symbol, fails, whole in entries
        if all(math.isfinite(v) for v in fails) and fails[0] < fails[1]
    ]


def _scale(unit: str, fails: tuple[float, float], whole: tuple[float, float] | None) -> Scale:
    if unit == "s":  # seconds are read off beside the time histories
        return Scale(1.0, "s")
    return scale_of(unit, np.array([*fails, *(whole or ())]))


def location_figure(ranges: list[_Range], shares: dict[int, float], key: str = "location") -> Chart:
    """Chart of the ranges as bars one below the other, and of the harmonic shares below them."""
    said = ", ".join(f"{r.name.lower()} {' to '.join(_ends(r.fails, r.scale))} {r.scale.unit}" for r in ranges)
    chart = Chart(key, f"Where the model fails: {said or 'harmonics'}")
    for span in ranges:
        (panel,) = chart.row(1, height=52)
        low, high = (v * span.scale.factor for v in span.fails)
        if span.whole is not None:
            start, stop = (v * span.scale.factor for v in span.whole)
            panel.marks.append(Box((start, stop), (-0.5, 0.5), GRID, 1.0))
        panel.marks.append(Box((low, high), (-0.5, 0.5), BEFORE, 1.0))
        panel.y.set(label=span.scale.label(span.name), names=(), tight=True)
    if shares:
        (panel,) = chart.row(1, height=200)
        orders = list(shares)[:_MOST_HARMONICS]
        for i, order in enumerate(orders):
            panel.marks.append(Box((i - 0.3, i + 0.3), (0.0, 100 * shares[order]), BEFORE, 1.0))
            if shares[order] >= _LABELLED:
                panel.marks.append(Note(i, 100 * shares[order], percent_text(100 * shares[order]), BEFORE, above=True))
        panel.x.set(names=[(float(i), str(order)) for i, order in enumerate(orders)], low=-0.7, high=len(orders) - 0.3)
        panel.x.label = "Harmonic of the motion [order]"
        panel.y.set(label="Share of the mismatch [%]", low=0.0, high=115 * max(max(shares.values()), 1e-3))
    return chart
