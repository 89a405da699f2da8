"""No fit ends where a linear rig tells more of the motion."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.problem.segments import cut
from dashpot.identify.start.linear_fit import linear_fit
from dashpot.model import Oscillator
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

LINEAR = {"mass": 0.27, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 5.0, "dry": 0.0}

RIG = {"mass": 12.7, "omega0": 5.2, "viscous": 0.26}


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_a_linear_rig_is_found_from_no_start(recorded, quantity):
    """Decay and sweep together, and a sensor that rests elsewhere."""
    offset = {"displacement": 2e-3, "velocity": 0.1, "acceleration": 5.0}[quantity]
    decay = recorded(LINEAR, begin=(8e-3, 0.1), seconds=2.0, quantity=quantity, offset=offset)
    sweep = recorded(LINEAR, sweep=(1.0, 5.0, 20.0), seconds=8.0, quantity=quantity, offset=offset)
    segments = cut([decay, sweep], 70.0)
    fit = linear_fit(segments)
    assert fit is not None
    assert fit.omega0 == pytest.approx(80.0, rel=1e-5)
    assert fit.viscous == pytest.approx(5.0, rel=1e-3)
    assert fit.mass == pytest.approx(0.27, rel=5e-3)  # straight lines through 32 samples a cycle lose 0.3 %
    assert fit.offsets == pytest.approx([offset, offset], rel=0.01)
    assert np.max(fit.nrmse) < 1e-3
    free = next(i for i, segment in enumerate(segments) if segment.force is None)
    start = segments[free].start / decay.fs
    x, v = integrate_pieces(LINEAR, np.zeros((round(start * decay.fs), 1)), 1 / decay.fs, 8e-3, 0.1)
    assert fit.initial[free] == pytest.approx([x[-1], v[-1]], rel=0.01, abs=1e-4)


def test_nothing_swings_on_a_slide():
    t = np.arange(4000) / 100.0
    force = np.sin(2 * np.pi * 0.5 * t)
    segments = cut([Recording("slide", 100.0, np.cumsum(np.cumsum(force)) * 1e-4, force)], 1e-3)
    assert segments[0].slide
    assert linear_fit(segments) is None


def jolted(seed, level):
    """A linear torsion pendulum near 0.83 Hz, driven at 0.8 Hz; somebody works at its table for the first 8 s."""
    dt, random = 0.01, np.random.default_rng(seed)
    t = dt * np.arange(2000)
    drive = 1.5 * np.sin(2 * np.pi * 0.8 * t)
    force = drive + np.where(t < 8.0, level * np.repeat(random.standard_normal(200), 10), 0.0)
    moved = integrate_pieces(LINEAR | RIG, force[:-1, None], dt, -0.02, -0.15)[0]
    return Recording("lab", 1 / dt, moved + 1.4 + 2e-5 * random.standard_normal(t.size), drive, unit="rad")


@pytest.mark.parametrize("fixed", [(), ("cubic", "preload", "dry")])
@pytest.mark.parametrize("seed", range(4))
def test_a_drive_of_one_frequency_is_not_given_up_for_what_shakes_the_table(seed, fixed):
    """Weighed by what is left, the one line that the drive has would count for nothing beside its neighbours."""
    recording = jolted(seed, 1.0)
    start = {"mass": 10.0, "omega0": 5.3, "cubic": 0.0, "preload": 0.0, "viscous": 0.2, "dry": 0.0}
    fit = maximum_likelihood(Oscillator.from_values(start), [recording], fixed)
    (only,) = fit.segments
    plain = linear_fit([only.segment])
    assert plain is not None
    assert only.over_noise > 10  # what shook it is in no model of the rig
    assert only.nrmse < 1.002 * plain.nrmse[0]
    if fixed:
        known = fit.oscillator.parameters()
        scores = {name: (known[name].value - v) / known[name].std for name, v in RIG.items()}
        assert max(map(abs, scores.values())) < 5, scores


def swinging(drag, quintic, seed=0):
    """Sixty cycles from 8 mm with much drag and a quintic spring as strong as the linear one there."""
    omega, fs = 2 * np.pi * 5.0, 200.0
    t = np.arange(round(12.0 * fs)) / fs

    def rates(_, y):
        x, v = y
        return v, -omega * omega * x * (1 + quintic * (x / 8e-3) ** 4) - 0.1 * v - drag * v * abs(v)

    x = solve_ivp(rates, (0, t[-1]), (8e-3, 0.0), t_eval=t, method="DOP853", rtol=1e-10, atol=1e-14).y[0]
    return Recording("strong", fs, x + 2e-6 * np.random.default_rng(seed).standard_normal(t.size), free=True)


@pytest.mark.parametrize("part", [0.9, 1.0, 1.1])
@pytest.mark.parametrize("quintic", [0.35, 1.0])
def test_far_from_the_family_a_fit_tells_more_than_a_damped_sine(part, quintic):
    recording = swinging(10.0, quintic)
    start = {"omega0": part * 2 * np.pi * 5.0, "viscous": 0.3, "cubic": 0.0, "preload": 0.0, "dry": 0.0, "mass": None}
    fit = maximum_likelihood(Oscillator.from_values(start), [recording])
    plain = linear_fit([s.segment for s in fit.segments])
    assert plain is not None
    assert plain.nrmse[0] > 0.2
    (only,) = fit.segments
    assert only.segment.n == recording.n
    assert only.nrmse < 0.5 * plain.nrmse[0]
