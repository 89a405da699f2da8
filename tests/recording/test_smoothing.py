"""Filters without scipy.signal: against it, and against what they must keep exactly."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.recording.smoothing import analytic_of, convolved, fewer, harris, with_polynomials
from scipy.signal import hilbert, resample_poly, savgol_filter
from scipy.signal.windows import blackmanharris


@pytest.mark.parametrize("mode", ["full", "same", "valid"])
@pytest.mark.parametrize(("n", "k"), [(200, 31), (201, 30), (40, 40), (5, 1)])
def test_a_convolution_is_that_of_its_sum(mode, n, k):
    random = np.random.default_rng(0)
    signal, kernel = random.standard_normal((2, n)), random.standard_normal(k)
    for rows in (signal, signal + 1j * signal[::-1]):
        expected = [np.convolve(row, kernel, mode) for row in rows]
        np.testing.assert_allclose(convolved(rows, kernel, mode), expected, atol=1e-13 * k)


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_a_quartic_goes_through_unchanged_up_to_its_ends(derivative):
    quartic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3, -0.2])
    place = np.linspace(-1.0, 1.0, 60)
    found = with_polynomials(quartic(place), 11, 4, derivative) / (place[1] - place[0]) ** derivative
    expected = quartic.deriv(derivative)(place) if derivative else quartic(place)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("span", "order", "derivative"), [(7, 4, 1), (51, 4, 0), (15, 3, 2)])
def test_noise_is_smoothed_as_by_scipy(span, order, derivative):
    noise = np.random.default_rng(1).standard_normal(100)
    expected = savgol_filter(noise, span, order, deriv=derivative)
    np.testing.assert_allclose(with_polynomials(noise, span, order, derivative), expected, atol=1e-12)


def test_the_window_is_scipys():
    for size in (16, 33):
        np.testing.assert_allclose(harris(size), blackmanharris(size), atol=1e-14)
        np.testing.assert_allclose(harris(size, periodic=True), blackmanharris(size, sym=False), atol=1e-14)


@pytest.mark.parametrize(("n", "factor"), [(1000, 2), (1001, 3), (57, 7), (5000, 20), (10, 1)])
def test_fewer_samples_are_scipys(n, factor):
    signal = np.random.default_rng(2).standard_normal(n)
    np.testing.assert_allclose(fewer(signal, factor), resample_poly(signal, 1, factor), atol=1e-13)


@pytest.mark.parametrize("n", [1, 2, 3, 64, 101])
def test_an_analytic_signal_is_scipys(n):
    signal = np.random.default_rng(3).standard_normal(n)
    np.testing.assert_allclose(analytic_of(signal), hilbert(signal), atol=1e-14)
