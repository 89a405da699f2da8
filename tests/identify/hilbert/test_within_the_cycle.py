"""Harmonics, Eq. 5, congruent curves and half-waves against closed forms and an independent integrator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.within_the_cycle import WithinTheCycle
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

VISCOUS = 2.0
NOISE = 1e-6
PERIOD = 1 / 10.0


def decay_of(spring: Callable[[float], float], offset: float = 0.0) -> Recording:
    """Six seconds of x'' + viscous x' + spring(x) = 0 at 1 kHz, let go at 10 mm, with 1 µm of noise."""
    time = np.arange(6000) / 1000.0
    run = solve_ivp(
        lambda _, y: [y[1], -VISCOUS * y[1] - spring(y[0])],
        (0, time[-1]),
        [0.01, 0.0],
        t_eval=time,
        max_step=2e-3,
        rtol=1e-9,
        atol=1e-12,
    )
    return Recording("ring", 1000.0, run.y[0] + offset + NOISE * np.random.default_rng(3).standard_normal(time.size))


def within(recording: Recording) -> tuple[np.ndarray, np.ndarray, WithinTheCycle]:
    """Amplitude, phase and what is within the cycles."""
    (curve,) = hilbert_analysis([recording]).curves
    assert curve.within is not None
    return curve.amplitude, curve.phase, curve.within


@pytest.fixture(scope="module")
def duffing() -> tuple[float, float, tuple[np.ndarray, np.ndarray, WithinTheCycle]]:
    squared, cubic = (2 * np.pi / PERIOD) ** 2, 1.2e7  # the cubic force at 10 mm is 0.3 of the linear one
    return squared, cubic, within(decay_of(lambda x: squared * x + cubic * x**3))


def test_the_congruent_spring_is_the_static_force(duffing):
    squared, cubic, (amplitude, _, cycle) = duffing
    true = squared * cycle.amplitude + cubic * cycle.amplitude**3
    large = amplitude > 1e-3
    np.testing.assert_allclose(cycle.restoring[large], true[large], rtol=2e-3)
    # what a sine would make of it is farther off than that by far
    sine = squared * amplitude + 0.75 * cubic * amplitude**3
    assert np.max(np.abs(sine - true) / true) > 0.02
    z = ((cycle.restoring - true) / cycle.restoring_std)[(amplitude > 2e-4) & large]
    assert 0.5 < np.sqrt(np.mean(z**2)) < 3


def test_the_natural_frequency_swings_within_the_cycle_as_a_cubic_has_it(duffing):
    squared, cubic, (amplitude, phase, cycle) = duffing
    middle = (amplitude > 4e-3) & (amplitude < 7e-3)
    a, psi = amplitude[middle], phase[middle]
    swing = 0.25 * cubic * a**2
    # Eq. 6's mean and Eq. 5's swing; u_3 in X adds 1/32 of cubic A²/omega² of it, in its second order
    expected = squared + 0.75 * cubic * a**2 + swing * np.cos(2 * psi)
    assert np.max(np.abs(cycle.omega0[middle] ** 2 - expected)) < 0.08 * np.max(swing)
    assert np.max(np.abs(cycle.hysteresis[middle] - swing * np.sin(2 * psi))) < 0.08 * np.max(swing)
    assert abs(np.mean(cycle.hysteresis[middle])) < 0.01 * np.max(swing)


def test_both_half_waves_of_a_symmetric_rig_are_alike(duffing):
    _, _, (_, _, cycle) = duffing
    np.testing.assert_allclose(cycle.peaks[0], cycle.peaks[1], rtol=1e-12)
    np.testing.assert_allclose(cycle.omega[0], cycle.omega[1], rtol=1e-9)
    np.testing.assert_allclose(cycle.peaks[0], cycle.amplitude, rtol=1e-3)


@pytest.mark.parametrize("offset", [0.0, 2e-3])
def test_each_half_wave_of_a_bilinear_spring_has_its_own_frequency(offset):
    stiff, soft = 2 * np.pi * 12.0, 2 * np.pi * 9.0
    amplitude, _, cycle = within(decay_of(lambda x: (stiff**2 if x > 0 else soft**2) * x, offset))
    large = amplitude > 2e-3
    for found, true in zip(cycle.omega, (stiff, soft), strict=True):
        np.testing.assert_allclose(found[large], np.sqrt(true**2 - VISCOUS**2 / 4), rtol=3e-3)
    # the speed at which both meet is one: the peaks are as the frequencies, inversely, but for half a cycle's decay
    np.testing.assert_allclose(cycle.peaks[1][large] / cycle.peaks[0][large], stiff / soft, rtol=0.01)
    mean = 2 / (1 / stiff + 1 / soft)
    np.testing.assert_allclose(2 / (1 / cycle.omega[0] + 1 / cycle.omega[1])[large], mean, rtol=1e-3)


def test_noise_makes_no_harmonics():
    time = np.arange(6000) / 1000.0
    x = 0.01 * np.exp(-time) * np.cos(2 * np.pi * 10 * time) + 2e-5 * np.random.default_rng(1).standard_normal(6000)
    _, _, cycle = within(Recording("linear", 1000.0, x))
    assert np.count_nonzero(np.any(cycle.harmonics != 0, axis=1)) <= 1


@pytest.mark.parametrize("offset", [-6e-4, 9e-4])
def test_where_friction_holds_the_mass_is_no_asymmetry(offset):
    """A rig that friction stops off its middle, under a sensor that shows something there: both sides are alike."""
    rig = {**TRUTH, "viscous": 2.0, "dry": 0.19}
    recording = recording_of(rig, begin=(8e-3, 0.0), fs=1000.0, seconds=5.0, noise=NOISE, offset=offset)
    rest = float(np.mean(recording.response[-500:])) - offset
    assert abs(rest) > 3e-6  # friction holds it off its middle
    amplitude, _, cycle = within(recording)
    assert not np.any(cycle.harmonics[np.array(cycle.orders) % 2 == 0])
    np.testing.assert_array_less(np.abs(cycle.peaks[0] - cycle.peaks[1]), 1e-12 + 1e-9 * amplitude)


def test_a_centre_that_friction_could_hold_counts_where_an_even_harmonic_does():
    squared, bend = (2 * np.pi / PERIOD) ** 2, 2e4
    (curve,) = hilbert_analysis([decay_of(lambda x: squared * x + bend * x**2)]).curves
    assert curve.within is not None
    assert np.all(curve.within.harmonics[curve.within.orders.index(2)] != 0)
    centre = curve.within.harmonics[curve.within.orders.index(0)].real
    large = curve.amplitude > 3e-3
    np.testing.assert_allclose(centre[large], (-bend * curve.amplitude**2 / (2 * squared))[large], rtol=0.1)
