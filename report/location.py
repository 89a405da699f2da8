"""Where a model fails: the ranges against what was recorded, and the harmonics of what it leaves over."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model import units
from ..model.display import Scale, full_stop, number, percent_text, scale_of
from .blocks import Block, Section, Table, Text, picture
from .style import BEFORE, GRID, MEASURED, drawing, svg

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
        return Section(title, (Text("Nowhere beyond the noise of these recordings."),))
    blocks: list[Block] = [Text(full_stop(place.statement) or "not stated.", "note", "It fails:")]
    ranges = _ranges(diagnosis, place)
    shares = {order: share for order, share in sorted(place.harmonics.items()) if math.isfinite(share)}
    if ranges or shares:
        told = [
            *(["Left: where the mismatch lies (coloured) within what was recorded (grey)"] if ranges else []),
            *(["Right: its power by harmonics of the motion (0: its mean)"] if shares else []),
        ]
        caption = ". ".join(told if len(told) > 1 else [told[0].partition(": ")[2].capitalize()]) + "."
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


def location_figure(ranges: list[_Range], shares: dict[int, float], key: str = "location") -> str:
    """SVG of the ranges as bars one below the other, and of the harmonic shares beside them."""
    rows = max(len(ranges), 1)
    with drawing(height=max(0.62 * rows + 0.35, 2.3)) as figure:
        columns = [2.0, 1.0] if ranges and shares else [1.0]
        parts = figure.subfigures(1, len(columns), width_ratios=columns, squeeze=False)[0]
        if ranges:
            for axes, span in zip(parts[0].subplots(rows, 1, squeeze=False)[:, 0], ranges, strict=True):
                _bar(axes, span)
        if shares:
            axes = parts[-1].subplots()
            orders = list(shares)[:_MOST_HARMONICS]
            bars = axes.bar([str(o) for o in orders], [100 * shares[o] for o in orders], color=BEFORE, width=0.6)
            axes.bar_label(
                bars,
                [percent_text(100 * shares[o]) if shares[o] >= _LABELLED else "" for o in orders],
                padding=2,
                fontsize=9,
            )
            axes.grid(visible=False, axis="x")
            axes.set_xlabel("Harmonic of the motion [order]")
            axes.set_ylabel("Share of the mismatch [%]")
        said = ", ".join(f"{r.name.lower()} {' to '.join(_ends(r.fails, r.scale))} {r.scale.unit}" for r in ranges)
        return svg(figure, key, f"Where the model fails: {said or 'harmonics'}")


def _bar(axes: Any, span: _Range) -> None:
    low, high = (v * span.scale.factor for v in span.fails)
    if span.whole is not None:
        start, stop = (v * span.scale.factor for v in span.whole)
        axes.barh(0, stop - start, left=start, height=0.5, color=GRID, edgecolor=MEASURED, linewidth=0.6)
        low_view, high_view = min(start, low), max(stop, high)
    else:
        low_view, high_view = low, high
    axes.barh(0, high - low, left=low, height=0.5, color=BEFORE)
    margin = 0.02 * (high_view - low_view)
    axes.set_xlim(low_view - margin, high_view + margin)
    axes.set_yticks([])
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)
    axes.set_ylabel(span.scale.label(span.name), rotation=0, ha="right", va="center")
