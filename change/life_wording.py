"""The life of a rig in sentences, and as a table of text."""

from __future__ import annotations

import math
from typing import Any

from ..files.spoken import spoken
from ..model.parameter import Parameter
from ..model.show import value_and_error
from .life import Life
from .quantities import Change, Quantity
from .wording import percent_change, verdict

_MOST = 8  # steps that are listed one by one


def sentences(life: Life) -> list[str]:
    """What moved, then when."""
    if life.moved is None:
        return ["One state: nothing to compare it with."]
    parts = [f"{verdict(life.moved, differs=life.differs)}."]
    for name in life.moved.best.moved:
        quantity = _quantity(life, name)
        steps = [step for step in life.steps if step.parameter == name]
        if name in life.drifts:
            slope, error = (quantity.factors[0] * value for value in life.drifts[name])
            size = f"{slope:.3g} ± {error:.2g} {quantity.unit}"
            parts.append(f"{quantity.name} drifts by {size} from state to state, in a straight line.")
            continue
        if not steps:
            parts.append(f"{name}: no single step stands out.")
        for step in steps[:_MOST]:
            change = Change.of(quantity, step.state - 1, step.state, step.before, step.after)
            share = percent_change(change.before, change.after)
            size = abs(step.after - step.before) / step.error if step.error > 0 else math.inf
            much = f"{share}{', ' if share else ''}{size:.3g} of its errors, all else common"
            parts.append(
                f"{name} changes between {life.label(step.state - 1)} and {life.label(step.state)}: {change.words} "
                f"({much})."
            )
        if len(steps) > _MOST:
            parts.append(f"{name}: and {len(steps) - _MOST} more steps.")
    for state, new, gone in life.laws:
        for words, laws in (("appears", new), ("vanishes", gone)):
            if laws:
                parts.append(f"{spoken(laws)} {words} at {life.label(state)}.")
    return parts


def _quantity(life: Life, name: str) -> Quantity:
    """A parameter as the machine has it; itself where it is no other there."""
    unit = life.estimates.units[life.estimates.names.index(name)]
    return life.machine.get(name) or Quantity(name, unit, (1.0,) * len(life.groups))


def repeatability_words(life: Life) -> str:
    """What the changes were held against."""
    known = life.repeatability
    inflation = known.inflation * (1.0 if life.moved is None else life.moved.inflation)
    text = {
        "repeats": f"Held against repeats ({known.learnt} degrees of freedom).",
        "neighbours": f"Held against how neighbours differ ({known.learnt} degrees of freedom): no repeats are marked.",
        "errors": "Held against the stated errors: no repeats are marked, and there are few tests.",
    }[known.source]
    if inflation > 1.001:
        text += f" The stated errors were taken {math.sqrt(inflation):.3g} times as large."
    spread = [
        f"{name} {known.spread[j] * life.estimates.scale[j]:.2g} {life.estimates.units[j]}"
        for j, name in enumerate(life.estimates.names)
        if known.spread[j] > 0
    ]
    if spread:
        text += f" Between repeats beyond that: {', '.join(spread)}."
    return text


def describe(life: Life) -> str:
    """What ``dashpot watch`` prints of a rig."""
    names = life.estimates.names
    moved = () if life.moved is None else life.moved.best.moved
    units = ["" if unit == "1" else f" [{unit}]" for unit in life.estimates.units]
    told = zip(names, units, strict=True)
    head = ["", "when", *(f"{name}{unit}{' *' if name in moved else ''}" for name, unit in told)]
    rows = [head]
    for point in life.points:
        parameters = point.model.parameters()
        rows.append(
            [
                point.name if point.state is None else f"{point.name} ({point.state})",
                "" if point.when is None else str(point.when).removesuffix("T00:00:00+00:00"),
                *(plus_minus(parameters[name]) for name in names),
            ]
        )
    if not any(row[1] for row in rows[1:]):
        rows = [[row[0], *row[2:]] for row in rows]
    width = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(f"{cell:<{width[i]}}" for i, cell in enumerate(row)).rstrip() for row in rows]
    notes = [f"- {note}" for note in life.notes]
    return "\n".join([f"{life.name}: {' '.join(sentences(life))}", "", *lines, "", repeatability_words(life), *notes])


def plus_minus(parameter: Parameter) -> str:
    """``1.0480 ± 0.0028``."""
    value, error = value_and_error(parameter)
    return f"{value} ± {error}" if error else value


def as_json(life: Life) -> dict[str, Any]:
    """``dashpot-watch/1``."""
    scale = life.estimates.scale
    return {
        "format": "dashpot-watch/1",
        "rig": life.name,
        "sentences": sentences(life),
        "moved": [] if life.moved is None else list(life.moved.best.moved),
        "or_else": [] if life.moved is None else [list(rival.moved) for rival in life.moved.rivals],
        "judged_by": life.repeatability.source,
        "degrees_of_freedom": life.repeatability.learnt,
        "repeatability": {
            name: float(life.repeatability.spread[j] * scale[j]) for j, name in enumerate(life.estimates.names)
        },
        "errors_inflated_by": math.sqrt(
            life.repeatability.inflation * (1.0 if life.moved is None else life.moved.inflation)
        ),
        "changes": [
            {
                **{"parameter": step.parameter, "after": life.label(step.state - 1), "at": life.label(step.state)},
                **{"from": step.before, "to": step.after, "std": step.error},
                "machine": Change.of(
                    _quantity(life, step.parameter), step.state - 1, step.state, step.before, step.after
                ).as_json(),
            }
            for step in life.steps
        ],
        "drifts": {name: {"per_state": slope, "std": error} for name, (slope, error) in life.drifts.items()},
        "laws": [
            {"at": life.label(state), "appeared": list(new), "vanished": list(gone)} for state, new, gone in life.laws
        ],
        "points": [
            {
                **{"name": point.name, "state": point.state, "when": point.when},
                "parameters": {n: {"value": p.value, "std": p.std} for n, p in point.model.parameters().items()},
            }
            for point in life.points
        ],
        "notes": list(life.notes),
    }
