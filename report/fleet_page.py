"""A fleet on one page: how many rows stand where, each row with a picture and a link, parameters over the fleet."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from ..model.display import number, percent_text, pretty_unit, scale_of, times_text
from .blocks import Block, Cell, Page, Section, Table, Text, picture
from .fleet_figure import fleet_figure
from .sparkline import motion_sparkline, value_sparkline

if TYPE_CHECKING:
    from ..fleet.table import Row

#: Rows of a table on the page; of a larger fleet the rest stands in the CSV, so that the page stays below 1.5 MB.
MOST_ROWS = 300
#: Values of a parameter that are drawn.
_MOST_DOTS = 200
#: Mark, tone and words of each state.
_SHOWN = {
    "good": ("✓", "good", "the model leaves no more than it may"),
    "mended": ("◆", "good", "a diagnosis named what was missing, and nothing remains"),
    "doubtful": ("▲", "bad", "the model leaves more than it may"),
    "bad-input": ("✕", "bad", "the input cannot be used; tried again when it changes"),
    "fault": ("✕", "bad", "a fault of dashpot; tried again with --again"),
    "killed": ("✕", "bad", "the process was ended; tried again in the next run"),
    "timeout": ("✕", "bad", "took too long; tried again in the next run"),
    "memory": ("✕", "bad", "memory ended; tried again in the next run"),
    "open": ("…", "quiet", "not done yet"),
}


def fleet_page(name: str, rows: Sequence[Row]) -> Page:
    """The overview; links lead to the entries' own pages.

    Args:
        name: of the manifest.
        rows: in the manifest's order.
    """
    from ..fleet.outcome import BELIEVED
    from ..fleet.table import counts

    believed = [row for row in rows if row.outcome.state in BELIEVED]
    others = [row for row in rows if row.outcome.state not in BELIEVED]
    common = common_amplitude(row.outcome.curve for row in rows)
    summary = ", ".join(f"{count} {state}" for state, count in counts(rows).items())
    lead = Text(
        f"{len(believed)} of {len(rows)} rows are done and believed ({summary}).",
        "good" if not others else "bad",
        "✓ All believed." if not others else "▲ Look at these first.",
    )
    sections = [
        Section("Not done, or not believed", _rows(others, common)),
        Section("Done and believed", _rows(believed, common)),
        Section("Parameters over the fleet", _parameters(rows)),
        Section("What the results mean", _states(rows)),
    ]
    return Page(f"Fleet {name}", sections, lead=[lead], footer="All rows and all numbers: fleet.csv, fleet.json.")


def _rows(rows: Sequence[Row], common: tuple[float, str] | None) -> tuple[Block, ...]:
    if not rows:
        return ()
    at = ""
    if common is not None:
        scale = scale_of(common[1], common[0])
        at = f" at {number(common[0] * scale.factor)} {scale.unit}"
    head = ("Entry", "Result", "Motion", "Left", "f0", f"Damping{at}", "In words")
    blocks: list[Block] = [Table(head, tuple(_row(row, common) for row in rows[:MOST_ROWS]), (3, 4, 5), cards=True)]
    if len(rows) > MOST_ROWS:
        blocks.append(Text(f"And {len(rows) - MOST_ROWS} more rows, in fleet.csv."))
    return tuple(blocks)


def _row(row: Row, common: tuple[float, str] | None) -> tuple[str | Cell, ...]:
    outcome = row.outcome
    mark, tone, _ = _SHOWN[outcome.state]
    picture = motion_sparkline(outcome.picture, outcome.left, f"{row.entry.name}: motion, and what is left of it")
    nrmse, times = row.worst("nrmse"), row.worst("over_noise")
    left = "" if nrmse is None else percent_text(100 * nrmse)
    if times is not None:
        left += f" ({times_text(times)} × noise)"
    known = outcome.sentence
    if outcome.effects:
        known = f"{', '.join(outcome.effects)}. {known}"
    return (
        Cell(row.entry.name, link=_link(row)),
        Cell(f"{mark} {outcome.state}", tone),
        Cell("", svg=picture),
        left,
        _f0(outcome.parameters),
        _damping(row, common),
        Cell(known if len(known) <= 400 else f"{known[:399]}…", "quiet"),
    )


def _link(row: Row) -> str:
    if row.folder is None:
        return ""
    return quote(f"{row.folder.as_posix()}/{row.outcome.page or 'entry.json'}")


def _f0(parameters: Any) -> str:
    value = _value(parameters, "omega0")
    return "" if value is None else f"{number(value / (2 * math.pi), 5)} Hz"


def common_amplitude(curves: Iterable[Mapping[str, Any]]) -> tuple[float, str] | None:
    """The largest amplitude that the recordings of as many entries as possible covered, and its unit; None of none.

    Of several units the one that most entries have.
    """
    known = [curve for curve in curves if curve]
    if not known:
        return None
    (unit, _), *_ = Counter(curve["unit"] for curve in known).most_common(1)
    spans = [(min(c["amplitude"]), max(c["amplitude"])) for c in known if c["unit"] == unit]
    return max(((high for _, high in spans)), key=lambda a: (sum(low <= a <= high for low, high in spans), a)), unit


def damping_at(curve: Mapping[str, Any], amplitude: float, unit: str) -> float | None:
    """Damping ratio at an amplitude; None where the recordings did not cover it."""
    if not curve or curve["unit"] != unit:
        return None
    amplitudes = curve["amplitude"]
    if not min(amplitudes) <= amplitude <= max(amplitudes):
        return None
    return float(np.interp(math.log(amplitude), np.log(amplitudes), curve["damping_ratio"]))


def _damping(row: Row, common: tuple[float, str] | None) -> str | Cell:
    """The damping ratio at the amplitude of all, of springs, friction and laws together."""
    if common is None:
        return ""
    ratio = damping_at(row.outcome.curve, *common)
    if ratio is not None:
        return percent_text(100 * ratio)
    return Cell("not covered", "quiet") if row.outcome.parameters else ""


def _value(parameters: Any, name: str) -> float | None:
    return parameters.get(name, {}).get("value")


def _parameters(rows: Sequence[Row]) -> tuple[Block, ...]:
    """Each parameter over the entries: a picture, its median and range."""
    units: dict[tuple[str, str], list[float | None]] = {}
    for i, row in enumerate(rows):
        for name, parameter in row.outcome.parameters.items():
            column = units.setdefault((name, str(parameter["unit"])), [])
            column += [None] * (i - len(column)) + [parameter["value"]]
    lines = []
    for (name, unit), values in units.items():
        known = [value for value in values if value is not None]
        if len(known) < 2:
            continue
        step = max(1, math.ceil(len(values) / _MOST_DOTS))
        title = f"{name} over the entries, in the manifest's order"
        middle = number(statistics.median(known), 4)
        ends = (number(min(known), 4), number(max(known), 4))
        lines.append((name, Cell("", svg=value_sparkline(values[::step], title)), middle, *ends, pretty_unit(unit)))
    if not lines:
        return ()
    caption = "From left to right in the manifest's order. dashpot watch says what changed."
    several = {which: column for which, column in units.items() if sum(value is not None for value in column) > 1}
    names = [row.entry.name for row in rows]
    return (
        Table(("Parameter", "Over the fleet", "Median", "Least", "Largest", "Unit"), tuple(lines), (2, 3, 4), caption),
        picture(lambda: fleet_figure(names, several), "The same with the entries' names: enlarge a part to read all."),
    )


def _states(rows: Sequence[Row]) -> tuple[Block, ...]:
    there = {row.outcome.state for row in rows}
    return (
        Table(
            ("Result", "Meaning"),
            tuple((f"{mark} {state}", words) for state, (mark, _, words) in _SHOWN.items() if state in there),
        ),
    )
