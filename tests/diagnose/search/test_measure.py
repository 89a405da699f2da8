"""The measure in which structures are compared: by one spectrum, at levels of each one's own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import NEAR, Measure, measure_by
from dashpot.diagnose.search.race import Entry, started
from dashpot.diagnose.search.residual_test import leftovers, times_the_noise
from dashpot.identify.data import data_of


@pytest.fixture(scope="module")
def fitted(rig):
    """A rig with nothing missing, at the noise, and its data."""
    case = rig("none")
    data = data_of(case.training, case.model)
    start = started(Entry((), case.model), data, Measure())
    assert start is not None
    return start.fitted, data


def left(fitted, residuals):
    return replace(fitted, residuals=tuple(residuals))


def swinging(fitted, data, times):
    """What leaves so many times the noise, the rest in step with the motion."""
    level = max(times_the_noise(fitted.residuals, fitted.model, data))
    moved = []
    for segment, residual in zip(data.segments, fitted.residuals, strict=True):
        size = np.sqrt(max((times / level) ** 2 - 1.0, 0.0)) * np.std(residual)
        moved.append(residual + size * segment.response / np.std(segment.response))
    return left(fitted, moved)


@pytest.mark.parametrize(("times", "noise"), [(0.95 * NEAR, True), (1.15 * NEAR, False)])
def test_what_moves_with_the_rig_is_noise_up_to_a_limit(fitted, times, noise):
    fit, data = fitted
    assert (measure_by(swinging(fit, data, times), data).noise is not None) is noise


def test_noise_of_another_colour_is_noise_however_loud(fitted):
    fit, data = fitted
    random = np.random.default_rng(5)
    loud, segments = [], []
    for segment, residual in zip(data.segments, fit.residuals, strict=True):
        drive = random.standard_normal(segment.n + 49)
        loud.append(2.0 * np.std(residual) * np.convolve(drive, 0.9 ** np.arange(50), mode="valid"))
        segments.append(replace(segment, response=segment.response - residual + loud[-1]))
    noisy, data = left(fit, loud), replace(data, segments=tuple(segments))
    assert max(times_the_noise(noisy.residuals, noisy.model, data)) > 3 * NEAR
    assert not any(part.is_mismatch for part in leftovers(noisy, data))
    assert measure_by(noisy, data).noise is not None


def test_as_long_as_no_noise_is_known_only_power_counts():
    """Quiet frequencies that are made quieter gain nothing beside the motion."""
    t = np.arange(4000) / 400.0
    random = np.random.default_rng(1)
    motion, hiss = np.sin(40.0 * t), 1e-2 * random.standard_normal(t.size)
    loud, quiet = motion + hiss, 1.01 * motion + 1e-3 * hiss
    assert Measure().value([loud]) > Measure().value([quiet])
    assert Measure().value([loud]) == pytest.approx(-0.5 * t.size * np.log(np.mean(loud**2)))


def test_one_spectrum_holds_for_all(fitted):
    fit, data = fitted
    measure = measure_by(fit, data)
    assert measure.value(fit.residuals) == pytest.approx(0.0, abs=0.02 * data.points)
    twice = [2.0 * residual for residual in fit.residuals]
    assert measure.value(fit.residuals) - measure.value(twice) == pytest.approx(data.points * np.log(2.0))
    for own, given in zip(measure.spectra(twice), measure.spectra(fit.residuals), strict=True):
        assert np.allclose(own.density, 4.0 * given.density)


def test_what_does_not_simulate_is_never_the_better(fitted):
    fit, data = fitted
    gone = [np.full_like(residual, np.nan) for residual in fit.residuals]
    assert Measure().value(gone) == -np.inf
    assert measure_by(left(fit, gone), data).noise is None
