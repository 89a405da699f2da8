"""Charts as values: their views, legends and figures, as data for a browser and as files."""

from __future__ import annotations

import json
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from dashpot.report import d3_chart
from dashpot.report.blocks import Figure, Page, Section
from dashpot.report.chart import Box, Chart, Note
from dashpot.report.d3_chart import as_json, figures, legend
from dashpot.report.matplotlib_figure import KINDS, drawn
from dashpot.report.style import EXACT, FREE, MEASURED, MODEL


def loop() -> Chart:
    """Force over displacement of a rig with friction, each kind of mark once."""
    chart = Chart("loop", "Force over displacement")
    left, right = chart.row(2, 1)
    turn = np.linspace(0, 40 * np.pi, 100_000)
    x = 3 * np.sin(turn)
    left.line(x, 2 * x + np.sign(np.cos(turn)), FREE, "measured <loop>", width=1.0)
    left.dots([0.0], [1.0], MODEL, "breaks away", marker="s", hollow=True)
    left.rule(0.0, EXACT)
    left.marks += [Box((-1.0, 1.0), None), Note(0.0, 1.0, "friction & more", EXACT)]
    left.x.set(label="Displacement [mm]")
    left.y.set(label="Force [N]")
    right.band([1.0, 10.0, 100.0], [1e-3, math.nan, 0.1], [1e-2, 0.2, 1.0], MEASURED, "± error")
    right.x.set(label="Frequency [Hz]", log=True)
    right.y.set(label="Density [N]", log=True)
    return chart


def test_a_view_takes_in_what_is_drawn_and_keeps_what_was_set():
    left, right = loop().panels
    assert left.limits("x") == pytest.approx((-3.3, 3.3), rel=1e-6)
    left.y.set(low=-1.0)
    assert left.limits("y")[0] == -1.0
    assert right.limits("y") == pytest.approx((1e-3 / 1000**0.05, 1000**0.05))
    (empty,) = Chart("empty").row(1)
    assert empty.limits("x") == pytest.approx((-0.05, 1.05))
    empty.line([2.0, 2.0], [0.0, 0.0], FREE)
    assert empty.limits("x") == (1.0, 3.0)
    low, high = empty.limits("y")
    assert low < 0.0 < high


def test_data_are_sound_small_and_keep_the_ends_of_a_loop():
    text = as_json([loop()])
    assert len(text) < 60_000
    (chart,) = json.loads(text, parse_constant=lambda odd: pytest.fail(odd))
    left, right = chart["rows"][0]
    line = left["marks"][0]
    assert (min(line["x"]), max(line["x"])) == (-3.0, 3.0)
    assert (min(line["y"]), max(line["y"])) == (-7.0, 7.0)
    assert right["marks"][0]["low"] == [0.001, None, 0.1]
    assert right["x"]["kind"] == "log"


def test_a_page_of_many_long_charts_stays_below_its_size():
    charts = []
    for i in range(60):
        chart = Chart(f"c{i}")
        for panel in chart.row(1, 1):
            panel.line(np.arange(1e5), np.random.default_rng(i).standard_normal(100_000), FREE)
        charts.append(Figure(chart, "noise"))
    page = Page("Many", [Section("All", tuple(charts))])
    assert len(page.html) < 1_500_000


def test_the_legend_and_the_figures_say_in_words_what_is_drawn():
    chart = loop()
    said = legend(chart)
    assert [re.sub(r"<[^>]+>", "", item) for item in re.findall(r"<li>(.*?)</li>", said)] == [
        "measured &lt;loop&gt;",
        "breaks away",
        "± error",
    ]
    rows = figures(chart)
    assert ("Force [N]", "measured <loop>", "−3 to 3 mm", "−7 to 7 N") in rows
    assert ("Density [N]", "± error", "1 to 100 Hz", "0.001 to 1 N") in rows


def test_a_page_without_d3_says_what_to_install(monkeypatch):
    page = Page("One", [Section("Only", (Figure(loop(), "A loop."),))])
    assert "pip install" not in page.html
    assert "scripts are off" in page.html
    assert page.html.count("<script") == 3
    monkeypatch.setattr(d3_chart, "library", lambda: None)
    assert "pip install mpld3" in page.html
    assert "<script" not in page.html
    assert "−3 to 3 mm" in page.html


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_is_drawn_of_it_the_same_each_time(kind):
    import matplotlib

    first = drawn(loop(), kind)
    with matplotlib.rc_context({"font.size": 30, "svg.fonttype": "path"}):
        assert drawn(loop(), kind) == first
    assert first.startswith({"pdf": b"%PDF", "png": b"\x89PNG", "svg": b"<?xml"}[kind])
    if kind == "svg":
        words = {(e.text or "").strip() for e in ElementTree.fromstring(first).iter("{http://www.w3.org/2000/svg}text")}
        assert {"Displacement [mm]", "measured <loop>", "friction & more"} <= words
