"""Weighing by a spectrum: the short way to inner products is the long one's."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.signals.noise_spectrum import NoiseSpectrum, estimate, force_noise_left, resonance_of, white


def signals(n, count=4):
    return np.random.default_rng(n).standard_normal((count, n))


def coloured(n):
    omega = 2 * np.pi * np.fft.rfftfreq(n, 1e-2)
    return NoiseSpectrum(1e-3 + resonance_of(omega, 900.0, 2.0), n)


@pytest.mark.parametrize("n", [200, 201, 331])
def test_lines_have_the_inner_products_of_whitened_signals(n):
    spectrum = coloured(n)
    rows = signals(n)
    whitened, lines = spectrum.whiten(rows), spectrum.lines(rows)
    assert lines @ lines.T == pytest.approx(whitened @ whitened.T, rel=1e-12, abs=1e-9)
    assert np.sum(spectrum.lines(rows[0]) ** 2) == pytest.approx(np.sum(whitened[0] ** 2), rel=1e-12)


@pytest.mark.parametrize("n", [200, 201])
@pytest.mark.parametrize("flat", [False, True])
def test_of_lines_follow_the_signals_that_weigh_a_residual(n, flat):
    rows = signals(n)
    spectrum = white(rows[0]) if flat else coloured(n)
    assert spectrum.whitened_twice(spectrum.lines(rows)) == pytest.approx(spectrum.whiten(spectrum.whiten(rows)))
    assert spectrum.lines(rows[1:].copy(), overwrite=True) == pytest.approx(spectrum.lines(rows[1:]), rel=1e-12)


@pytest.mark.parametrize("n", [200, 201])
def test_the_sensor_has_its_share_of_each_line(n):
    rows = signals(n)
    share = np.linspace(0.0, 1.0, n // 2 + 1)
    spectrum = NoiseSpectrum(coloured(n).density, n, share)
    both = spectrum.whiten(spectrum._filter(rows, np.sqrt(1.0 - share)))
    lines = spectrum.lines(rows)
    assert lines @ spectrum.of_sensor(lines).T == pytest.approx(both @ both.T, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("n", [200, 201])
def test_a_flat_spectrum_is_a_factor(n):
    rows = signals(n)
    spectrum = white(rows[0])
    level = np.sqrt(np.mean(rows[0] ** 2))
    assert spectrum.lines(rows) == pytest.approx(rows / level, rel=1e-12)
    assert spectrum.whiten(rows) == pytest.approx(rows / level, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("n", [200, 201])
def test_the_determinant_of_white_noise_is_its_variance_to_the_number_of_samples(n):
    spectrum = NoiseSpectrum(np.full(n // 2 + 1, 4.0), n)
    assert spectrum.log_determinant() == pytest.approx(n * np.log(4.0), rel=1e-12)


def test_the_estimate_of_coloured_noise_whitens_it():
    n = 4096
    spectrum = coloured(n)
    residual = spectrum.colour(np.random.default_rng(0).standard_normal(n))
    omega = 2 * np.pi * np.fft.rfftfreq(n, 1e-2)
    found = estimate(residual, resonance_of(omega, 900.0, 2.0))
    assert np.median(np.abs(np.log(found.density / spectrum.density))) < 0.25
    assert np.mean(found.lines(residual) ** 2) * found.lines(residual).size / n == pytest.approx(1.0, rel=0.1)


def test_weights_that_scatter_make_errors_larger_by_what_is_said():
    random, n, line, segments = np.random.default_rng(3), 2000, 40, 8
    said, true = [], []
    for _ in range(400):
        spectra = [estimate(random.standard_normal(n)) for _ in range(segments)]
        weights = np.array([1 / spectrum.density[line] for spectrum in spectra])
        factor = spectra[0].widened(np.zeros(n))[2 * line]
        said.append(float(factor * np.sum(weights)) / np.sum(weights) ** 2)
        true.append(float(np.sum(weights**2)) / np.sum(weights) ** 2)
    assert np.mean(said) == pytest.approx(np.mean(true), rel=0.02)
    assert np.mean(said) > 1.03 / segments  # of weights that are known: one over the number


def test_what_the_fit_took_is_given_back():
    spectrum, width = estimate(np.random.default_rng(4).standard_normal(2000)), 2 * 10 + 1
    taken = np.zeros(2000)
    taken[2 * 300 - 1 : 2 * 300 + 1] = 1.0, 0.5  # of one line the real part and half of the imaginary one
    factors = spectrum.widened(taken)
    assert factors[2 * 300] == pytest.approx(width / (width - 0.75 - 2))
    assert factors[2 * 311] == pytest.approx(width / (width - 2))
    assert np.all(white(np.ones(10)).widened(np.zeros(10)) == 1.0)


@pytest.mark.parametrize(("there", "shown"), [(0.0, 1.0), (0.1, 1.0), (0.1, 0.1), (0.1, 0.02)])
def test_force_noise_is_what_the_residual_has_room_for(there, shown):
    """What a force shows is taken unless the residual is a thousand times likelier without so much of it."""
    n, random = 6000, np.random.default_rng(2)
    omega = 2 * np.pi * np.fft.rfftfreq(n)
    resonance = resonance_of(omega, 0.04, 0.01)
    pushed = np.fft.irfft(np.fft.rfft(random.standard_normal(n)) * np.sqrt(resonance), n)
    residual = there * pushed + 0.05 * random.standard_normal(n)
    level = force_noise_left(residual, resonance, shown)
    if shown <= there:
        assert level == shown
    else:
        assert level == pytest.approx(there, rel=0.2, abs=2e-3)
