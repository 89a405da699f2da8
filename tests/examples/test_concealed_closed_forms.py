"""The integrator of the virtual rigs against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.concealed.engine import Drive, simulate

W, A = 2 * np.pi * 10.0, 5e-3  # rad/s, m
K = W**2
FS = 600.0
BASE = {"mass": 2.0, "omega2": K, "omega": W, "amplitude": A, "force": 0.06 * K * A}
PEAK = 2.0 * 0.06 * K * A  # N
REST = Drive("none")
SWEEP = Drive("linear", PEAK, 7.0, 16.0, 2.5, 0.3)


def sampled(count: int) -> np.ndarray:
    return np.arange(count) / FS


def test_linear_decay_is_the_closed_form():
    viscous = 0.02 * W
    t, damped = sampled(6000), np.sqrt(K - viscous**2 / 4)
    exact = A * np.exp(-viscous * t / 2) * (np.cos(damped * t) + viscous / 2 / damped * np.sin(damped * t))
    response = simulate(BASE | {"viscous": viscous}, REST, A, FS, 6000)
    assert np.abs(response.x - exact).max() < 1e-9 * A


def test_dry_friction_decays_linearly_and_then_holds():
    friction = 0.004 * K * A
    offset = friction / K
    halves = int(np.floor((A / offset + 1) / 2))  # half swings until friction can hold the spring
    t = sampled(6000)
    n = np.minimum(np.floor(t * W / np.pi), halves)
    exact = (-1.0) ** n * (offset + (A - (2 * n + 1) * offset) * np.cos(W * t - n * np.pi))
    exact[n == halves] = (-1.0) ** halves * (A - 2 * halves * offset)
    response = simulate(BASE | {"dry": friction}, REST, A, FS, 6000)
    assert np.abs(response.x - exact).max() < 1e-8 * A
    assert np.ptp(response.x[-1000:]) == 0.0


def test_preload_shortens_the_period_as_it_must():
    preload = 0.02 * K * A
    rest = preload / K
    quarter = np.arccos(rest / (A + rest)) / W
    t = sampled(3000)
    phase = np.abs((t + 2 * quarter) % (4 * quarter) - 2 * quarter)  # time since the last or until the next +A
    side = np.where(phase < quarter, 1.0, -1.0)
    exact = side * ((A + rest) * np.cos(W * np.where(side > 0, phase, 2 * quarter - phase)) - rest)
    response = simulate(BASE | {"preload": preload}, REST, A, FS, 3000)
    assert np.abs(response.x - exact).max() < 1e-8 * A


def test_one_sided_stop_at_the_origin_is_the_bilinear_oscillator():
    ratio = 3.0  # stiffness on the side of the stop over that on the other
    slow, fast = np.pi / W, np.pi / W / np.sqrt(ratio)
    t = sampled(3000) % (slow + fast)
    speed = A * W
    parameters = BASE | {"up_stiffness": (ratio - 1) * K, "up_at": 1e-15}
    exact = np.where(
        t < slow / 2,
        -A * np.cos(W * t),
        np.where(
            t < slow / 2 + fast,
            speed / W / np.sqrt(ratio) * np.sin(W * np.sqrt(ratio) * (t - slow / 2)),
            -A * np.sin(W * (t - slow / 2 - fast)),
        ),
    )
    response = simulate(parameters, REST, -A, FS, 3000)
    assert np.abs(response.x - exact).max() < 1e-7 * A


def test_bouncing_about_the_origin_comes_to_rest():
    response = simulate(BASE | {"preload": 0.02 * K * A, "viscous": 0.1 * W}, REST, A, FS, 3000)
    assert np.all(response.x[-60:] == 0.0)


def test_friction_holds_a_force_that_is_too_weak():
    response = simulate(BASE | {"dry": 0.5 * PEAK, "preload": 0.01 * PEAK}, SWEEP, 0.0, FS, 1800)
    assert np.all(response.x == 0.0)
    assert np.abs(response.force).max() == pytest.approx(PEAK, rel=1e-2)


def test_an_accelerometer_shows_the_closed_form_of_a_decay():
    viscous = 0.04 * W
    response = simulate(BASE | {"viscous": viscous, "accelerometer": 1.0}, REST, A, FS, 6000)
    t, rate = sampled(6000), np.sqrt(K - viscous**2 / 4)
    decay = np.exp(-viscous * t / 2)
    velocity = -A * K / rate * decay * np.sin(rate * t)
    displacement = A * decay * (np.cos(rate * t) + viscous / (2 * rate) * np.sin(rate * t))
    assert response.shown[1:] == pytest.approx((-viscous * velocity - K * displacement)[1:], abs=1e-9 * K * A)


def test_an_accelerometer_shows_nothing_while_friction_holds():
    response = simulate(BASE | {"dry": 0.5 * PEAK, "preload": 0.01 * PEAK, "accelerometer": 1.0}, SWEEP, 0.0, FS, 1800)
    still = response.x == response.x[0]
    assert np.count_nonzero(still) > 10
    assert np.all(response.shown[still] == 0.0)


def test_a_hit_gives_its_momentum():
    """A sin² of half the box's area, a hundredth of a cycle long: the rig then swings with momentum over mass."""
    lasts, peak = 0.01 * 2 * np.pi / W, 40.0
    hit = Drive("hits", peak, length=3.0, lines=np.array([[0.1, 0.5, lasts]]))
    response = simulate(BASE, hit, 0.0, FS, 3000)
    swing = 0.5 * peak * 0.5 * lasts / BASE["mass"] / W
    assert np.max(response.x) == pytest.approx(swing, rel=1e-3)
    assert np.all(response.x[: int(0.1 * FS)] == 0.0)
    assert np.max(response.force) <= 0.5 * peak
