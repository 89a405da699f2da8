"""How large a motion is at each sample, how fast it swings, how loud its noise is: against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.envelope import envelope_of, motion_frequency, smooth
from dashpot.recording import Recording

FS, PERIOD = 400.0, 40


def sine(n, amplitude=1.0, period=float(PERIOD), phase=0.3):
    return amplitude * np.cos(2 * np.pi * np.arange(n) / period + phase)


def noise(n, level=1e-3, seed=0):
    return level * np.random.default_rng(seed).standard_normal(n)


def envelope(x):
    found = envelope_of(Recording("run", FS, np.asarray(x, float)))
    assert found is not None
    return found


def test_the_envelope_of_a_sine_is_its_amplitude():
    for offset in (0.0, 30.0, -30.0):
        made = envelope(sine(4000, 2.0) + offset)
        assert made.period == PERIOD
        assert made.size == pytest.approx(np.full(4000, 2.0), rel=0.06)  # its ends are mirrored
        assert made.size[100:-100] == pytest.approx(np.full(3800, 2.0), rel=0.01)


def test_a_drift_does_not_count():
    made = envelope(sine(4000) + np.linspace(0.0, 4.0, 4000))
    assert made.size[100:-100] == pytest.approx(np.full(3800, 1.0), rel=0.01)


def test_the_envelope_of_a_decay_falls_with_it():
    t = np.arange(4000)
    made = envelope(np.exp(-t / 800) * sine(4000))
    assert made.size[100:-100] == pytest.approx(np.exp(-t / 800)[100:-100], rel=0.01)


def test_a_switch_shows_within_two_cycles():
    made = envelope(sine(4000) * (np.arange(4000) < 2000))
    assert made.size[2000 - 42] == pytest.approx(1.0, rel=0.01)
    assert made.size[2000 + 42] < 5e-3
    assert made.size[2000 - 10] < 0.95
    assert made.size[2000 + 10] > 0.3


@pytest.mark.parametrize(("cycles", "seen"), [(4.4, False), (5.2, True)])
def test_five_cycles_at_least(cycles, seen):
    n = round(cycles * PERIOD)
    assert (envelope_of(Recording("run", FS, sine(n))) is not None) is seen


@pytest.mark.parametrize(("period", "seen"), [(4.3, False), (4.8, True), (5.2, True)])
def test_five_samples_a_cycle_at_least(period, seen):
    assert (envelope_of(Recording("run", FS, sine(4000, period=period))) is not None) is seen


def test_nothing_moves():
    assert envelope_of(Recording("run", FS, np.ones(1000))) is None
    assert motion_frequency(np.ones(1000), FS) is None


def test_the_frequency_is_that_of_what_swings():
    assert motion_frequency(sine(4000) + 7.0, FS) == pytest.approx(FS / PERIOD, rel=1e-4)
    drift = 5.0 * (np.arange(4000) / 4000) ** 2
    assert motion_frequency(sine(4000) + drift, FS) == pytest.approx(FS / PERIOD, rel=1e-3)
    # fewer than five cycles: as many as fit
    few = motion_frequency(sine(400, period=100.0), FS)
    assert few == pytest.approx(4 * FS / 400, rel=1e-6)
    assert motion_frequency(sine(600, period=100.0), FS) == pytest.approx(4.0, rel=0.03)


# Where a decay ends --------------------------------------------------------------------------------------------------


def slow_decay(height=1.0):
    return np.exp(-np.arange(4000) / 4000) * sine(4000, height)


def test_the_floor_is_twice_the_envelope_of_white_noise():
    made = envelope(slow_decay() + noise(4000, 0.01))
    assert made.noise == pytest.approx(0.01, rel=0.1)
    assert made.floor == pytest.approx(2 * np.sqrt(2) * made.noise)


def test_without_noise_the_floor_is_a_millionth_of_the_motion():
    made = envelope(slow_decay(5.0))
    assert made.floor == pytest.approx(2 * max(np.sqrt(2) * made.noise, 1e-6 * np.max(made.size)))


def hummed(rest, hum=0.1):
    """A decay, then a rest of so many samples with a hum that no white noise is."""
    n = 800
    decay = np.append(np.exp(-np.arange(n) / 60), np.zeros(rest))
    return (decay + hum) * sine(n + rest) + noise(n + rest, 1e-4)


def test_where_it_rests_with_a_hum_that_is_the_floor():
    assert envelope(hummed(1200)).floor == pytest.approx(2 * 0.1, rel=0.05)


@pytest.mark.parametrize(("cycles", "counts"), [(8, False), (12, True)])
def test_a_rest_lasts_eight_cycles(cycles, counts):
    """Within one and a half of the lowest; the kernel takes a cycle of them."""
    m = cycles * PERIOD
    x = np.concatenate([sine(1200), sine(m, 0.1), sine(1200)]) + noise(2400 + m, 1e-5)
    assert bool(envelope(x).floor > 0.19) is counts


@pytest.mark.parametrize(("fall", "counts"), [(0.2, True), (0.31, False), (0.45, False)])
def test_a_rest_is_level(fall, counts):
    """Its first and last two cycles differ by less than a quarter."""
    n, m = 400, 40 * PERIOD
    level = 0.1 * (1.0 - fall * np.arange(m) / m)
    x = np.concatenate([sine(n), level * sine(m)]) + noise(n + m, 1e-6)
    assert bool(envelope(x).floor > 0.1) is counts


def test_the_rest_is_where_the_envelope_is_lowest():
    """Between two motions, neither of which counts."""
    x = np.concatenate([sine(1200), sine(1200, 0.1), sine(1200)]) + noise(3600, 1e-5)
    assert envelope(x).floor == pytest.approx(2 * 0.1, rel=0.05)
    early = np.concatenate([sine(800, 0.1), sine(2400)]) + noise(3200, 1e-5)
    assert envelope(early).floor == pytest.approx(2 * 0.1, rel=0.05)


# The kernel ----------------------------------------------------------------------------------------------------------


def test_smoothing_keeps_what_is_level_and_takes_what_is_fast():
    assert smooth(np.full(500, 3.0), 60) == pytest.approx(np.full(500, 3.0))
    line = np.arange(500.0)
    assert smooth(line, 60)[60:-60] == pytest.approx(line[60:-60])
    assert smooth(line, 60).size == 500
    assert np.max(np.abs(smooth(sine(500, period=15.0), 60))[60:-60]) < 0.01
    impulse = smooth(np.eye(1, 501, 250)[0], 61)
    assert np.sum(impulse) == pytest.approx(1.0)
    assert int(np.argmax(impulse)) == 250
    assert np.all(impulse > -1e-12)
