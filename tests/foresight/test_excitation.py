"""What may be played: its signals in closed form, and its sentence."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.foresight.excitation import KINDS, Excitation


def test_a_sweep_runs_from_one_frequency_to_the_other():
    sweep = Excitation("sweep", 2.0, 1.0, (20.0, 5.0), 10.0)
    signal = sweep.signal(1000.0)
    crossings = np.flatnonzero(np.diff(np.sign(signal)) > 0) / 1000.0
    pace = 1 / np.diff(crossings)
    assert pace[5] == pytest.approx(20.0 - 1.5 * crossings[5], rel=0.05)
    assert pace[-3] == pytest.approx(20.0 - 1.5 * crossings[-3], rel=0.05)
    assert signal.size == 10000


def test_a_sine_stops_at_half_time():
    t = np.arange(10000) / 1000.0
    signal = Excitation("sine", 2.0, 1.0, (8.0, 8.0), 10.0).signal(1000.0)
    on = (t > 0.5) & (t < 5.0)
    assert signal[on] == pytest.approx(2.0 * np.sin(2 * np.pi * 8.0 * t[on]), abs=1e-9)
    assert not np.any(signal[t >= 5.0])


def test_a_multisine_has_forty_lines_in_its_band_and_fills_its_level():
    signal = Excitation("multisine", 2.0, 1.0, (6.0, 14.0), 10.0).signal(1000.0)
    inside = signal[500:9500]
    assert 1.8 < np.max(np.abs(signal)) <= 2.0
    spectrum = np.abs(np.fft.rfft(inside * np.hanning(inside.size))) ** 2
    frequency = np.fft.rfftfreq(inside.size, 1e-3)
    within = (frequency > 5.7) & (frequency < 14.3)
    assert np.sum(spectrum[within]) > 0.999 * np.sum(spectrum)
    lines = np.unique(np.round(np.linspace(6.0, 14.0, 40) * 10.0)) / 10.0
    t = np.arange(10000)[500:9500] / 1000.0
    waves = np.exp(2j * np.pi * lines[:, None] * t)
    columns = np.vstack([waves.real, waves.imag]).T
    told = columns @ np.linalg.lstsq(columns, inside)[0]
    assert told == pytest.approx(inside, abs=1e-6)


@pytest.mark.parametrize("kind", ["sweep", "multisine", "sine"])
def test_a_force_is_ramped_over_a_twentieth_of_its_length(kind):
    plan = Excitation(kind, 2.0, 1.0, (8.0, 12.0), 10.0)
    signal = plan.signal(1000.0)
    assert signal[0] == 0.0
    assert np.max(np.abs(signal[:10])) < 2.0 * np.sin(0.5 * np.pi * 0.02) ** 2 + 1e-12
    assert np.max(np.abs(signal[-10:])) < 2.0 * np.sin(0.5 * np.pi * 0.022) ** 2 + 1e-12
    assert np.max(np.abs(signal)) <= 2.0 * (1 + 1e-12)


def test_a_ramp_is_half_way_at_a_fortieth():
    t = np.arange(10000) / 1000.0
    signal = Excitation("sine", 2.0, 1.0, (8.0, 8.0), 10.0).signal(1000.0)
    assert signal[250:300] == pytest.approx(
        2.0 * np.sin(16 * np.pi * t[250:300]) * np.sin(np.pi * t[250:300]) ** 2, abs=1e-9
    )
    assert Excitation("sine", 1.0, 1.0, (8.0, 8.0), 1e-6).signal(1000.0).size == 2


def test_a_decay_plays_nothing():
    assert np.array_equal(Excitation("decay", 2.0, 1.0, (8.0, 8.0), 1.0).signal(100.0), np.zeros(100))


def test_a_stepped_sine_holds_each_of_twelve_frequencies():
    fs, seconds = 1000.0, 24.0
    signal = Excitation("stepped", 2.0, 1.0, (6.0, 17.0), seconds).signal(fs)
    for step, frequency in enumerate(np.linspace(6.0, 17.0, 12)):
        inside = signal[2000 * step + 200 : 2000 * step + 1800]
        rising = np.flatnonzero((inside[:-1] < 0) & (inside[1:] >= 0))
        if 0 < step < 11:
            assert np.mean(np.diff(rising)) == pytest.approx(fs / frequency, rel=0.01), step


def test_a_random_force_fills_its_band_and_is_nearly_gaussian():
    signal = Excitation("random", 3.0, 1.0, (6.0, 14.0), 40.0).signal(500.0)
    inside = signal[1000:-1000]
    spectrum = np.abs(np.fft.rfft(inside * np.hanning(inside.size))) ** 2
    frequency = np.fft.rfftfreq(inside.size, 1 / 500.0)
    assert np.sum(spectrum[(frequency > 5.8) & (frequency < 14.2)]) > 0.999 * np.sum(spectrum)
    assert np.mean(inside**4) / np.mean(inside**2) ** 2 == pytest.approx(3.0, abs=0.4)
    assert np.max(np.abs(signal)) <= 3.0 * (1 + 1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_says_level_and_length_with_units(kind):
    said = Excitation(kind, 0.005, 1.0, (8.0, 16.0), 12.0).sentence()
    assert "12 s" in said
    assert ("5 mm" if kind == "decay" else "5 mN") in said


def test_a_release_says_how_often_and_an_angle_is_in_degrees():
    release = Excitation("decay", np.pi / 18, 1.0, (1.0, 1.0), 5.0, repeats=3)
    assert release.sentence("rad", "N.m") == "release it from 10 deg and record 5 s, 3 times"
