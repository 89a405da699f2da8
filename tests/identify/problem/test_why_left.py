"""Why a stretch was left: each reason that can be, of recordings that are made to have it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.why_left import why_left
from dashpot.recording import Recording

FS, PACE = 500.0, 2 * np.pi * 10.0
T = np.arange(5000) / FS
NOISE = 1e-5 * np.random.default_rng(3).normal(size=T.size)
SWING = 1e-3 * np.sin(PACE * T) + NOISE


def test_a_rest_is_one_wherever_it_is_and_however_it_drifts():
    x = np.where(T < 5, 0.02 + 1e-4 * T, 0.0) + np.where(T < 5, 0.0, SWING) + NOISE
    said = why_left(Recording("r", FS, x), 100, 2000, PACE)
    assert said.startswith("at rest, or faded into the noise: ")
    size = float(said.removeprefix("at rest, or faded into the noise: ").split()[0])
    assert size == pytest.approx(np.std(NOISE[100:2000]) * 1e6, rel=0.1)
    assert "µm rms about a straight line, and the noise is " in said


@pytest.mark.parametrize(
    ("recording", "stretch", "reason"),
    [
        (Recording("r", FS, SWING), (100, 120), "less than a cycle between what is taken"),
        (Recording("r", FS, SWING), (100, 200), "too short: 2 cycles, and fewer than 3 say less"),
        (Recording("r", FS, SWING), (100, 3000), "no force was recorded"),
        (Recording("r", FS, SWING, np.sin(PACE * T)), (100, 3000), "neither free nor driven"),
        (Recording("r", FS, SWING, np.sin(PACE * T), unknown=((50, 400),)), (100, 300), "is not known there"),
        (Recording("r", FS, SWING, blank=((90, 400),)), (100, 300), "the sensor shows nothing there"),
    ],
)
def test_other_reasons(recording, stretch, reason):
    assert reason in why_left(recording, *stretch, PACE)
