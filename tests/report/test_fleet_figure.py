"""A fleet's parameters as a chart: each entry at its place, under its name, with the median of what is known."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.report.chart import Dots, Rule
from dashpot.report.d3_chart import as_json
from dashpot.report.fleet_figure import fleet_figure


def test_each_entry_stands_at_its_place_and_one_that_is_not_known_nowhere():
    columns = {("mass", "kg"): [0.27, None, 0.30, 0.29], ("dry", "m/s2"): [0.1, 0.2], ("cubic", "1/(m2.s2)"): [None]}
    chart = fleet_figure(["a", "b", "c", "d"], columns)
    mass, dry, cubic = chart.panels
    assert [len(row) for row in chart.rows] == [2, 1]
    (dots,) = (mark for mark in mass.marks if isinstance(mark, Dots))
    assert dots.x == pytest.approx([1, 2, 3, 4])
    assert dots.y == pytest.approx([0.27, np.nan, 0.30, 0.29], nan_ok=True)
    (median,) = (mark.at for mark in mass.marks if isinstance(mark, Rule))
    assert median == pytest.approx(0.29)
    assert mass.title == "mass [kg]"
    assert list(mass.x.names or ()) == [(1.0, "a"), (2.0, "b"), (3.0, "c"), (4.0, "d")]
    assert [mark.y[2:].tolist() for mark in dry.marks if isinstance(mark, Dots)] == [
        pytest.approx([np.nan] * 2, nan_ok=True)
    ]
    assert not any(isinstance(mark, Rule) for mark in cubic.marks)


def test_of_a_large_fleet_some_names_stand_there_and_the_data_stay_small():
    names = [f"rig {i} of many with a long name" for i in range(10_000)]
    columns = {(f"p{i}", "1"): np.random.default_rng(i).normal(size=10_000).tolist() for i in range(8)}
    text = as_json([fleet_figure(names, columns)])
    assert len(text) < 600_000
    (chart,) = json.loads(text)
    shown = chart["rows"][0][0]["x"]["names"]
    assert len(shown) == 200
    assert shown[1] == [51.0, "rig 50 of many with a lon"[:24]]
