"""A maximum weighed by its noise is the answer while what is left is noise; else unweighed least squares are."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.fit import reweighted_fit as module
from dashpot.identify.fit.choose_noise_model import plain_cost
from dashpot.identify.fit.reweighted_fit import (
    _remainders,
    concentrated,
    over_noise,
    reweighted,
    whitened,
    within_reach,
)
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.output_error import State
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.search_point import Outcome
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals.noise_spectrum import concentrated_likelihood
from dashpot.identify.signals.signals import noise_levels
from dashpot.model import Oscillator
from dashpot.recording import Recording
from scipy.signal import lfilter

LINEAR = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 4.0, "dry": 0.0}
FIXED = ("cubic", "preload", "dry")
FS, N = 250.0, 400
#: Of noise whose level its highest frequencies tell well.
SEED = 4
RUNAWAY = {"cubic": -100 * 60.0**2 / 6e-3**2}


def ringing(amplitude, noise, softer=0.0, name="decay"):
    """A damped sine in closed form; ``softer``: how much slower it swings, in rad/s, where it is large."""
    t = np.arange(N) / FS
    fall = np.exp(-2.0 * t)
    turn = np.hypot(60.0, 2.0) * t - softer * (1 - fall**2) / 4.0
    return Recording(name, FS, amplitude * fall * np.cos(turn) + noise, free=True)


def white(level, seed=0):
    return level * np.random.default_rng(seed).standard_normal(N)


def problem_of(*recordings, **changed):
    model = Oscillator.from_values(LINEAR | changed)
    structure = Structure(model, data_of(recordings, model), FIXED)
    return structure.problem, structure.state(None), model


def watched(monkeypatch):
    """What each search was asked for and found."""
    searches = []

    def noted(problem, state, noise=None, **how):
        searches.append((state, noise, how, search(problem, state, noise, **how)))
        return searches[-1][-1]

    monkeypatch.setattr(module, "search", noted)
    return searches


@pytest.fixture(scope="module")
def right():
    recordings = (ringing(6e-3, white(2e-5, SEED)),)
    return recordings, *problem_of(*recordings)


@pytest.fixture(scope="module")
def driven(recorded):
    recordings = (recorded(LINEAR, sweep=(0.4, 6.0, 13.0), fs=FS, seconds=2.0, noise=1e-6, force_noise=0.05),)
    return recordings, *problem_of(*recordings)


def test_what_is_left_is_measured_by_the_noise_of_its_segment(right):
    recordings, problem, state, model = right
    level = noise_levels(recordings[0])[0]
    assert level == pytest.approx(2e-5, rel=0.15)
    assert over_noise(problem, [np.full(N, 3 * level)], state, model, recordings) == pytest.approx([3.0])
    assert over_noise(problem, [np.full(N, np.nan)], state, model, recordings) == [np.inf]
    assert over_noise(problem, [np.full(N, np.inf)], state, model, recordings) == [np.inf]


def test_noise_of_the_force_is_expected_as_the_rig_passes_it_on(driven):
    """White noise through a resonance: sigma² dt / (2 c omega0² m²), Crandall and Mark 1963."""
    recordings, problem, state, model = driven
    sensor, force = noise_levels(recordings[0])
    level = np.hypot(sensor, force / 0.3 * np.sqrt(1 / FS / (2 * 4.0 * 60.0**2)))
    assert level > 5 * sensor
    left = [np.full(problem.segments[0].n, level)]
    assert over_noise(problem, left, state, model, recordings) == pytest.approx([1.0], rel=0.02)


def test_remainders_are_no_less_than_the_sensors_noise_makes(driven):
    recordings, problem, state, model = driven
    sensor, force = noise_levels(recordings[0])
    n = problem.segments[0].n

    def density(problem, residual):
        outcome = Outcome(state, 0.0, np.zeros((3, 3)), (residual,), 0, True)
        return _remainders(problem, outcome, model, recordings)[0].density

    nothing = density(problem, np.zeros(n))
    omega = 2 * np.pi * np.fft.rfftfreq(n, 1 / FS)
    passed = (force / 0.3) ** 2 / ((60.0**2 - omega**2) ** 2 + (4.0 * omega) ** 2)
    assert nothing == pytest.approx(sensor**2 + passed, rel=1e-6)
    assert density(problem.predicting(8.0), np.zeros(n)) == pytest.approx(np.full(omega.size, sensor**2), rel=1e-9)
    loud = density(problem, 1e3 * white(1.0, 3).repeat(2)[:n])
    assert np.min(loud) > np.max(nothing)
    assert problem.memory == FREE


def test_remainders_of_a_decay_know_no_force(right):
    recordings, problem, state, model = right
    outcome = Outcome(state, 0.0, np.zeros((2, 2)), (np.zeros(N),), 0, True)
    (spectrum,) = _remainders(problem, outcome, model, recordings)
    assert spectrum.density == pytest.approx(np.full(N // 2 + 1, noise_levels(recordings[0])[0] ** 2))


def test_the_right_model_is_weighed_in_two_searches(right, monkeypatch):
    recordings, *_ = right
    problem, state, model = problem_of(*recordings, omega0=59.0)
    state = search(problem, state, tolerance=1.0).state
    searches = watched(monkeypatch)
    answer, steps = reweighted(problem, state, model, recordings, most=30)
    assert answer.remainders is None
    assert steps == sum(found.iterations for *_, found in searches)
    assert [(how["tolerance"], how["informed"], how["most"]) for _, _, how, _ in searches] == [
        (pytest.approx(0.1), False, 30),
        (pytest.approx(1e-3), True, 30),
    ]
    omega0, viscous = answer.outcome.state.values[[1, 4]]
    error = np.sqrt(np.diag(np.linalg.inv(answer.outcome.information)))
    assert abs(omega0 - np.hypot(60.0, np.sqrt(8.0))) < 4 * error[0]
    assert abs(viscous - 4.0) < 4 * error[1]
    assert np.ptp(answer.noise[0].density) > 0.0
    assert answer.likelihood == pytest.approx(concentrated(problem, answer.outcome.state, model), rel=1e-9)


def test_how_exactly_and_whether_with_information_is_the_callers(right, monkeypatch):
    recordings, *_ = right
    problem, state, model = problem_of(*recordings, omega0=59.0)
    searches = watched(monkeypatch)
    answer, steps = whitened(problem, state, model, tolerance=1e-4, most=5, informed=False)
    assert min(found.iterations for *_, found in searches) > 0
    assert steps == sum(found.iterations for *_, found in searches)
    assert answer.likelihood > concentrated(problem, state, model)
    assert [(how["tolerance"], how["informed"], how["most"]) for _, _, how, _ in searches] == [
        (pytest.approx(1e-2), False, 5),
        (pytest.approx(1e-4), False, 5),
    ]


def test_what_does_not_simulate_has_no_likelihood(right):
    recordings, *_ = right
    problem, state, model = problem_of(*recordings, **RUNAWAY)
    answer, steps = reweighted(problem, state, model, recordings)
    assert (answer.likelihood, answer.outcome.cost, steps) == (-np.inf, np.inf, 0)
    assert not answer.outcome.converged
    assert answer.noise == []
    assert answer.outcome.information.shape == (2, 2)
    assert answer.outcome.state is state
    assert concentrated(problem, state, model) == -np.inf


@pytest.fixture(scope="module")
def wrong():
    """A linear model of two decays: the quiet one is as it says, the loud one is softer where it is large."""
    recordings = (ringing(1e-4, white(2e-5), name="quiet"), ringing(6e-3, white(2e-5, 1), softer=3.0, name="loud"))
    return recordings


def test_where_more_than_noise_is_left_least_squares_answer(wrong, monkeypatch):
    problem, state, model = problem_of(*wrong)
    searches = watched(monkeypatch)
    answer, steps = reweighted(problem, state, model, wrong)
    assert len(searches) == 3
    first, plain = searches[1][3], searches[2]
    levels = over_noise(problem, first.residuals, state, model, wrong)
    assert levels[0] < 1.1 < levels[1]  # the worst of all segments decides
    assert steps == sum(found.iterations for *_, found in searches)
    assert plain[1] is None
    assert plain[2]["tolerance"] == pytest.approx(1e-3)
    # least squares begin where less is left
    nearer = min((state, first.state), key=lambda s: plain_cost(problem.residuals(s)))
    assert plain_cost(problem.residuals(plain[0])) == pytest.approx(plain_cost(problem.residuals(nearer)), rel=1e-12)
    assert plain_cost(answer.outcome.residuals) < plain_cost(first.residuals) - 10.0
    assert answer.outcome.cost == 0.5 * 2 * N
    for spectrum, residual in zip(answer.noise, answer.outcome.residuals, strict=True):
        assert spectrum.density == pytest.approx(np.full(N // 2 + 1, np.mean(residual**2)))
    assert answer.remainders is not None
    assert answer.likelihood == pytest.approx(concentrated_likelihood(answer.remainders))
    assert answer.likelihood == pytest.approx(concentrated(problem, answer.outcome.state, model), rel=1e-9)


@pytest.fixture(scope="module")
def hummed():
    """The right model under noise without high frequencies: its level, which those tell, is taken for less."""
    slow = lfilter([1.0], [1.0, -1.6, 0.64], white(5e-6, 5))
    recordings = (ringing(6e-3, np.asarray(slow)),)
    return recordings, *problem_of(*recordings)


@pytest.mark.parametrize("linear", [np.inf, -np.inf])
def test_what_chance_makes_of_coloured_noise_is_no_reason(hummed, linear):
    recordings, problem, state, model = hummed
    answer, steps = reweighted(problem, state, model, recordings, linear)
    assert max(over_noise(problem, answer.outcome.residuals, state, model, recordings)) > 1.1
    assert steps > 0
    # but for a linear rig that leaves less
    assert (answer.remainders is None) == (linear == np.inf)


def test_the_state_is_not_touched(right):
    _, problem, state, model = right
    before = State(state.values.copy(), state.initial.copy())
    whitened(problem, state, model, most=2)
    assert np.array_equal(before.values, state.values)
    assert np.array_equal(before.initial, state.initial)


@pytest.mark.parametrize("memory", [1.0, 8.0])
def test_what_is_within_reach_of_a_prediction_is_what_its_search_finds(memory):
    """A prediction is nearly straight in its parameters: one step tells most of what a search gains."""
    problem, state, model = problem_of(ringing(5e-3, white(2e-5), softer=0.3), viscous=4.2, omega0=60.2)
    predicting = problem.predicting(memory)
    here, there = within_reach(predicting, state, model)
    found = whitened(predicting, state, model)[0].likelihood
    assert here == concentrated(predicting, state, model)
    assert found - here > 20.0
    assert 0.5 * (found - here) < there - here <= found - here


def test_nothing_is_within_reach_where_nothing_simulates():
    problem, state, model = problem_of(ringing(6e-3, white(1e-5)), **RUNAWAY)
    assert within_reach(problem, state, model) == (-np.inf, -np.inf)
