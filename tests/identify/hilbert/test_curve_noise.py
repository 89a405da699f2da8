"""The banded covariance of a curve's points against the one that follows from each sample's weight."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.hilbert.curve_noise import curve_noise
from dashpot.identify.hilbert.modal_stretch import Stretch, decay_stretch
from dashpot.identify.signals.signals import Signal

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
