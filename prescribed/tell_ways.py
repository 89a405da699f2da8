"""What depends on a channel, in words and as data."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..diagnose.result import SURE
from ..diagnose.wording import figure, quantity
from ..files.spoken import spoken
from ..model.dependence import Dependence, strength_at
from ..model.element import Element
from ..model.show import finite
from .channels import Way
from .element_fit import ElementFit
from .search import Found, NamedWay

_FORMS = {
    "linear": "in a straight line",
    "origin": "in proportion to it",
    "power": "as a power of it",
    "inverse": "as one over a straight line",
}


def of_element(way: Way, element: Element) -> Dependence:
    """The dependence of an element that a fit found so."""
    return next(d for d in element.dependences if (d.of, d.channel) == (way.of, way.channel))


def what_depends(of: str, element: Element) -> str:
    """A strength in words."""
    effect, _, own = of.rpartition(".")
    return f"{own} of {effect}" if effect else element.descriptions()[of].partition(",")[0]


def ends_of(one: Dependence, element: Element) -> tuple[float, float]:
    """The strength at both ends of what was recorded of a channel, others at their references."""
    known = element.parameters()
    low, high = (
        float(strength_at(element.dependences, one.of, known[one.of].value, element.values(), {one.channel: value}))
        for value in (one.low, one.high)
    )
    return low, high


def dependence_in_words(named: NamedWay, element: Element) -> str:
    """``viscous damping grows with the current, in a straight line, from 240 N.s/m at 0 A to 360 N.s/m at 0.5 A``."""
    one = of_element(named.way, element)
    low, high = ends_of(one, element)
    unit = element.parameters()[one.of].unit
    verb = "grows" if abs(high) > abs(low) else "falls"
    if low * high < 0.0:
        verb = "changes its sign"
    said = (
        f"{what_depends(one.of, element)} {verb} with the {one.channel}, {_FORMS[one.how]}, from {quantity(low, unit)} "
        f"at {figure(one.low)} {one.unit} to {quantity(high, unit)} at {figure(one.high)} {one.unit}"
    )
    return said.replace("_", " ")


def not_told(named: NamedWay) -> str:
    """What it is not told from, in words; empty for nothing."""
    forms, others = _apart(named)
    return spoken([*(f"{_FORMS[how]}" for how in forms), *others], "or")


def _apart(named: NamedWay) -> tuple[list[str], list[str]]:
    """Other forms of the same dependence, and other causes, among the rivals."""
    way, forms, others = named.way, [], []
    for rival in named.rivals:
        how = next((how for how in _FORMS if rival == str(Way(way.channel, way.of, how))), None)
        if how is None:
            others.append(rival)
        else:
            forms.append(how)
    return forms, others


def said_of(found: Found, element: Element) -> list[str]:
    """Each dependence in words, with the forms that are not told from its own."""
    made = []
    for named in found.dependent:
        forms, _ = _apart(named)
        apart = (
            f" (or {spoken([_FORMS[how] for how in forms], 'or')}: the recordings do not tell which)" if forms else ""
        )
        made.append(f"{dependence_in_words(named, element)}{apart}")
    return made


def few_values(found: Found, fit: ElementFit) -> str | None:
    """A test that tells forms apart, where two values of a channel do not; None where there is none such."""
    for named in found.dependent:
        name = named.way.channel
        held = [motion.channels[name] for motion in fit.motions]
        if _apart(named)[0] and all(float(np.ptp(values)) == 0.0 for values in held):
            one = of_element(named.way, fit.element)
            values = sorted({float(values[0]) for values in held})
            middle = quantity(0.5 * (one.low + one.high), one.unit)
            return (
                f"Record at a further {name}, such as {middle}: {len(values)} values of it do not tell how "
                f"{what_depends(one.of, fit.element)} runs between and beyond them."
            )
    return None


def as_effects(found: Found, fit: ElementFit) -> list[dict[str, Any]]:
    """As ``diagnosis.json`` has them, beside the laws."""
    made = []
    for named in found.dependent:
        one, known = of_element(named.way, fit.element), fit.element.parameters()
        low, high = ends_of(one, fit.element)
        numbers = {"at_reference": known[one.of]}
        if one.parameter is not None:
            numbers[one.form.parameter] = one.parameter
        made.append(
            {
                "effect": "channel",
                "law": one.how,
                "path": "channel",
                "channel": one.channel,
                "of": one.of,
                "reference": {"value": one.reference, "unit": one.unit},
                "recorded": {"min": one.low, "max": one.high, "unit": one.unit},
                "strength": {"at_min": low, "at_max": high, "unit": known[one.of].unit},
                "parameters": {n: {"value": p.value, "std": finite(p.std), "unit": p.unit} for n, p in numbers.items()},
                "indistinguishable_from": list(named.rivals),
                "separated_by": "",
                "odds": min(named.odds, SURE),
                "probability": min(named.odds, SURE) / (1.0 + min(named.odds, SURE)),
                "share": named.share,
            }
        )
    return made
