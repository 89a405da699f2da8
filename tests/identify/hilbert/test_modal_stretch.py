"""The banded covariance of a curve's points against the one that follows from each sample's weight."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.modal_stretch import Stretch, curve_noise, decay_stretch, with_ends
from dashpot.identify.signals.hilbert import analytic_signal
from dashpot.identify.signals.signals import Signal
from dashpot.recording import Recording

FS = 200.0


@pytest.fixture(scope="module")
def stretch() -> Stretch:
    time = np.arange(500) / FS
    x = np.exp(-0.8 * time) * np.cos(2 * np.pi * 10 * time) + 1e-4 * np.random.default_rng(0).standard_normal(500)
    return decay_stretch(Signal(x, FS))


def test_it_is_that_of_the_samples_followed_through_both_low_passes(stretch: Stretch):
    n = stretch.signal.time.size
    squared, damping = np.full(n, (20 * np.pi) ** 2), np.full(n, 0.8)
    equation, amplitude = -1 - 1j * np.linspace(0.01, 0.03, n), np.linspace(5.0, 9.0, n)
    noise = curve_noise(stretch, equation, amplitude, squared, damping, 0.0)
    chosen = np.zeros((noise.points.size, stretch.clear.size))
    chosen[np.arange(noise.points.size), noise.points] = 1.0
    rows = stretch.before_low_pass(chosen)
    moved, _ = stretch.noise_weights(rows * equation, rows * amplitude, squared, damping)
    covariance = stretch.noise**2 * moved @ moved.T
    covariance += 1e-3 * np.diag(np.diag(covariance))  # the part that is taken for each point's own
    used = noise.used
    values = np.random.default_rng(1).standard_normal((2, stretch.clear.size))
    expected = np.linalg.solve(covariance[np.ix_(used, used)], values[:, noise.points[used]].T).T
    found = noise.weigh(values)
    np.testing.assert_allclose(found[:, noise.points[used]], expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())
    assert np.count_nonzero(found) == 2 * noise.count


def test_neighbours_are_off_to_opposite_sides(stretch: Stretch):
    n = stretch.signal.time.size
    flat = np.full(n, (20 * np.pi) ** 2), np.full(n, 0.8)
    noise = curve_noise(stretch, np.full(n, -1 + 0j), np.zeros(n), *flat, 0.0)
    ones = np.ones((1, stretch.clear.size))
    together = 1 / float((noise.weigh(ones) @ ones.T)[0, 0])
    alone = float(np.mean(stretch.point_variance(*flat, 0.0)[noise.points[noise.used]]))
    assert together < 0.1 * alone / noise.count


def test_whitened_values_of_its_own_noise_are_ones(stretch: Stretch):
    n = stretch.signal.time.size
    flat = np.full(n, (20 * np.pi) ** 2), np.full(n, 0.8)
    noise = curve_noise(stretch, np.full(n, -1 + 0j), np.zeros(n), *flat, 0.0)
    values = np.random.default_rng(2).standard_normal(stretch.clear.size)
    whitened = noise.whitened(values)
    # the sum of their squares is the form that least squares make small
    assert float(whitened @ whitened) == pytest.approx(float(noise.weigh(values[None])[0] @ values), rel=1e-9)
    assert not np.any(whitened[~noise.used])


# How near to the beginning of a decay its curve begins, and that it is right there.

RATE, OMEGA, H = 1000.0, 2 * np.pi * 12.0, 2.0
TIME = np.arange(4000) / RATE


def test_the_ends_are_those_of_a_motion_that_goes_on():
    x = np.exp(-H * TIME) * np.cos(OMEGA * TIME)
    signal = with_ends(analytic_signal(x, RATE, by_kernel=True), RATE)
    first = slice(0, signal.kernel // 2)
    np.testing.assert_allclose(signal.amplitude[first], np.exp(-H * TIME[first]), rtol=2e-4)
    np.testing.assert_allclose(signal.omega[first], OMEGA, rtol=2e-4)
    np.testing.assert_allclose(signal.growth[first], -H, atol=2e-3 * OMEGA)


def test_a_curve_begins_two_cycles_from_the_beginning():
    a, b = 3e5, 5.0
    x = np.empty(TIME.size)
    position, speed, fine = 0.01, 0.0, 10

    def pull(x: float, v: float) -> float:
        return -(OMEGA**2) * x - a * x**3 - b * v

    step = 1 / RATE / fine
    for i in range(TIME.size * fine):  # Runge and Kutta's, of the fourth order
        if i % fine == 0:
            x[i // fine] = position
        k1 = speed, pull(position, speed)
        k2 = speed + step / 2 * k1[1], pull(position + step / 2 * k1[0], speed + step / 2 * k1[1])
        k3 = speed + step / 2 * k2[1], pull(position + step / 2 * k2[0], speed + step / 2 * k2[1])
        k4 = speed + step * k3[1], pull(position + step * k3[0], speed + step * k3[1])
        position += step / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        speed += step / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    x += 1e-6 * np.random.default_rng(0).standard_normal(x.size)
    (curve,) = hilbert_analysis([Recording("ring", RATE, x)]).curves
    assert curve.time[0] * 12.0 == pytest.approx(2.0, abs=0.1)
    backbone = np.sqrt(OMEGA**2 + 0.75 * a * curve.amplitude**2)
    start = slice(0, 80)  # a cycle
    np.testing.assert_allclose(curve.omega0[start], backbone[start], rtol=5e-5)
