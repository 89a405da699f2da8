"""Measured backbone and damping curve beside those of models, held against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.modal_result import ModalCurve
from dashpot.model import Oscillator
from dashpot.recording import Recording
from dashpot.report.chart import Band, Line
from dashpot.report.mended_curves import curves_figure, curves_section, gathered
from dashpot.simulate.core import core_of, internal_step

FS, OMEGA, CUBIC, VISCOUS, TOP = 400.0, 2 * math.pi * 5.0, 8e5, 1.2, 1e-2
TRUE = Oscillator.from_values({"omega0": OMEGA, "viscous": VISCOUS, "dry": 0.0, "cubic": CUBIC, "preload": 0.0})
LINEAR = Oscillator.from_values({"omega0": OMEGA, "viscous": VISCOUS, "dry": 0.0, "cubic": 0.0, "preload": 0.0})


def decay(seed: int, start: float) -> Recording:
    """A decay of the true rig from ``start``, with a thousandth of the largest motion as noise."""
    core, values, n = core_of(TRUE), np.array(list(TRUE.values().values())), int(7 * FS)
    step = internal_step(TRUE, TRUE.values(), TOP)
    x = core.record(values, np.array([start, 0.0]), None, n, 1 / FS, step)
    return Recording(f"decay {seed}", FS, x + 1e-5 * np.random.default_rng(seed).standard_normal(n))


@pytest.fixture(scope="module")
def recordings() -> tuple[Recording, ...]:
    """Two decays from different amplitudes."""
    return decay(1, TOP), decay(2, 0.6 * TOP)


@pytest.fixture(scope="module")
def curves(recordings: tuple[Recording, ...]) -> tuple[ModalCurve, ...]:
    """Their measured curves."""
    return hilbert_analysis(recordings).curves


def test_measured_curves_are_those_of_a_cubic_spring(curves):
    """omega(A)² = omega0² + 3/4 cubic A² (Eq. 6), h = viscous / 2, within the bands and to a few thousandths."""
    at, (frequency, damping) = gathered(curves)
    loud = at > 0.05 * TOP
    expected = np.sqrt(OMEGA**2 + 0.75 * CUBIC * at**2) / (2 * np.pi)
    assert np.count_nonzero(loud) > 8
    assert np.allclose(frequency[1, loud], expected[loud], rtol=2e-3)
    assert np.allclose(damping[1, loud], VISCOUS / 2, rtol=0.03)
    assert np.mean((frequency[0] <= expected) & (expected <= frequency[2])) > 0.9
    assert np.mean((damping[0] <= VISCOUS / 2) & (damping[2] >= VISCOUS / 2)) > 0.9


def test_the_picture_shows_them_beside_both_models(curves):
    backbone, damping = curves_figure(LINEAR, TRUE, 1e-2 * TOP, TOP, curves).panels
    lines = {mark.label: mark for mark in backbone.marks if isinstance(mark, Line)}
    assert list(lines) == ["measured, decays (FREEVIB)", "before", "after"]  # nothing drove it
    measured, before, after = lines.values()
    unit = 1e-3  # m: the axis is in mm
    assert np.allclose(before.x, OMEGA / (2 * np.pi), rtol=1e-9)
    assert np.allclose(after.x, np.sqrt(OMEGA**2 + 0.75 * CUBIC * (unit * after.y) ** 2) / (2 * np.pi), rtol=1e-9)
    loud = unit * measured.y > 0.05 * TOP
    assert np.allclose(measured.x[loud], np.interp(measured.y[loud], after.y, after.x), rtol=2e-3)
    assert sum(isinstance(mark, Band) for mark in (*backbone.marks, *damping.marks)) == 2


def test_steps_with_few_values_are_left_open(curves):
    """Amplitudes between which no recording moved are not drawn across."""
    loud, quiet = (
        replace(curves[0], **{name: getattr(curves[0], name)[part] for name in ("amplitude", "omega0", "damping")})
        for part in (curves[0].amplitude > 0.5 * TOP, curves[0].amplitude < 0.1 * TOP)
    )
    at, (frequency, _) = gathered([loud, quiet])
    between = (at > 0.12 * TOP) & (at < 0.45 * TOP)
    assert np.all(np.isnan(frequency[:, between]))
    assert np.all(np.diff(at) > 0)


def test_the_page_says_what_the_band_is(hand_made, recordings):
    diagnosis = hand_made.missing()
    (without,) = curves_section(diagnosis).blocks
    (found,) = curves_section(replace(diagnosis, recordings=recordings)).blocks
    assert "95 %" in found.caption
    assert "95 %" not in without.caption
