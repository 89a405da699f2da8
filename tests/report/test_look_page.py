"""The page to look at a recording: pieces with their reasons, what a part counts from, modes, what to paste."""

from __future__ import annotations

import html
import json
import re

import dashpot
import numpy as np
import pytest
from dashpot.face.look import facts
from dashpot.face.looked import Look, page_of
from dashpot.recording import Recording
from dashpot.report.chart import Box, Rule
from dashpot.report.look_page import KINDS, Shown, kind_shown, look_page, pieces, time_chart

FS = 500.0
T = np.arange(int(12 * FS)) / FS


def ringing(start: float, f: float, size: float, fall: float) -> np.ndarray:
    since = T - start
    return np.where(since > 0, size * np.exp(-fall * np.abs(since)) * np.sin(2 * np.pi * f * since), 0.0)


@pytest.fixture(scope="module")
def two() -> Recording:
    """At rest for two seconds, then a linear rig of two modes rings."""
    noise = np.random.default_rng(0).normal(size=T.size)
    x = ringing(2.0, 9.3, 4e-3, 0.9) + ringing(2.0, 31.7, 1.5e-3, 1.2) + 1e-6 * noise
    return Recording("two.csv", FS, x, start=5.0)


@pytest.fixture(scope="module")
def seen(two):
    return {"columns": {}, **facts(two)}


def chosen(page) -> dict[str, str]:
    """What the block of choices says to its script."""
    (tag,) = re.findall(r'<div class="chosen"[^>]*>', page.html)
    return {name: html.unescape(value) for name, value in re.findall(r'data-(\w+)="([^"]*)"', tag)}


def test_the_pieces_are_shaded_with_what_becomes_of_them_over_the_time_that_a_part_counts(two, seen):
    chart = time_chart(two, seen, "time", begins=3.0)
    (panel,) = chart.panels
    assert chart.cursors
    assert panel.limits("x") == pytest.approx((3.0, 15.0))
    boxes = [mark for mark in panel.marks if isinstance(mark, Box)]
    free, left, faded = boxes
    assert free.x[0] == pytest.approx(5.0, abs=0.05)
    assert faded.x == (free.x[1], 15.0)
    assert free.said.startswith("Taken as free, 5")
    assert left.x == pytest.approx((3.0, 5.0), abs=0.05)
    assert "s: at rest, or faded into the noise: " in left.said
    assert panel.marks[-1].x[[0, -1]] == pytest.approx((3.0, 15.0 - 1 / FS))


def test_each_mode_can_be_chosen_by_its_frequency(two, seen):
    page = look_page([Shown("two.csv", "two.csv", seen, two)])
    rules = [mark for chart in page.charts for panel in chart.panels for mark in panel.marks if isinstance(mark, Rule)]
    assert [rule.choice for rule in rules] == ["9.301Hz", "31.7Hz"]
    assert rules[1].said.startswith("Mode 2: 31.7")
    assert [rule.at for rule in rules] == pytest.approx(
        [np.hypot(9.3, 0.9 / 2 / np.pi), np.hypot(31.7, 1.2 / 2 / np.pi)], rel=1e-5
    )
    data = json.loads(re.search(r'id="charts">(.*?)</script>', page.html)[1])
    assert [chart["cursors"] for chart in data] == [True, False]
    assert page.html.count('"choice":') == 2


def test_who_made_it_is_said_once(two, seen):
    page = look_page([Shown("two.csv", "two.csv", seen, two)])
    assert page.html.count("Made by") == 1
    assert "Nothing was fitted. Made by dashpot" in page.html


def test_what_is_pasted_is_a_command_or_a_call_with_how_it_was_read(two, seen):
    how = {"unit": "mm", "relative": False, "calibration": {"time": "1 s"}, "channels": ("T",)}
    shown = Shown("my two.csv", "two.csv", seen, two, (4.0, float("inf")), how)
    said = chosen(look_page([shown]))
    command = "dashpot identify 'my two.csv' --unit mm --absolute --calibration 'time=1 s' --channel ...{}"
    assert said["command"] == f"{command} -o rig.yaml --report rig.html"
    assert (said["part"], said["mode"], said["whole"]) == ("--part {}", "--mode {}", "4:")
    said = chosen(look_page([shown], python=True))
    assert said["command"].startswith("dashpot.identify('my two.csv', unit='mm', relative=False, ")
    assert said["command"].endswith("channels=...{})")
    assert (said["part"], said["mode"]) == ('part="{}"', 'mode="{}"')
    nameless = chosen(look_page([Shown(None, "r", seen, two)], python=True))
    assert nameless["command"] == "dashpot.identify(...{})"


def test_what_was_refused_is_said_beside_the_others(two, seen):
    refused = Shown("b.csv", "b<.csv", {"refused": "b.csv: no column is a response; name it\nand so on"}, None)
    page = look_page([Shown("two.csv", "two.csv", seen, two), refused])
    assert [section.title for section in page.sections] == ["two.csv", "b<.csv"]
    assert [section.folded for section in page.sections] == [False, False]
    assert "no column is a response; name it." in page.html
    assert page.html.count('class="chosen"') == 1
    assert "b&lt;.csv" in page.html


def test_pieces_of_a_kind_that_follow_one_another_are_one():
    found = [{"kind": "driven", "start": i / 10, "stop": (i + 1) / 10} for i in range(3)]
    found.append({"kind": "free", "start": 0.3, "stop": 1.0})
    taken, left = pieces({"fs": 100.0, "pieces": found, "left": [{"start": 1.0, "stop": 1.2, "why": "at rest"}]})
    assert taken == [("driven", 0, 30), ("free", 30, 100)]
    assert left == [(100, 120, "at rest")]


def test_a_hammer_has_a_kind_of_its_own_and_every_kind_a_sentence():
    assert kind_shown({"motion": "bursts", "pieces": [{"kind": "struck"}]}) == "struck"
    assert kind_shown({"motion": "sweep", "pieces": [{"kind": "driven"}]}) == "sweep"
    assert set(KINDS) >= {"decay", "bursts", "sine", "sweep", "broadband", "prescribed", "struck"}


def test_the_built_in_recordings_have_their_page():
    file = dashpot.examples.recordings()["bursts"]
    looked = dashpot.look(file)
    assert isinstance(looked, Look)
    page = page_of(looked._seen)
    assert "bursts: a force drives it and is silent in between" in page.html
    assert chosen(page)["modes"] == "One mode was found, which needs no option."
    assert len(page.html) < 1_500_000


def test_a_recording_at_rest_has_a_page_too():
    still = Recording("still.csv", FS, np.zeros(2000))
    page = look_page([Shown("still.csv", "still.csv", {"columns": {}, **facts(still)}, still)])
    assert "A fit would take nothing of it" in page.html
    assert len(page.charts) == 1
