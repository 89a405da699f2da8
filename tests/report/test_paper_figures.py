"""The numbers that the figures of ``dashpot paper`` draw, read from the drawn lines."""

from __future__ import annotations

from typing import Any

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


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The matplotlib figures that were turned into SVG."""
    figures: list[Any] = []
    for module in (hilbert_figures, paper_page, time_history):
        original = module.svg

        def keep(figure: Any, key: str, title: str, original: Any = original) -> str:
            figures.append(figure)
            return original(figure, key, title)

        monkeypatch.setattr(module, "svg", keep)
    return figures


def test_fig_1_is_the_preloaded_spring_and_its_backbone(drawn: list[Any]):
    paper_page.preload_figure(TRUTH["omega0"], TRUTH["preload"], TRUTH["mass"])
    static, backbone = drawn[0].axes
    x, force = (np.asarray(values) for values in static.lines[0].get_data())
    jump = force[np.flatnonzero(x >= 0)[-60]] - force[np.flatnonzero(x <= 0)[59]]
    unit = {"N": 1.0, "mN": 1e-3}[static.get_ylabel().split("[")[1].rstrip("]")]
    assert jump * unit == pytest.approx(2 * 0.02, rel=1e-6)  # the paper's F0 is 0.02 N
    slope = (force[-1] - force[-2]) / (x[-1] - x[-2]) * unit
    metres = {"m": 1.0, "mm": 1e-3, "µm": 1e-6}[static.get_xlabel().split("[")[1].rstrip("]")]
    assert slope / metres == pytest.approx(TRUTH["mass"] * TRUTH["omega0"] ** 2, rel=1e-6)
    ratio, amplitude = (np.asarray(values) for values in backbone.lines[0].get_data())
    of_preload = TRUTH["preload"] / TRUTH["omega0"] ** 2 / metres
    # Eq. 1, with its inverse cosine as printed
    expected = np.pi / 2 / np.arccos(1 / (1 + amplitude / of_preload))
    np.testing.assert_allclose(ratio, expected, rtol=1e-9)
    doubled = backbone.lines[-1].get_data()
    assert doubled[0][0] == 2.0
    assert doubled[1][0] == pytest.approx(0.414 * of_preload, rel=1e-3)


def test_fig_3_has_four_bursts_and_four_decays(drawn: list[Any]):
    bursts = read(recordings("paper-stand")["bursts"])
    decays = find_decays(bursts)
    time_history.recording_figure(bursts, decays)
    force, displacement = drawn[0].axes
    shaded = sorted(patch.get_x() for patch in force.patches)
    np.testing.assert_allclose(shaded, [1.5, 6.5, 11.5, 16.5], atol=0.01)
    assert reach(force) == pytest.approx(1.15, rel=0.01)  # N
    assert reach(displacement) == pytest.approx(8.7, rel=0.01)  # mm
    assert force.get_xlim()[1] == pytest.approx(20.0, rel=0.06)


def test_fig_6_sweeps_through_the_resonance(drawn: list[Any]):
    sweep = read(recordings("paper-stand")["sweep_high"])
    time_history.recording_figure(sweep)
    force, displacement = drawn[0].axes
    assert reach(force) == pytest.approx(1.0, rel=0.01)  # N
    # at resonance the force is all friction's: (viscous A omega + 4/pi dry) m
    peak = (1.0 / TRUTH["mass"] - 4 / np.pi * TRUTH["dry"]) / TRUTH["viscous"] / TRUTH["omega0"]
    assert reach(displacement) == pytest.approx(1e3 * peak, rel=0.02)
    assert not force.patches


@pytest.fixture(scope="module")
def analysis() -> HilbertAnalysis:
    """Of the bursts with their decays, and of the sweep."""
    return hilbert_analysis([read(recordings("paper-stand")[name]) for name in ("bursts", "sweep_high")])


def thick(axes: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """What is drawn of the curves: dash-dot by FREEVIB, dotted by FORCEVIB."""
    lines = [line.get_data() for line in axes.lines if line.get_linestyle() in ("-.", ":")]
    assert len(lines) >= 2  # by either
    return [(np.asarray(across, float), np.asarray(up, float)) for across, up in lines]


@pytest.mark.long
def test_fig_4_is_the_backbone_by_either_method(drawn: list[Any], analysis: HilbertAnalysis):
    hilbert_figures.curves_figure(analysis, "m")
    main, close = drawn[0].axes
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
def test_fig_5_is_the_spring_with_its_preload(drawn: list[Any], analysis: HilbertAnalysis):
    hilbert_figures.characteristic_figure(analysis, "m", "N", TRUTH["mass"], "spring", "spring")
    whole, bent = drawn[0].axes
    assert "mm" in whole.get_xlabel()
    for axes, slope in ((whole, 0.0), (bent, TRUTH["mass"] * TRUTH["omega0"] ** 2)):
        unit = {"N": 1.0, "mN": 1e-3}[axes.get_ylabel().split("[")[1].rstrip("]")]
        for x, force in thick(axes):
            x = 1e-3 * x
            seen = np.isfinite(force) & (np.abs(x) > 1e-3)
            spring = TRUTH["omega0"] ** 2 * x + TRUTH["cubic"] * x**3 + TRUTH["preload"] * np.sign(x)
            missed = force * unit - (TRUTH["mass"] * spring - slope * x)
            assert np.count_nonzero(seen) > 20
            largest = TRUTH["mass"] * TRUTH["omega0"] ** 2 * np.max(np.abs(x[seen]))
            assert np.max(np.abs(missed[seen])) < 5e-3 * largest


@pytest.mark.long
def test_fig_7_is_viscous_and_dry_friction(drawn: list[Any], analysis: HilbertAnalysis):
    hilbert_figures.characteristic_figure(analysis, "m", "N", TRUTH["mass"], "friction", "friction")
    damping, friction = drawn[0].axes
    unit = {"N": 1.0, "mN": 1e-3}[friction.get_ylabel().split("[")[1].rstrip("]")]
    for speed, force in thick(friction):
        speed = speed * {"m/s": 1.0, "mm/s": 1e-3}[friction.get_xlabel().split("[")[1].rstrip("]")]
        seen = np.isfinite(force) & (np.abs(speed) > 0.1)
        assert np.count_nonzero(seen) > 20
        expected = TRUTH["mass"] * (TRUTH["viscous"] * speed + TRUTH["dry"] * np.sign(speed))
        assert np.median(np.abs(force[seen] * unit / expected[seen] - 1.0)) < 0.03
    for amplitude, h in thick(damping):
        loud = 1e-3 * amplitude > 2e-3
        expected = TRUTH["viscous"] / 2 + 2 * TRUTH["dry"] / (np.pi * TRUTH["omega0"] * 1e-3 * amplitude[loud])
        assert np.median(np.abs(h[loud] / expected - 1.0)) < 0.03


def reach(axes: Any) -> float:
    """The largest value that is drawn, by lines or between them."""
    lines = [float(np.max(np.abs(line.get_ydata()))) for line in axes.lines if len(line.get_ydata()) > 2]
    bands = [float(np.max(np.abs(path.vertices[:, 1]))) for c in axes.collections for path in c.get_paths()]
    return max(lines + bands)
