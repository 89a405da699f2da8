"""Errors that are foretold: the closed form of a linear rig's bound, and what a fit states."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.foresight.information import expected_spectrum, foretold, information, with_covariance
from dashpot.identify import identify
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.model.physical import machine

LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
HELD = ("cubic", "preload", "dry")


def test_a_linear_decay_has_the_bound_of_a_damped_sine(recorded):
    """Cramér-Rao of frequency and rate of a damped sine, amplitude and phase unknown, by its own derivatives."""
    noise, fs, seconds = 2e-6, 500.0, 2.0
    decay = recorded(LINEAR, begin=(5e-3, 0.0), seconds=seconds, fs=fs, noise=noise)
    model = Oscillator.from_values({**LINEAR, "mass": None})
    found = information(model, data_of([decay], model), [decay], HELD)
    t = np.arange(round(fs * seconds)) / fs
    omega0, rate = LINEAR["omega0"], LINEAR["viscous"] / 2
    omega = np.sqrt(omega0**2 - rate**2)
    wave = 5e-3 * np.exp((1j * omega - rate) * t)
    by_omega = [(1j * t * wave).imag * 0 + (1j * t * wave).real, (1j * wave).real, wave.real, -(t * wave).real]
    rows = np.array(by_omega) / noise  # by omega, phase, size, rate
    covariance = np.linalg.inv(rows @ rows.T)
    # omega0² = omega² + rate², viscous = 2 rate
    slopes = np.array([[omega / omega0, 0, 0, rate / omega0], [0, 0, 0, 2.0]])
    expected = np.sqrt(np.diag(slopes @ covariance @ slopes.T))
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(expected, rel=0.15)
    assert found.names == ("omega0", "viscous")


@pytest.fixture(scope="module")
def driven(recorded):
    return [recorded(sweep=(0.6, 8.0, 18.0), seconds=8.0, fs=600.0, noise=2e-6, force_noise=2e-3, seed=3)]


@pytest.fixture(scope="module")
def begun():
    off = {"omega0": 1.0005, "viscous": 1.01, "cubic": 1.1, "mass": 1.001, "dry": 0.95, "preload": 1.02}
    return Oscillator.from_values({name: value * off[name] for name, value in TRUTH.items()})


def test_they_are_those_that_a_fit_states(driven, begun):
    found = information(begun, data_of(driven, begun), driven)
    stated = identify(driven).oscillator.parameters()
    errors = np.sqrt(np.diag(found.covariance))
    for name, error in zip(found.names, errors, strict=True):
        assert error == pytest.approx(stated[name].std, rel=0.3), name
    assert found.follows


def test_a_start_that_leaves_more_than_noise_says_so(recorded):
    other = recorded(LINEAR | {"viscous": 5.0}, sweep=(0.6, 8.0, 18.0), seconds=6.0, noise=1e-6)
    model = Oscillator.from_values(LINEAR | {"viscous": 6.0})
    assert not foretold(model, data_of([other], model), [other]).follows
    assert information(model, data_of([other], model), [other]).follows  # which takes a few steps


def test_what_keeps_its_value_has_no_error(driven, begun):
    found = information(begun, data_of(driven, begun), driven, ("mass", "cubic"))
    assert found.names == ("omega0", "preload", "viscous", "dry")
    more = information(begun, data_of(driven, begun), driven)
    kept = [more.names.index(name) for name in found.names]
    assert np.all(np.diag(found.covariance) <= 1.02 * np.diag(more.covariance)[kept])


def test_noise_of_the_force_comes_through_the_resonance(driven, begun):
    segment = data_of(driven, begun).segments[0]
    quiet, loud = (expected_spectrum(segment, begun, 2e-6, force) for force in (0.0, 2e-3))
    assert np.ptp(quiet.density) == 0.0
    assert np.all(loud.density > quiet.density)
    frequency = np.fft.rfftfreq(segment.n, segment.dt)
    assert frequency[np.argmax(loud.density)] == pytest.approx(begun.omega0.value / (2 * np.pi), rel=0.05)
    assert np.max(loud.force_share) <= 1.0


def test_what_follows_from_parameters_has_their_errors():
    model = Oscillator.from_values(TRUTH)
    names = ("mass", "dry")
    covariance = np.array([[1e-6, 5e-8], [5e-8, 1e-8]])
    known = with_covariance(model, names, covariance)
    assert known.omega0.std is None
    slope = np.array([TRUTH["dry"], TRUTH["mass"]])
    assert machine(known)["friction"].std == pytest.approx(float(np.sqrt(slope @ covariance @ slope)))
