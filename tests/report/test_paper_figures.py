"""The numbers that Figs. 1, 3 and 6 of ``dashpot paper`` draw, read from the drawn lines."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dashpot.examples import recordings
from dashpot.examples.truth import TRUTH
from dashpot.identify.decays import find_decays
from dashpot.recording import read
from dashpot.report import preload_figure, time_history


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The matplotlib figures that were turned into SVG."""
    figures: list[Any] = []
    for module in (preload_figure, time_history):
        original = module.svg

        def keep(figure: Any, key: str, title: str, original: Any = original) -> str:
            figures.append(figure)
            return original(figure, key, title)

        monkeypatch.setattr(module, "svg", keep)
    return figures


def test_fig_1_is_the_preloaded_spring_and_its_backbone(drawn: list[Any]):
    preload_figure.preload_figure(TRUTH["omega0"], TRUTH["preload"], TRUTH["mass"])
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


def reach(axes: Any) -> float:
    """The largest value that is drawn, by lines or between them."""
    lines = [float(np.max(np.abs(line.get_ydata()))) for line in axes.lines if len(line.get_ydata()) > 2]
    bands = [float(np.max(np.abs(path.vertices[:, 1]))) for c in axes.collections for path in c.get_paths()]
    return max(lines + bands)
