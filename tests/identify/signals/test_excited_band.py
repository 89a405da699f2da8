"""The band in which a force has power, of forces whose band is known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.excitation import band_of
from dashpot.identify.signals.excited_band import excited_band
from dashpot.identify.signals.signals import Signal
from dashpot.recording.recording import Recording

FS = 1000.0
T = np.arange(60_000) / FS


def sweep(low=5.0, high=20.0):
    return np.sin(2 * np.pi * (low * T + (high - low) * T**2 / (2 * T[-1])))


@pytest.mark.parametrize(("low", "high"), [(5.0, 20.0), (20.0, 5.0)])
def test_a_sweep_has_power_from_end_to_end(low, high):
    # even in time over 15 Hz: half a percent of them is below the band, half a percent above
    assert excited_band(sweep(low, high), FS) == pytest.approx((5.075, 19.925), abs=0.03)


def test_a_logarithmic_sweep_stays_as_long_in_each_octave():
    rate = T[-1] / np.log(4.0)
    force = np.sin(2 * np.pi * 5.0 * rate * np.expm1(T / rate))
    # its own ripple at the lower end, 1 / sqrt(T rate) wide, reaches a little below 5 Hz
    assert excited_band(force, FS) == pytest.approx((5.0 * 4**0.005, 5.0 * 4**0.995), abs=0.12)


@pytest.mark.parametrize("seconds", [2.0, 10.0, 10.013])
@pytest.mark.parametrize("frequency", [12.0, 12.34, 12.35])
def test_a_sine_is_a_line_wherever_its_record_ends(frequency, seconds):
    t = np.arange(round(seconds * FS)) / FS
    assert excited_band(np.sin(2 * np.pi * frequency * t + 1.0), FS) == pytest.approx((frequency,) * 2, rel=2e-3)


def test_a_sine_and_its_third_harmonic():
    t = T[:10_000]
    force = np.sin(2 * np.pi * 12.34 * t) + 0.3 * np.sin(2 * np.pi * 37.02 * t)
    assert excited_band(force, FS) == pytest.approx((12.34, 37.02), rel=2e-3)


def test_a_multisine_from_its_first_line_to_its_last():
    random = np.random.default_rng(0)
    t = T[:10_000]
    lines = np.arange(50, 201) / 10.0
    force = np.cos(2 * np.pi * lines[:, None] * t + random.uniform(0, 2 * np.pi, (lines.size, 1))).sum(axis=0)
    assert excited_band(force, FS) == pytest.approx((5.0, 20.0), abs=0.1)


def test_noise_of_a_band():
    spectrum = np.fft.rfft(np.random.default_rng(0).standard_normal(T.size))
    frequency = np.fft.rfftfreq(T.size, 1 / FS)
    spectrum[(frequency < 30) | (frequency > 80)] = 0.0
    assert excited_band(np.fft.irfft(spectrum), FS) == pytest.approx((30.25, 79.75), abs=0.1)


@pytest.mark.parametrize("start", [100, 5000, 9970])
def test_a_blow_wherever_it_falls_in_its_record(start):
    blow = np.sin(np.pi * np.arange(20) / 20)
    force = np.zeros(10_000)
    force[start : start + 20] = blow
    # of the pulse alone, on a fine grid of frequencies
    power = np.abs(np.fft.rfft(blow, 2**20)) ** 2
    high = np.searchsorted(np.cumsum(power) / np.sum(power), 0.995) * FS / 2**20
    low, edge = excited_band(force, FS)
    assert low < 0.5
    assert edge == pytest.approx(high, rel=0.02)


@pytest.mark.parametrize("part", [0.02, 0.1, 0.3])
def test_the_noise_of_the_sensor_is_no_force(part):
    noise = part * np.sqrt(0.5)
    force = sweep() + noise * np.random.default_rng(1).standard_normal(T.size)
    assert excited_band(force, FS, noise) == pytest.approx((5.075, 19.925), abs=0.05)
    assert Signal(force, FS).band == pytest.approx((5.075, 19.925), abs=0.05)  # with the noise that it finds itself
    if part >= 0.1:  # a hundredth of the power or more
        assert excited_band(force, FS)[1] > 100.0


def test_a_force_that_is_white_itself_has_power_everywhere():
    low, high = Signal(np.random.default_rng(2).standard_normal(T.size), FS).band
    assert low < 0.01 * FS / 2
    assert high > 0.99 * FS / 2


@pytest.mark.parametrize("offset", [0.0, 3.0])
def test_an_offset_is_no_excitation(offset):
    assert excited_band(sweep() + offset, FS) == pytest.approx(excited_band(sweep(), FS))
    assert excited_band(np.full(100, offset), FS) == (0.0, 0.0)


def test_of_a_recording():
    x = np.zeros(T.size)
    assert band_of(Recording("driven", FS, x, sweep())) == pytest.approx((5.075, 19.925), abs=0.03)
    assert band_of(Recording("decay", FS, x)) is None
    assert band_of(Recording("silent", FS, x, np.zeros(T.size))) is None
