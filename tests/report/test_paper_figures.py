"""The numbers that the figures of ``dashpot paper`` draw, read from the drawn lines."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples import recordings
from dashpot.examples.truth import TRUTH
from dashpot.identify.hilbert.hilbert_result import HilbertAnalysis, hilbert_analysis
from dashpot.identify.motion.decays import find_decays
from dashpot.model import Oscillator
from dashpot.model.backbone import exact_backbone
from dashpot.recording import read
from dashpot.report import hilbert_figures, paper_page, time_history
from dashpot.report.chart import Box, Dots, Line, Panel


def lines(panel: Panel) -> list[Line]:
    return [mark for mark in panel.marks if isinstance(mark, Line)]


def test_fig_1_is_the_preloaded_spring_and_its_backbone():
    static, backbone = paper_page.preload_figure(TRUTH["omega0"], TRUTH["preload"], TRUTH["mass"]).panels
    x, force = lines(static)[0].x, lines(static)[0].y
    jump = force[np.flatnonzero(x >= 0)[-60]] - force[np.flatnonzero(x <= 0)[59]]
    unit = {"N": 1.0, "mN": 1e-3}[static.y.label.split("[")[1].rstrip("]")]
    assert jump * unit == pytest.approx(2 * 0.02, rel=1e-6)  # the paper's F0 is 0.02 N
    slope = (force[-1] - force[-2]) / (x[-1] - x[-2]) * unit
    metres = {"m": 1.0, "mm": 1e-3, "µm": 1e-6}[static.x.label.split("[")[1].rstrip("]")]
    assert slope / metres == pytest.approx(TRUTH["mass"] * TRUTH["omega0"] ** 2, rel=1e-6)
    ratio, amplitude = lines(backbone)[0].x, lines(backbone)[0].y
    of_preload = TRUTH["preload"] / TRUTH["omega0"] ** 2 / metres
    # Eq. 1, with its inverse cosine as printed
    expected = np.pi / 2 / np.arccos(1 / (1 + amplitude / of_preload))
    np.testing.assert_allclose(ratio, expected, rtol=1e-9)
    (doubled,) = (mark for mark in backbone.marks if isinstance(mark, Dots))
    assert doubled.x[0] == 2.0
    assert doubled.y[0] == pytest.approx(0.414 * of_preload, rel=1e-3)


def test_fig_3_has_four_bursts_and_four_decays():
    bursts = read(recordings("paper-stand")["bursts"])
    decays = find_decays(bursts)
    free = [("free", decay.start, decay.stop) for decay in decays]
    force, displacement = time_history.recording_figure(bursts, free).panels
    shaded = sorted(mark.x[0] for mark in force.marks if isinstance(mark, Box) and mark.x)
    np.testing.assert_allclose(shaded, [1.5, 6.5, 11.5, 16.5], atol=0.01)
    assert reach(force) == pytest.approx(1.15, rel=0.01)  # N
    assert reach(displacement) == pytest.approx(8.7, rel=0.01)  # mm
    assert force.limits("x")[1] == pytest.approx(20.0, rel=0.06)


def test_fig_6_sweeps_through_the_resonance():
    sweep = read(recordings("paper-stand")["sweep_high"])
    force, displacement = time_history.recording_figure(sweep).panels
    assert reach(force) == pytest.approx(1.0, rel=0.01)  # N
    # at resonance the force is all friction's: (viscous A omega + 4/pi dry) m
    peak = (1.0 / TRUTH["mass"] - 4 / np.pi * TRUTH["dry"]) / TRUTH["viscous"] / TRUTH["omega0"]
    assert reach(displacement) == pytest.approx(1e3 * peak, rel=0.02)
    assert not any(isinstance(mark, Box) for mark in force.marks)


@pytest.fixture(scope="module")
def analysis() -> HilbertAnalysis:
    """Of the bursts with their decays, and of the sweep."""
    return hilbert_analysis([read(recordings("paper-stand")[name]) for name in ("bursts", "sweep_high")])


def thick(panel: Panel) -> list[tuple[np.ndarray, np.ndarray]]:
    """What is drawn of the curves: dash-dot by FREEVIB, dotted by FORCEVIB."""
    drawn = [(line.x, line.y) for line in lines(panel) if line.dash in ("-.", ":")]
    assert len(drawn) >= 2  # by either
    return drawn


@pytest.mark.long
def test_fig_4_is_the_backbone_by_either_method(analysis: HilbertAnalysis):
    main, close = hilbert_figures.curves_figure(analysis, "m").panels
    model = Oscillator.from_values(TRUTH)
    for axes in (main, close):
        curves = thick(axes)
        assert len(curves) >= 5  # four decays, and what was driven
        for frequency, amplitude in curves:
            whole = amplitude > 0.1 * 8.7  # mm; below, the paper's preload makes it steep
            expected = exact_backbone(model, 1e-3 * amplitude[whole]) / (2 * np.pi)
            assert np.median(np.abs(frequency[whole] / expected - 1.0)) < 2e-3
    assert max(np.max(amplitude) for _, amplitude in thick(main)) > 0.6 * 8.7


@pytest.mark.long
def test_fig_5_is_the_spring_with_its_preload(analysis: HilbertAnalysis):
    whole, bent = hilbert_figures.characteristic_figure(analysis, "m", "N", TRUTH["mass"], "spring", "spring").panels
    assert "mm" in whole.x.label
    for axes, slope in ((whole, 0.0), (bent, TRUTH["mass"] * TRUTH["omega0"] ** 2)):
        unit = {"N": 1.0, "mN": 1e-3}[axes.y.label.split("[")[1].rstrip("]")]
        for x, force in thick(axes):
            x = 1e-3 * x
            seen = np.isfinite(force) & (np.abs(x) > 1e-3)
            spring = TRUTH["omega0"] ** 2 * x + TRUTH["cubic"] * x**3 + TRUTH["preload"] * np.sign(x)
            missed = force * unit - (TRUTH["mass"] * spring - slope * x)
            assert np.count_nonzero(seen) > 20
            largest = TRUTH["mass"] * TRUTH["omega0"] ** 2 * np.max(np.abs(x[seen]))
            assert np.max(np.abs(missed[seen])) < 5e-3 * largest


@pytest.mark.long
def test_fig_7_is_viscous_and_dry_friction(analysis: HilbertAnalysis):
    damping, friction = hilbert_figures.characteristic_figure(
        analysis, "m", "N", TRUTH["mass"], "friction", "friction"
    ).panels
    unit = {"N": 1.0, "mN": 1e-3}[friction.y.label.split("[")[1].rstrip("]")]
    for speed, force in thick(friction):
        speed = speed * {"m/s": 1.0, "mm/s": 1e-3}[friction.x.label.split("[")[1].rstrip("]")]
        seen = np.isfinite(force) & (np.abs(speed) > 0.1)
        assert np.count_nonzero(seen) > 20
        expected = TRUTH["mass"] * (TRUTH["viscous"] * speed + TRUTH["dry"] * np.sign(speed))
        assert np.median(np.abs(force[seen] * unit / expected[seen] - 1.0)) < 0.03
    for amplitude, h in thick(damping):
        loud = 1e-3 * amplitude > 2e-3
        expected = TRUTH["viscous"] / 2 + 2 * TRUTH["dry"] / (np.pi * TRUTH["omega0"] * 1e-3 * amplitude[loud])
        assert np.median(np.abs(h[loud] / expected - 1.0)) < 0.03


def reach(panel: Panel) -> float:
    """The largest value that is drawn."""
    return max(float(np.max(np.abs(line.y))) for line in lines(panel) if line.y.size > 2)
