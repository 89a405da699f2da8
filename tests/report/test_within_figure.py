"""The picture of what happens within a cycle, of a decay whose harmonics and half-waves are known in closed form."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.hilbert_result import HilbertAnalysis
from dashpot.recording import Recording
from dashpot.report.chart import Chart
from dashpot.report.hilbert_page import hilbert_page
from dashpot.report.within_figure import within_figure

FS = 250.0


@cache
def analysed(third: float, second: float = 0.0) -> tuple[Recording, HilbertAnalysis]:
    """A decay of 8 Hz with harmonics in a fixed share of the fundamental."""
    t = np.arange(1500) / FS
    a, psi = 2e-3 * np.exp(-0.3 * t), 2 * np.pi * 8 * t
    noise = 1e-7 * np.random.default_rng(2).standard_normal(t.size)
    x = a * (np.cos(psi) + second * np.cos(2 * psi) + third * np.cos(3 * psi)) + noise
    record = Recording("decay.csv", FS, x)
    return record, hilbert_analysis([record])


def words(chart: Chart) -> set[str]:
    return {panel.title for panel in chart.panels} | {mark.label for mark in chart.labelled}


@pytest.mark.parametrize(
    ("third", "second", "drawn"), [(0.02, 0.0, {"harmonic 3"}), (0.0, 0.03, {"harmonic 2"}), (0.0, 0.0, set())]
)
def test_the_harmonics_that_are_there_are_drawn_and_no_others(third, second, drawn):
    _, analysis = analysed(third, second)
    said = words(within_figure(analysis.curves[0], "m"))
    assert {word for word in said if re.fullmatch(r"harmonic \d+", word)} == drawn
    assert ("Harmonics" in said) == bool(drawn)
    assert {"at each instant (Eq. 5)", "mean of the cycle (Eq. 6)", "above rest", "below rest"} <= said


def test_it_stands_on_the_page_with_the_figures_of_the_largest_cycle():
    record, analysis = analysed(0.02)
    page = hilbert_page(analysis, [record]).html
    assert "Within the cycle" in page
    reached = re.search(r"the largest cycle reaches ([\d.]+)(?:&nbsp;| )m", page)
    assert reached is not None
    assert float(reached.group(1)) == pytest.approx(1.02 * analysis.curves[0].amplitude.max(), rel=1e-3)
    without = replace(analysis, curves=tuple(replace(curve, within=None) for curve in analysis.curves))
    assert "Within the cycle" not in hilbert_page(without, [record]).html
