"""What may be played: its signals in closed form, and the limits that they keep to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.experiment.excitations import BEYOND, CYCLES, Excitation, Limits, candidates, limits_of
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator

FS, NATURAL = 600.0, 10.0
LIMITS = Limits(force=2.0, displacement=3e-3, band_hz=(6.0, 15.0))


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


def test_the_candidates_keep_to_the_limits():
    plans = candidates(LIMITS, NATURAL)
    for plan in plans:
        assert plan.seconds == pytest.approx(CYCLES / NATURAL)
        assert plan.relative <= BEYOND
        assert np.max(np.abs(plan.signal(FS))) <= BEYOND * LIMITS.force * (1 + 1e-9)
        largest = LIMITS.displacement if plan.kind == "decay" else LIMITS.force
        assert plan.level == pytest.approx(plan.relative * largest)
    assert {plan.kind for plan in plans} == {"sweep", "multisine", "sine", "decay"}
    # up and down, within the band; one beyond it, at the level that was recorded
    bands = {plan.band_hz for plan in plans if plan.kind == "sweep"}
    assert bands == {(6.0, 15.0), (15.0, 6.0), (6.0 / BEYOND, 15.0 * BEYOND)}
    assert [p.relative for p in plans if p.band_hz == (6.0 / BEYOND, 15.0 * BEYOND)] == [1.0]
    # at the smallest level only sweeps: a multisine would not rise out of the friction
    assert {plan.kind for plan in plans if plan.relative == min(p.relative for p in plans)} == {"sweep"}
    assert {plan.band_hz for plan in plans if plan.kind == "sine"} == {(10.0, 10.0), (10.0 / 3, 10.0 / 3)}
    assert max(p.relative for p in plans if p.band_hz == (10.0 / 3, 10.0 / 3)) == BEYOND


def test_a_band_far_from_the_resonance_is_cut():
    wide = Limits(force=2.0, displacement=3e-3, band_hz=(0.1, 400.0))
    bands = {plan.band_hz for plan in candidates(wide, NATURAL) if plan.kind == "multisine"}
    assert bands == {(3.0, 30.0)}


def test_without_a_force_only_releases_remain():
    plans = candidates(Limits(force=0.0, displacement=3e-3, band_hz=(6.0, 15.0)), NATURAL)
    assert {plan.kind for plan in plans} == {"decay"}
    assert [plan.level for plan in plans] == pytest.approx([0.9e-3, 1.8e-3, 3e-3, 4.5e-3])


@pytest.fixture(scope="module")
def model():
    return Oscillator.from_values(TRUTH)


def test_limits_are_those_of_what_was_recorded(model, recorded):
    natural = TRUTH["omega0"] / (2 * np.pi)
    wide = recorded(sweep=(0.8, 5.0, 25.0), seconds=5.0)
    limits = limits_of(data_of([wide], model))
    assert limits.force == pytest.approx(np.max(np.abs(wide.force)))
    assert limits.displacement == pytest.approx(np.max(np.abs(wide.response)), rel=0.05)
    assert limits.band_hz[0] < 0.6 * natural
    assert limits.band_hz[1] > 1.6 * natural
    narrow = limits_of(data_of([recorded(sweep=(0.8, 12.4, 12.9), seconds=8.0)], model))
    assert narrow.band_hz == pytest.approx((0.7 * natural, 1.4 * natural))  # the resonance at least


def test_where_nothing_drives_no_force_can_be_asked_for(model, recorded):
    decay = recorded(begin=(5e-3, 0.0), seconds=3.0)
    data = data_of([decay], model)
    assert limits_of(data).force == 0.0
    # a force channel that drives no segment is none either
    assert limits_of(replace(data, scales=replace(data.scales, force=3.0))).force == 0.0
