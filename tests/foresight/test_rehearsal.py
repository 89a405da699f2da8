"""Models rehearsed under excitations: responses and derivatives against closed forms, and what can be imitated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.foresight.excitation import Excitation
from dashpot.foresight.rehearsal import apart, rehearse
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.linearised import off, orthonormal
from dashpot.model import Oscillator
from dashpot.model.terms import with_term

LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
OMEGA, HALF = LINEAR["omega0"], LINEAR["viscous"] / 2
RATE, FS, REACH = 600.0, 1000.0, 8e-3
RELEASE = Excitation("decay", 4e-3, 1.0, (12.0, 12.0), 2.0)
SWEEP = Excitation("sweep", 0.5, 1.0, (9.0, 16.0), 4.0)
PLANS = (RELEASE, SWEEP)


@pytest.fixture(scope="module")
def data(recorded):
    sweep = recorded(LINEAR, sweep=(0.5, 9.0, 16.0), seconds=5.0, fs=FS, noise=2e-6)
    return data_of([sweep], Oscillator.from_values(LINEAR))


@pytest.fixture(scope="module")
def rehearsed(data):
    """``rehearsed(viscous=6.0)`` under both excitations, the noise that of the linear rig."""
    reference = Oscillator.from_values(LINEAR)

    def make(*, effect=None, parameters=None, rate=RATE, **changed):
        model = Oscillator.from_values(LINEAR | changed)
        if effect is not None:
            model = with_term(model, effect, parameters)
        return rehearse(model, reference, PLANS, data, rate, FS, REACH)

    return make


def test_a_release_is_that_of_the_closed_form(rehearsed):
    t = np.arange(round(RELEASE.seconds * RATE)) / RATE
    pace = np.sqrt(OMEGA**2 - HALF**2)
    exact = 4e-3 * np.exp(-HALF * t) * (np.cos(pace * t) + HALF / pace * np.sin(pace * t))
    played = rehearsed()
    assert played.raw[0] == pytest.approx(exact, abs=1e-7)
    assert played.peaks[0] == pytest.approx(4e-3)
    assert played.raw[1].size == round(SWEEP.seconds * RATE)
    assert played.peaks[1] == pytest.approx(np.max(np.abs(played.raw[1])))


def test_derivatives_are_differences_of_whitened_responses(rehearsed):
    names = list(LINEAR)
    played = rehearsed()
    for name, step in (("viscous", 1e-3), ("omega0", 1e-4), ("mass", 1e-5)):
        ahead, behind = (rehearsed(**{name: LINEAR[name] + sign * step}) for sign in (1, -1))
        for i in range(2):
            slope = played.noise[i].whiten(ahead.raw[i] - behind.raw[i]) / (2 * step)
            derivative = played.derivatives[i][names.index(name)]
            assert derivative == pytest.approx(slope, abs=2e-3 * np.max(np.abs(slope)) + 1e-9), (name, i)


def test_noise_is_the_sensors_and_fewer_samples_count_for_as_much(rehearsed, data):
    """White noise of so many samples a second: thinned to fewer, each has less."""
    full, thin = rehearsed(rate=FS), rehearsed(rate=RATE)
    assert np.min(full.noise[0].density) == pytest.approx(data.sensor[0] ** 2, rel=1e-6)
    assert np.min(thin.noise[0].density) == pytest.approx(data.sensor[0] ** 2 * RATE / FS, rel=1e-6)
    told = [float(np.linalg.norm(played.responses[0])) for played in (full, thin)]
    assert told[1] == pytest.approx(told[0], rel=0.02)


def test_noise_of_the_force_comes_through_the_resonance(rehearsed, data):
    reference = Oscillator.from_values(LINEAR)
    loud = replace(data, force=(1e-2,))
    played = rehearse(reference, reference, PLANS, loud, RATE, FS, REACH)
    frequency = np.fft.rfftfreq(played.raw[1].size, 1 / RATE)
    density = played.noise[1].density
    natural = OMEGA / (2 * np.pi)
    assert frequency[np.argmax(density)] == pytest.approx(natural, rel=0.02)
    peak = (1e-2 / LINEAR["mass"] / (LINEAR["viscous"] * OMEGA)) ** 2 * RATE / FS
    assert np.max(density) == pytest.approx(peak, rel=0.1)  # between two lines
    assert np.ptp(played.noise[0].density) == 0.0  # a release has no force
    without = replace(reference, mass=None)
    assert np.ptp(rehearse(reference, without, PLANS, loud, RATE, FS, REACH).noise[1].density) == 0.0


def test_a_sensor_without_noise_counts_as_one_in_ten_thousand(data):
    reference = Oscillator.from_values(LINEAR)
    played = rehearse(reference, reference, PLANS, replace(data, sensor=(0.0,)), RATE, FS, REACH)
    assert played.noise[0].density == pytest.approx((1e-4 * data.scales.response) ** 2)


def test_models_that_re_tune_into_one_another_are_not_apart(rehearsed):
    reference, other = rehearsed(), rehearsed(viscous=LINEAR["viscous"] * 1.001)
    for i in range(2):
        difference = np.linalg.norm(reference.responses[i] - other.responses[i])
        assert difference > 0.1
        assert apart(reference, other, i) < 0.01 * difference
        assert apart(reference, reference, i) == 0.0


def test_the_more_easily_imitated_direction_counts(rehearsed):
    """A drag can become nothing, nothing can become no drag: what tells them apart is what neither imitates."""
    reference, other = rehearsed(), rehearsed(effect="quadratic-drag", parameters={"coefficient": 5.0})
    both = [
        float(np.linalg.norm(off(orthonormal(m.derivatives[1]), reference.responses[1] - other.responses[1])))
        for m in (reference, other)
    ]
    assert apart(reference, other, 1) == pytest.approx(min(both))
    assert apart(reference, other, 1) == pytest.approx(apart(other, reference, 1))


def test_a_fit_imitates_at_least_as_well_as_the_linearised(rehearsed):
    reference, other = rehearsed(), rehearsed(viscous=LINEAR["viscous"] * 1.2)
    assert reference.imitates(other, 1) < 0.05 * float(np.linalg.norm(reference.responses[1] - other.responses[1]))
    drag = rehearsed(effect="quadratic-drag", parameters={"coefficient": 20.0})
    stays = reference.imitates(drag, 0)
    assert stays > 5.0
    assert drag.imitates(reference, 0) < 0.1 * stays  # which can become nothing


def test_a_model_that_does_not_simulate_differs_from_nothing(rehearsed):
    fine = rehearsed()
    lost = replace(fine, responses=(None, None), noise=(None, None))
    assert apart(fine, lost, 0) == 0.0
    assert apart(lost, fine, 0) == 0.0
    assert fine.imitates(lost, 0) == 0.0
    assert lost.imitates(fine, 0) == 0.0


def test_a_runaway_has_neither_response_nor_peak(rehearsed):
    gives_way = rehearsed(cubic=-1e9)
    assert gives_way.responses[0] is None
    assert gives_way.derivatives[0] is None
    assert gives_way.noise[0] is None
    assert gives_way.peaks[0] == np.inf
