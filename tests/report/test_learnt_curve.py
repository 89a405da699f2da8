"""The picture of a learnt curve: the band, the curve, the form over it; nothing where nothing was learnt."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.model import Oscillator
from dashpot.model.formula.closed_form import closed_forms
from dashpot.model.formula.nearest_words import nearest_laws
from dashpot.model.library import find
from dashpot.model.oscillator import Provenance
from dashpot.model.terms import with_term
from dashpot.report.blocks import Figure, Table, Text
from dashpot.report.chart import Band, Line, Rule
from dashpot.report.learnt_curve import learnt_section

VALUES = {"mass": 2.0, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
REACH = 5e-3


@pytest.fixture(scope="module")
def model() -> Oscillator:
    """A spring whose bend is the same everywhere, known to a hundredth: x² beside the straight line."""
    names = [f"at-{k + 1}" for k in range(6)]
    bend = 4000.0
    # the cubic stands for the last knot's height, which all others lack: f'' / reach = 6 cubic x there
    heights = {name: bend - bend * (k / 3 - 1.0) for k, name in enumerate(names)}
    base = Oscillator.from_values(VALUES | {"cubic": bend / (6 * REACH**2)})
    made = with_term(base, "free/spring/6", heights | {"reach": REACH})
    free = ("omega0", "cubic", *(f"free/spring/6.{name}" for name in names))
    errors = np.array([0.01, 0.01 * bend / (6 * REACH**2), *[0.01 * bend] * 6])
    rows = tuple(map(tuple, np.diag(errors**2)))
    return replace(made, identified=Provenance(parameters=free, covariance=rows))


def test_the_section_shows_curve_band_and_form(model):
    forms = closed_forms(model)
    assert forms[0].text == "c0 x + c1 x²"
    assert forms[0].constants["c1"].value == pytest.approx(4000.0 / (2 * REACH), rel=0.05)
    nearest = nearest_laws(model)
    section = learnt_section(SimpleNamespace(model=model, forms=forms, nearest=nearest))
    figure, law, table, text = section.blocks
    assert law.text.startswith("as quadratic-stiffness over all that was recorded. Fitted to the curve there: coeff")
    assert isinstance(figure, Figure)
    assert isinstance(table, Table)
    assert isinstance(text, Text)
    assert "Dashed: c0 x + c1 x²" in figure.caption
    whole, bent = figure.chart.panels
    for panel in (whole, bent):
        (band,) = [mark for mark in panel.marks if isinstance(mark, Band)]
        curve, form = [mark for mark in panel.marks if isinstance(mark, Line)]
        assert np.all((band.low <= curve.y) & (curve.y <= band.high))
        assert np.max(np.abs(form.y - curve.y)) < np.max(band.high - band.low)
    assert whole.x.label == "Displacement [mm]"
    assert table.rows[0][0] == "c0 x + c1 x²"
    assert "--write-law learnt-spring.py" in text.text


def test_a_rule_stands_where_a_curve_departs_from_the_nearest_law(model):
    (nearest,) = nearest_laws(model)
    nearest = replace(nearest, high=3e-3, above="more")
    section = learnt_section(SimpleNamespace(model=model, forms=(), nearest=(nearest,)))
    figure, law = section.blocks
    assert "as quadratic-stiffness up to 3 mm on the positive side, then harder." in law.text
    for panel in figure.chart.panels:
        (rule,) = [mark for mark in panel.marks if isinstance(mark, Rule)]
        assert rule.at == pytest.approx(3.0)
        assert rule.upright


def test_a_curve_without_a_form_says_so(model):
    section = learnt_section(SimpleNamespace(model=model, forms=(), nearest=()))
    (figure,) = section.blocks
    assert isinstance(figure, Figure)
    assert "No closed form of at most two pieces lies within its band." in figure.caption


def test_nothing_learnt_has_no_section(model):
    plain = Oscillator.from_values(VALUES)
    assert learnt_section(SimpleNamespace(model=plain, forms=(), nearest=())).blocks == ()
    bare = replace(model, identified=Provenance())
    assert learnt_section(SimpleNamespace(model=bare, forms=(), nearest=())).blocks == ()


@pytest.mark.parametrize(
    ("effect", "bend", "form", "unit"),
    [
        ("free/inertia", 0.2, "(c0 + c1 x²) x''", "1/m2"),
        ("free/drive", 0.1, "c0 F + c1 F²", "1/N"),
        ("free/sensor", 0.1, "c0 r + c1 r²", "1/m"),
    ],
)
def test_a_mass_a_drive_and_a_sensor_are_drawn_with_their_form(effect, bend, form, unit):
    """Heights that make a square: the same bend everywhere, of a mass a slope that grows in a straight line."""
    names = [f"at-{k + 1}" for k in range(7)]
    heights = {name: bend * ((k - 3) / 3 if effect == "free/inertia" else 1.0) for k, name in enumerate(names)}
    law = find(f"{effect}/6")
    made = with_term(Oscillator.from_values(VALUES), law.name, heights | {law.parameters[-1].name: REACH})
    free = ("mass", *(f"{law.name}.{name}" for name in names))
    rows = tuple(map(tuple, np.diag(np.array([1e-3, *[0.01 * bend] * 7]) ** 2)))
    made = replace(made, identified=Provenance(parameters=free, covariance=rows))
    forms = closed_forms(made)
    assert forms[0].text == form
    assert (forms[0].constants["c0"].value, forms[0].constants["c1"].unit) == (pytest.approx(1.0, abs=0.01), unit)
    square = bend / (2 * REACH**2) if effect == "free/inertia" else bend / (2 * REACH)
    assert forms[0].constants["c1"].value == pytest.approx(square, rel=0.1)
    figure = learnt_section(SimpleNamespace(model=made, forms=forms, nearest=())).blocks[0]
    assert isinstance(figure, Figure)
    assert f"Dashed: {form}" in figure.caption
    assert len(figure.chart.panels) == 2
