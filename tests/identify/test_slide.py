"""A rig without a spring: a slide that a force moves to and fro, held against an integration of its own."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.identify import identify
from dashpot.identify.problem.segments import cut, pace_of, stretches
from dashpot.recording import Recording

TRUTH = {"mass": 12.0, "viscous": 3.0, "dry": 0.4}
FS = 200.0


def slide(pull: float = 0.0, seconds: float = 40.0, drag: float = 0.0, noise: float = 1e-5) -> Recording:
    """Friction, and no spring: x'' = (F - pull) / m - viscous x' - dry sgn x' - drag x' |x'|, by steps of 25 us.

    The force brakes the slide and turns it: it comes to rest only in passing.
    """
    fine = 200
    n = round(seconds * FS)
    t = np.arange(n * fine) / (FS * fine)
    force = 60.0 * np.sin(2 * np.pi * t / 9.0) + 25.0 * np.sin(2 * np.pi * t / 2.3 + 1.0)
    x = v = 0.0
    dt = 1.0 / (FS * fine)
    place = np.empty(n)
    for i in range(n * fine):
        if i % fine == 0:
            place[i // fine] = x
        push = (force[i] - pull) / TRUTH["mass"] - drag * v * abs(v)
        held = TRUTH["dry"] * dt
        free = v * (1.0 - TRUTH["viscous"] * dt) + push * dt
        v = 0.0 if abs(free) <= held else free - np.sign(free) * held  # friction may hold, never turn
        x += v * dt
    response = place + noise * np.random.default_rng(5).standard_normal(n)
    return Recording(name="slide", fs=FS, response=response, force=force[::fine])


@pytest.fixture(scope="module")
def steady() -> Recording:
    return slide()


def test_a_slide_is_as_fast_as_it_is_driven(steady):
    assert pace_of([steady], 1e-3) == pytest.approx(2 * np.pi / 9.0, rel=0.2)
    assert pace_of([steady], 10.0) == 10.0
    pieces = cut([steady], 1e-3)
    assert len(pieces) == 4
    assert stretches(pieces) == [(0, 1, 2, 3)]
    assert sum(piece.n for piece in pieces) == steady.n


def test_a_short_recording_driven_near_the_resonance_is_no_slide():
    t = np.arange(800) / FS
    for ratio in (0.8, 1.2, 1.8):
        swing = np.sin(ratio * 12.0 * t)
        recording = Recording(name="short", fs=FS, response=swing, force=swing)
        assert pace_of([recording], 12.0) == 12.0
        assert [piece.n for piece in cut([recording], 12.0)] == [800]


def test_mass_and_friction_of_a_slide(steady):
    oscillator = identify([steady]).oscillator
    for name, true in TRUTH.items():
        assert oscillator.values()[name] == pytest.approx(true, rel=0.01), name
    assert oscillator.omega0.value < 0.1


@pytest.mark.long
def test_of_a_slide_nothing_is_missing_or_what_is_is_said(steady):
    model = identify([steady]).oscillator
    assert diagnose(model, [steady]).verdict == "consistent"
    dragged = slide(drag=1.0)
    diagnosis = diagnose(identify([dragged]).oscillator, [dragged])
    assert diagnosis.verdict != "consistent"
    assert all(np.isfinite(record.nrmse_after) for record in diagnosis.records)
