"""A curve that was learnt from the motion, with its band, the closed form that it may be, and where the motion was."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..model import units
from ..model.display import pretty_unit, scale_of, value_text
from ..model.formula.curve import LearntCurve, curve_of, learnt_terms
from ..model.formula.nearest_words import in_words
from .blocks import Block, Section, Table, Text, picture
from .chart import Chart
from .style import AFTER, BEFORE, EXACT, MEASURED

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis
    from ..model import Oscillator, Parameter
    from ..model.formula.closed_form import ClosedForm
    from ..model.formula.nearest_law import NearestLaw

_NORMAL = 1.96  # standard errors: 95 %
_WORDS = {
    "free/spring": ("Restoring force per unit mass", "Displacement"),
    "free/damping": ("Resistance per unit mass", "Velocity"),
    "free/surface": ("Damping", "Displacement"),
    "free/inertia": ("Moving mass over that of Eq. 17", "Displacement"),
    "free/drive": ("Force that reaches the mass", "Recorded force"),
    "free/sensor": ("What the sensor shows", "What reaches it"),
}


def learnt_section(diagnosis: Diagnosis) -> Section:
    """A picture of each learnt curve and the forms within its band; empty where nothing was learnt."""
    model, blocks = diagnosis.model, []
    for term in learnt_terms(model) if model.identified.covariance is not None else ():
        curve = curve_of(model, term)
        forms = [form for form in diagnosis.forms if form.effect == curve.effect]
        nearest = next((law for law in diagnosis.nearest if law.effect == curve.effect), None)
        blocks.append(picture(partial(learnt_figure, model, curve, forms[:1], nearest), _caption(forms)))
        if nearest is not None:
            blocks.append(Text(f"{in_words(nearest, model)}.{_beside(nearest)}", lead="The nearest law:"))
        blocks += _forms(forms)
    return Section("What was learnt, as a curve and as a formula", tuple(blocks))


def _beside(nearest: NearestLaw) -> str:
    """The law's constants, fitted to the curve where it lies within the band."""
    if not nearest.parameters:
        return ""
    numbers = ", ".join(f"{name} = {_with_error(p)}" for name, p in nearest.parameters.items())
    return f" Fitted to the curve there: {numbers}."


def learnt_figure(
    model: Oscillator, curve: LearntCurve, forms: list[ClosedForm], nearest: NearestLaw | None = None
) -> Chart:
    """Chart of the whole curve, and of it without its straight line; form values, and where a law ends, over it."""
    kind, response = curve.kind, model.response
    over_unit, force = (
        units.compose(template, response.displacement_unit, model.force_unit, response.unit)
        for template in (kind.over, kind.unit)
    )
    across = scale_of(over_unit, curve.at)
    what, over = _WORDS[curve.effect]
    chart = Chart(f"learnt-{curve.effect.partition('/')[2]}", f"{what} over {over.lower()} in {across.unit}")
    whole, bent = chart.row(1, 1, height=290)
    straight = np.ones(curve.at.size) if kind.times else curve.at
    slope = float(straight @ curve.value / (straight @ straight))
    shown, room = curve.at * across.factor, _NORMAL * curve.std
    for panel, part, title in (
        (whole, 0.0, what),
        (bent, slope, "… without its mean" if kind.times else "… without a straight line"),
    ):
        value = curve.value - part * straight
        panel.band(shown, value - room, value + room, MEASURED, "learnt, with 95 %", alpha=0.35)
        panel.line(shown, value, AFTER, "learnt")
        for form in forms:
            panel.line(shown, form.at(curve.at) - part * straight, BEFORE, "closed form", dash="--", width=2.0)
        for place in _departures(nearest):
            panel.rule(place * across.factor, EXACT, f"{_law(nearest)} up to here", dash=":", upright=True)
        panel.x.set(label=across.label(over), tight=True)
        panel.y.set(label=f"{what} [{pretty_unit(force)}]")
        panel.title = title
    return chart


def _law(nearest: NearestLaw | None) -> str:
    return "" if nearest is None else nearest.law or "Eq. 17"


def _departures(nearest: NearestLaw | None) -> list[float]:
    """Where the curve departs from the nearest law."""
    if nearest is None:
        return []
    return [at for at, way in ((nearest.low, nearest.below), (nearest.high, nearest.above)) if way]


def _caption(forms: list[ClosedForm]) -> str:
    words = (
        "The whole with Eq. 17's part, over what was recorded; beyond that the model goes on in a straight line, "
        "which nothing speaks for."
    )
    if not forms:
        return words + " No closed form of at most two pieces lies within its band."
    return words + f" Dashed: {forms[0].text}, the shortest closed form within its band."


def _forms(forms: list[ClosedForm]) -> list[Block]:
    if not forms:
        return []
    rows = []
    for form in forms:
        numbers = ", ".join(f"{name} = {_with_error(p)}" for name, p in form.constants.items())
        rows.append((form.text, numbers, "shortest" if form.information == 0.0 else f"{form.information:.1f}"))
    table = Table(
        ("Closed form", "Constants", "Longer by, nats"),
        tuple(rows),
        caption="Forms within the band, the shortest description first. One that is longer by 3 is 20 times less "
        "probable.",
        cards=True,
    )
    name = f"learnt-{forms[0].effect.partition('/')[2]}.py"
    return [
        table,
        Text(f"--write-law {name} writes the shortest as a law file, for --law and --with.", lead="To go on:"),
    ]


def _with_error(parameter: Parameter) -> str:
    value, error = value_text(parameter)
    unit = "" if parameter.unit == "1" else f" {pretty_unit(parameter.unit)}"
    return f"{value} ± {error}{unit}" if error else f"{value}{unit}"
