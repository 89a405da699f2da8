"""The overview of a fleet and the page of lives: well-formed, alone, small, every row and every link there."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from dashpot.change import Point, watch
from dashpot.face.row import curve_of
from dashpot.fleet.manifest import Entry
from dashpot.fleet.outcome import STATES, Outcome
from dashpot.fleet.table import Row, as_json, csv_text
from dashpot.model import Oscillator, Provenance, Range
from dashpot.model.element import Element
from dashpot.report.fleet_page import MOST_ROWS, common_amplitude, fleet_page
from dashpot.report.life_page import life_page
from dashpot.report.sparkline import motion_sparkline, value_sparkline

PARAMETERS = {
    "omega0": {"value": 79.6, "std": 0.1, "unit": "rad/s"},
    "viscous": {"value": 5.0, "std": 0.1, "unit": "1/s"},
}


def row(name, state="good", **more):
    outcome = Outcome("0" * 32, name, state, "a sentence", parameters=PARAMETERS, model="model.yaml", **more)
    return Row(Entry(name, name, None, None, ("a.csv",)), outcome, Path(f"results/{name}"))


def well_formed(page):
    """The page's body as XML; raises where it is not well-formed."""
    return ElementTree.fromstring(re.search(r"<main>.*</main>", page, re.DOTALL).group())


def test_every_state_has_its_row_its_words_and_its_link():
    rows = [row(f"rig-{state}", state, picture=(1.0, 0.5), left=(0.1, 0.0)) for state in STATES]
    rows[0] = replace(rows[0], outcome=replace(rows[0].outcome, page="report.html"))
    page = fleet_page("fleet.yaml", rows).html
    tree = well_formed(page)
    links = {a.get("href"): a.text for a in tree.iter("a")}
    assert links["results/rig-good/report.html"] == "rig-good"
    assert len(links) == len(STATES)
    assert "2 of 9 rows are done and believed" in page
    assert page.count("12.669 Hz") == len(STATES)
    assert page.count("<polygon") == 2 * len(STATES)
    assert page.index("rig-doubtful") < page.index("rig-good")  # what is not believed comes first


def curve(low, high, unit="m", power=0.0):
    amplitude = np.geomspace(low, high, 9)
    ratio = 0.02 * (amplitude / 1e-3) ** power
    return {"unit": unit, "amplitude": amplitude.tolist(), "damping_ratio": ratio.tolist()}


def test_damping_is_told_at_the_largest_amplitude_that_most_recordings_covered():
    """Friction makes the damping of a small motion large, so that two rigs compare at one amplitude alone."""
    rows = [
        row("far", curve=curve(1e-4, 8e-3, power=-1.0)),
        *[row(name, curve=curve(1e-4, 2e-3)) for name in ("near", "near as well")],
        row("elsewhere", curve=curve(4e-3, 6e-3)),
        row("turns", curve=curve(1e-4, 2e-3, "rad")),
        row("old"),
    ]
    assert common_amplitude(one.outcome.curve for one in rows) == (2e-3, "m")
    page = fleet_page("fleet.yaml", rows).html
    assert "Damping at 2 mm" in page
    told = {a.text: tr[5].text for tr in well_formed(page).iter("tr") for a in tr[0].iter("a")}
    assert told["near"] == "2 %"
    assert told["far"] == "1 %"
    assert {told[name] for name in ("elsewhere", "turns", "old")} == {"not covered"}
    assert common_amplitude([{}, {}]) is None


def test_the_curve_of_a_model_has_all_that_damps():
    """Viscous damping and friction: h = viscous / 2 + 2 dry / (pi omega A), over omega."""
    values = {"mass": 0.5, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 4.0, "dry": 0.3}
    model = replace(Oscillator.from_values(values), amplitude=Range(1e-5, 5e-3, "m"))
    found = curve_of(model)
    amplitude = np.array(found["amplitude"])
    assert (amplitude[0], amplitude[-1]) == pytest.approx((5e-5, 5e-3))
    expected = (2.0 + 2 * 0.3 / (np.pi * 80.0 * amplitude)) / 80.0
    assert found["damping_ratio"] == pytest.approx(expected, rel=1e-3)
    assert curve_of(replace(model, amplitude=None)) == curve_of(Element.from_values({})) == {}


def test_a_nasty_name_is_harmless():
    page = fleet_page("<b>.yaml", [row("<script>alert(1)</script> & 'x'.csv")]).html
    well_formed(page)
    assert "<script" not in page


def test_ten_thousand_rows_make_no_large_page():
    rows = [row(f"rig{i}", picture=(0.5,) * 60, left=(0.1,) * 60) for i in range(10_000)]
    page = fleet_page("fleet.yaml", rows).html
    assert len(page) < 1_500_000
    assert f"And {10_000 - MOST_ROWS} more rows, in fleet.csv." in page
    assert len(csv_text(rows).splitlines()) == 10_001
    assert as_json(rows)["counts"] == {"good": 10_000}


def test_a_table_of_rigs_with_other_parameters_has_all_of_them():
    other = {"dry": {"value": 0.1, "std": None, "unit": "m/s2"}}
    second = replace(row("b"), outcome=Outcome("1" * 32, "b", "good", 'says "a", then b', parameters=other))
    head, first, last = csv_text([row("a"), second]).splitlines()
    names = head.split(",")
    assert {"omega0", "omega0.std", "viscous.unit", "dry"} <= set(names)
    assert first.split(",")[names.index("omega0")] == "79.6"
    assert '"says ""a"", then b"' in last


def test_sparklines_hold_what_they_are_given():
    assert motion_sparkline((), (), "nothing") == ""
    assert motion_sparkline((1.0, 0.0), (), "<").count("polygon") == 1
    assert value_sparkline([1.0, None, float("nan"), 3.0], "two dots").count("<circle") == 2
    assert value_sparkline([None], "none") == ""


@pytest.fixture(scope="module")
def life():
    names, errors = ("omega0", "viscous"), np.array([0.1, 0.05])
    points = []
    for i in range(8):
        values = {"mass": 1.0, "omega0": 80.0, "viscous": 5.0 + (i > 4), "cubic": 0.0, "preload": 0.0, "dry": 0.0}
        model = Oscillator.from_values(values, name=f"t{i} <x>")
        covariance = tuple(map(tuple, np.diag(errors**2).tolist()))
        model = replace(model, identified=Provenance(parameters=names, covariance=covariance))
        points.append(Point(f"t{i} <x>", model, when=f"2026-03-{i + 1:02d}T00:00:00+00:00"))
    return watch(points, "rig <1>")


def test_the_page_of_a_life_names_what_moved_and_draws_it_first(life):
    page = life_page([life]).html
    tree = well_formed(page)
    assert life.moved.best.moved == ("viscous",)
    assert "viscous moved, and nothing else" in page
    (chart,) = life_page([life]).charts
    assert [panel.title.split()[0] for panel in chart.panels] == ["viscous", "omega0"]
    assert [(figure.get("data-chart")) for figure in tree.iter("figure")] == [chart.key]
    assert len(page) < 400_000
    assert "2026-03-06" in page


def test_many_lives_have_one_page_those_that_changed_first(life):
    still = watch(life.points[:5], "still")
    page = life_page([still, life]).html
    well_formed(page)
    assert "1 of 2 rigs changed." in page
    assert page.index("rig &lt;1&gt;") < page.index("still")
    assert len(life_page([replace(life, name=f"rig{i}") for i in range(40)]).html) < 1_000_000
