"""What changed, in sentences and in a table of text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..files.spoken import spoken
from ..model.parameter import Parameter
from ..model.show import value_and_error
from .comparison import Comparison
from .moved import Hypothesis, Moved
from .quantities import Change, Quantity


def percent_change(first: float, second: float) -> str:
    """How far a value went, in percent of where it was; empty where it was zero."""
    if not first or not math.isfinite(second / first):
        return ""
    share = 100 * (second - first) / abs(first)
    return f"{share:+.3g} %" if abs(share) < 9.5e2 else f"{share:+.2g} %"


def verdict(moved: Moved, *, differs: bool) -> str:
    """Which parameters moved, and what cannot be distinguished from that."""
    best = moved.best.moved
    if not best and not differs:
        return "Nothing moved: the models differ by no more than chance makes"
    if not best:
        return "The models differ by more than their errors, but no parameter stands out from the rest"
    several = "moved together" if len(best) > 1 else "moved"
    rivals = f", or else {_rivals(moved.rivals)}, which explains it as well" if moved.rivals else ""
    stays = ", and nothing else" if moved.best.freedom else ": all that both estimate"
    return f"{spoken(best)} {several}{stays}{rivals}"


def _rivals(rivals: Sequence[Hypothesis]) -> str:
    return spoken([spoken(rival.moved) for rival in rivals], "or")


def sentence(comparison: Comparison) -> str:
    """The whole in one sentence or two; of models that leave more than noise it says less."""
    parts = []
    units = {shift.name: shift.unit for shift in comparison.shifts}
    for name, (first, second) in comparison.explained.items():
        own = Quantity(name, units[name], (1.0, 1.0))
        change = Change.of(comparison.machine.get(name, own), 0, 1, first[0], second[0])
        share = percent_change(change.before, change.after)
        parts.append(f"{change.words}{f' ({share}, all else common to both)' if share else ''}")
    said = verdict(comparison.moved, differs=comparison.differs)
    if not comparison.moved.best.moved and not comparison.differs and not comparison.repeatability.trusted:
        said = "Nothing is seen to have moved, by models that leave more than noise: see below"
    laws = (("appeared", comparison.appeared), ("vanished", comparison.vanished))
    changes = [f"{spoken(names)} {words}" for words, names in laws if names]
    if changes and not comparison.moved.best.moved and not comparison.differs:
        return f"{spoken(changes)}; no parameter that both have is seen to have moved."
    text = " ".join([f"{said}{': ' if parts else ''}{'; '.join(parts)}.", *(f"{change}." for change in changes)])
    return text[0].upper() + text[1:] if comparison.moved.best.moved == () else text


def describe(comparison: Comparison) -> str:
    """What ``dashpot compare`` prints."""
    head = ("parameter", comparison.first[:24], comparison.second[:24], "unit", "change", "errors", "in all", "p", "")
    rows: list[tuple[str, ...]] = [head]
    for s in comparison.shifts:
        rows.append(
            (
                s.name,
                " ± ".join(value_and_error(Parameter(s.first, s.first_error))),
                " ± ".join(value_and_error(Parameter(s.second, s.second_error))),
                "" if s.unit == "1" else s.unit,
                percent_change(s.first, s.second) or f"{s.change:+.3g}",
                f"{s.errors:+.1f}",
                f"{s.repeats:+.1f}",
                f"{s.chance:.2g}",
                "moved" if s.moved else f"seen from ±{s.seen_from:.2g}",
            )
        )
    width = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = [
        "  ".join(f"{cell:{'<' if i in (0, 3, 8) else '>'}{width[i]}}" for i, cell in enumerate(row)).rstrip()
        for row in rows
    ]
    judged = judged_by(comparison)
    notes = [f"- {note}" for note in comparison.notes]
    return "\n".join([sentence(comparison), "", *lines, "", judged, *notes])


def judged_by(comparison: Comparison) -> str:
    """What the errors are in the columns, for a reader of the table."""
    known = comparison.repeatability
    words = "errors: of the difference, as stated; in all: with what "
    if known.source == "errors":
        words += "did not move makes of them" if not known.trusted else "repeats would add, of which none were given"
    else:
        words += f"repeats add ({known.learnt} degrees of freedom)"
    return f"{words}; p: by that, for one of {len(comparison.shifts)} parameters"


def as_json(comparison: Comparison) -> dict[str, Any]:
    """``dashpot-comparison/1``."""
    return {
        "format": "dashpot-comparison/1",
        "first": comparison.first,
        "second": comparison.second,
        "sentence": sentence(comparison),
        "moved": list(comparison.moved.best.moved),
        "or_else": [list(rival.moved) for rival in comparison.moved.rivals],
        "explained": {
            name: [{"value": value, "std": error} for value, error in pair]
            for name, pair in comparison.explained.items()
        },
        "machine": {
            name: Change.of(comparison.machine[name], 0, 1, first, second).as_json()
            for name, ((first, _), (second, _)) in comparison.explained.items()
            if name in comparison.machine
        },
        "chance_of_nothing_moved": comparison.moved.nothing.chance,
        "chance_of_what_is_left": comparison.moved.best.chance,
        "appeared": list(comparison.appeared),
        "vanished": list(comparison.vanished),
        "judged_by": comparison.repeatability.source,
        "degrees_of_freedom": comparison.repeatability.learnt,
        "errors_inflated_by": math.sqrt(comparison.repeatability.inflation * comparison.moved.inflation),
        "parameters": {
            shift.name: {
                **{"unit": shift.unit, "first": shift.first, "second": shift.second, "change": shift.change},
                **{"first_std": shift.first_error, "second_std": shift.second_error},
                **{"in_errors": shift.errors, "in_repeatability": shift.repeats, "chance": shift.chance},
                **{"moved": shift.moved, "seen_from": shift.seen_from},
            }
            for shift in comparison.shifts
        },
        "notes": list(comparison.notes),
    }
