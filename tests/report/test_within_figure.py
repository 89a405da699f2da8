"""The picture of what happens within a cycle, of a decay whose harmonics and half-waves are known in closed form."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify import hilbert_analysis
from dashpot.recording import Recording
from dashpot.report.hilbert_page import hilbert_page
from dashpot.report.within_figure import within_figure

FS = 500.0


def decay(third: float, second: float = 0.0) -> Recording:
    """A decay of 8 Hz with harmonics in a fixed share of the fundamental."""
    t = np.arange(4000) / FS
    a, psi = 2e-3 * np.exp(-0.3 * t), 2 * np.pi * 8 * t
    noise = 1e-7 * np.random.default_rng(2).standard_normal(t.size)
    return Recording("decay.csv", FS, a * (np.cos(psi) + second * np.cos(2 * psi) + third * np.cos(3 * psi)) + noise)


def words(svg: str) -> set[str]:
    return {text.strip() for text in re.findall(r">([^<>]+)</text>", svg)}


@pytest.mark.parametrize(
    ("third", "second", "drawn"), [(0.02, 0.0, {"harmonic 3"}), (0.0, 0.03, {"harmonic 2"}), (0.0, 0.0, set())]
)
def test_the_harmonics_that_are_there_are_drawn_and_no_others(third, second, drawn):
    curve = hilbert_analysis([decay(third, second)]).curves[0]
    said = words(within_figure(curve, "m"))
    assert {word for word in said if re.fullmatch(r"harmonic \d+", word)} == drawn
    assert ("Harmonics" in said) == bool(drawn)
    assert {"at each instant (Eq. 5)", "mean of the cycle (Eq. 6)", "above rest", "below rest"} <= said


def test_it_stands_on_the_page_with_the_figures_of_the_largest_cycle():
    record = decay(0.02)
    analysis = hilbert_analysis([record])
    page = hilbert_page(analysis, [record])
    assert "Within the cycle" in page
    curve = analysis.curves[0]
    reached = re.search(r"the largest cycle reaches ([\d.]+)&nbsp;m|the largest cycle reaches ([\d.]+) m", page)
    assert reached is not None
    value = float(next(group for group in reached.groups() if group))
    assert value == pytest.approx(1.02 * curve.amplitude.max(), rel=1e-3)


def test_without_a_decay_there_is_none():
    record = decay(0.02)
    analysis = hilbert_analysis([record])
    without = replace(analysis, curves=tuple(replace(curve, within=None) for curve in analysis.curves))
    assert "Within the cycle" not in hilbert_page(without, [record])
