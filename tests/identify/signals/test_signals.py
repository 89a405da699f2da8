"""The signals of a recording: each fact of them is measured once."""

from __future__ import annotations

import pickle
from collections import Counter

import numpy as np
import pytest
from dashpot.identify.fit.hold import held_as
from dashpot.identify.motion import decays
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.motion.displacement import displacement
from dashpot.identify.motion.excitation import band_of
from dashpot.identify.problem.segments import cut
from dashpot.identify.signals import signals
from dashpot.identify.signals.signals import Signal, drive_of, excited_band, noise_levels, response_of
from dashpot.identify.start.start import hilbert_start
from dashpot.recording.fact import changed
from dashpot.recording.recording import Recording


@pytest.fixture
def recordings(rigs, reference_sweeps):
    burst = rigs.case(rigs.reference, rigs.bursts(1.0, 13.0, 1.0, 3.0), 1000.0, 12.0)
    cases = {"burst": burst.noisy(1e-6, 1e-3, 0), "sweep": reference_sweeps[0].noisy(1e-6, 1e-3, 1)}
    return [Recording(name, case.fs, case.x, case.force) for name, case in cases.items()]


@pytest.fixture
def measured(monkeypatch):
    """How often each signal was measured, by what was measured and its samples."""
    count: Counter[tuple[str, bytes]] = Counter()

    def watched(module, name):
        real = getattr(module, name)

        def counting(what, *more):
            samples = what.response if isinstance(what, Recording) else what
            count[name, np.asarray(samples).tobytes()] += 1
            return real(what, *more)

        monkeypatch.setattr(module, name, counting)

    for name in ("noise_level", "dominant_frequency", "excited_band"):
        watched(signals, name)
    watched(decays, "envelope_of")
    return count


def test_each_fact_of_each_signal_is_measured_once(recordings, measured):
    start = hilbert_start(recordings)
    for group in (recordings, held_as(recordings, "linear")):
        for band in (1.0, 3.0):
            cut(group, start.omega0, band)
        for recording in group:
            noise_levels(recording), displacement(recording), find_free_motion(recording)
    assert set(measured.values()) == {1}
    # response, force and three decays of the bursts; response and force of the sweep
    assert sum(name == "noise_level" for name, _ in measured) >= 7
    assert sum(name == "envelope_of" for name, _ in measured) == 2


def test_an_offset_taken_off_leaves_the_force_known(recordings):
    burst = recordings[0]
    noise_levels(burst)
    other = changed(burst, response=burst.response - 1e-3)
    assert drive_of(other) is drive_of(burst)
    assert response_of(other) is not response_of(burst)
    assert noise_levels(other) == pytest.approx(noise_levels(burst), rel=1e-9)


def test_what_is_known_of_a_recording_can_be_sent_to_another_process(recordings):
    burst = recordings[0]
    noise_levels(burst)
    assert noise_levels(pickle.loads(pickle.dumps(burst))) == noise_levels(burst)


def test_the_same_part_is_the_same_signal():
    whole = Signal(np.random.default_rng(0).standard_normal(1000), 100.0)
    part = whole.part(100, 900)
    assert part is whole.part(100, 900)
    assert np.array_equal(part.samples, whole.samples[100:900])
    assert whole.part(0, 1000) is whole


def test_noise_and_largest_line():
    t = np.arange(10_000) / 1000.0
    signal = Signal(np.sin(2 * np.pi * 7.0 * t) + 1e-3 * np.random.default_rng(1).standard_normal(t.size), 1000.0)
    assert signal.noise == pytest.approx(1e-3, rel=0.1)
    assert signal.frequency == pytest.approx(7.0, rel=1e-4)


@pytest.mark.parametrize("n", [24, 30, 38])
def test_of_a_few_dozen_samples_differences_tell_the_noise(n):
    """A spectrum of so few tells nothing; a release of two cycles left a million times its noise."""
    time = np.arange(n) / 12.0
    motion = np.exp(-0.3 * time) * np.cos(2 * np.pi * time)
    rng = np.random.default_rng(3)
    levels = [Signal(motion + 1e-3 * rng.standard_normal(n), 12.0).noise for _ in range(200)]
    assert np.median(levels) == pytest.approx(1e-3, rel=0.25)
    assert Signal(np.full(n, 2.0), 12.0).noise == 0.0


@pytest.mark.parametrize(("part", "silent"), [(0.6, True), (1.4, False)])
def test_a_signal_that_is_noise_for_its_greater_part_is_silent(part, silent):
    # noise over all is 1 / sqrt(1 + part²) of the signal: 0.86 and 0.58
    t = np.arange(20_000) / 1000.0
    noise = np.random.default_rng(2).standard_normal(t.size)
    assert Signal(noise + part * np.sqrt(2) * np.sin(2 * np.pi * 7.0 * t) + 5.0, 1000.0).is_silent == silent


def test_a_constant_is_silent_and_without_a_force_there_is_none():
    assert Signal(np.full(100, 2.0), 10.0).is_silent
    decay = Recording("decay", 1000.0, np.exp(-np.arange(1000) / 300.0) * np.sin(np.arange(1000) / 5.0))
    assert drive_of(decay) is None
    assert noise_levels(decay)[1] == 0.0


# The band in which a force has power, of forces whose band is known.

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
