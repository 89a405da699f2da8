"""The response of segments and its derivatives, against closed forms of a linear rig and the independent integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of, noise_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator, oscillator_with
from dashpot.recording import Recording

FS, N = 500.0, 3000
LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
OMEGA, FALL = LINEAR["omega0"], LINEAR["viscous"] / 2
DAMPED = float(np.sqrt(OMEGA**2 - FALL**2))
T = np.arange(N) / FS


def falling(x0, t=T):
    return x0 * np.exp(-FALL * t) * (np.cos(DAMPED * t) + FALL / DAMPED * np.sin(DAMPED * t))


def decay(offset=0.0):
    noise = 1e-7 * np.random.default_rng(0).standard_normal(N)
    return Recording("decay", FS, falling(5e-3) + offset + noise, free=True)


def sweep(values, per_second=FS):
    t = np.arange(round(6.0 * per_second)) / per_second
    force = np.sin(2 * np.pi * (8 * t + t**2))
    x = integrate(values, force, 1 / per_second)[0]
    noise = 1e-7 * np.random.default_rng(1).standard_normal(t.size)
    return Recording("sweep", per_second, x + noise, force)


def problem_of(values, recordings, offsets=(), fixed=("cubic", "preload", "dry")):
    model = Oscillator.from_values(values)
    structure = Structure(model, data_of(recordings, model, coarse=False), fixed, offsets)
    state = structure.state(None)
    initial = state.initial.copy()
    for i, segment in enumerate(structure.problem.segments):
        if segment.force is None:
            initial[i, 0] = falling(5e-3, np.array([segment.time]))[0]
            slope = 1e-6
            initial[i, 1] = np.diff(falling(5e-3, segment.time + np.array([-slope, slope])))[0] / (2 * slope)
    return structure, type(state)(state.values, initial, state.offsets)


def test_the_derivatives_of_a_free_decay_are_those_of_its_closed_form():
    structure, state = problem_of(LINEAR, [decay()])
    problem = structure.problem
    (rows,) = problem.derivatives(state, problem.residuals(state))
    (segment,) = problem.segments
    t = np.arange(segment.n) / FS
    x0, v0 = state.initial[0]

    def response(omega0, viscous, x0=x0, v0=v0):
        fall = viscous / 2
        damped = np.sqrt(omega0**2 - fall**2)
        return np.exp(-fall * t) * (x0 * np.cos(damped * t) + (v0 + fall * x0) / damped * np.sin(damped * t))

    step = 1e-6
    expected = {
        "omega0": (response(OMEGA + step, 2 * FALL) - response(OMEGA - step, 2 * FALL)) / (2 * step),
        "viscous": (response(OMEGA, 2 * FALL + step) - response(OMEGA, 2 * FALL - step)) / (2 * step),
    }
    for name, own in expected.items():
        row = rows[structure.free.index(name)]
        assert np.max(np.abs(row - own)) < 1e-3 * np.max(np.abs(own))
    own = rows[problem.shared :]
    assert own[0] == pytest.approx(response(OMEGA, 2 * FALL, 1.0, 0.0), abs=1e-6)
    assert own[1] == pytest.approx(response(OMEGA, 2 * FALL, 0.0, 1.0), abs=1e-8)


@pytest.mark.parametrize("channel", ["response", "drift"])
def test_what_a_sensor_shows_is_in_the_response_and_its_derivative_written_down(channel):
    offsets = (Offset(0, channel, 1e-5, middle=2.0),)
    structure, state = problem_of(LINEAR, [decay(3e-4)], offsets)
    problem = structure.problem
    state = type(state)(state.values, state.initial, np.array([3e-4]))
    (segment,) = problem.segments
    line = np.ones(segment.n) if channel == "response" else segment.time + np.arange(segment.n) / FS - 2.0
    shown = problem.simulate(0, state) - falling(5e-3, segment.time + np.arange(segment.n) / FS)
    assert shown == pytest.approx(3e-4 * line, abs=1e-8)
    (rows,) = problem.derivatives(state, problem.residuals(state))
    assert rows[len(structure.free)] == pytest.approx(line, rel=1e-12)
    # with the offset taken off what was measured, only initial states are left to find
    kept = problem.keeping(state)
    assert (kept.shared, kept.offsets) == (0, ())
    alone = type(state)(state.values, state.initial)
    rest = [r - k for r, k in zip(problem.residuals(state), kept.residuals(alone), strict=True)]
    assert rest[0] == pytest.approx(np.zeros(segment.n), abs=1e-12)


@pytest.mark.parametrize(("per_second", "fewer"), [(500.0, 3), (150.0, 2), (2000.0, 1)])
def test_a_coarse_simulation_errs_less_than_noise_and_an_exact_one_much_less(per_second, fewer):
    """Where few samples come in a cycle the force is in fewer pieces as well, of equal parts of a sample."""
    structure, state = problem_of(TRUTH, [sweep(TRUTH, per_second)], fixed=())
    exact = structure.problem
    coarse = exact.coarsely()
    (segment,) = exact.segments
    assert segment.force.fine == fewer * coarse.force(segment).fine
    assert coarse.coarse_step == pytest.approx(3.75 * exact.max_step)
    size = np.std(segment.response)
    apart = coarse.simulate(0, state) - exact.simulate(0, state)
    assert np.max(np.abs(apart)) < 1e-3 * size
    assert np.any(apart) is np.bool_(fewer > 1)  # at many samples a cycle there is nothing to save
    back = coarse.coarsely(False)
    assert np.array_equal(back.simulate(0, state), exact.simulate(0, state))


def test_a_parameter_that_is_not_free_has_no_derivative_and_no_information():
    structure, state = problem_of(LINEAR, [decay()], fixed=("cubic", "preload", "dry", "viscous"))
    problem = structure.problem
    assert "viscous" not in structure.free
    outcome = search(problem, state, tolerance=1e-6)
    assert outcome.information.shape == (len(structure.free),) * 2
    assert outcome.state.values[list(structure.model.parameters()).index("viscous")] == LINEAR["viscous"]
    assert outcome.converged


def test_what_moves_nothing_has_a_derivative_of_nothing():
    """Not of rounding, which the normal equations, in each unknown's own scale, would take for a direction to go in."""
    sine = "softening-stiffness/sine"
    values = TRUTH | {
        "omega0": 0.7 * OMEGA,
        f"{sine}.stiffness": 0.0,
        f"{sine}.width": 1e-2,
    }
    model = oscillator_with(values, effects=(sine,))
    structure = Structure(model, data_of([sweep(TRUTH)], model, coarse=False))
    problem, state = structure.problem, structure.state(None)
    (rows,) = problem.derivatives(state, problem.residuals(state))
    moved = dict(zip(structure.free, np.any(rows != 0.0, axis=1), strict=False))
    assert moved == dict.fromkeys(structure.free, True) | {f"{sine}.width": False}


def test_samples_that_were_filled_do_not_count():
    """A tenth of a decay is filled with nonsense: the fit finds the motion by the rest, with the rest's noise."""
    whole, runs = decay(), ((300, 420), (1000, 1180))
    wrong = np.array(whole.response)
    for start, stop in runs:
        wrong[start:stop] += 1e-4
    structure, state = problem_of(LINEAR, [replace(whole, response=wrong, blank=runs)])
    found = search(structure.problem, state)
    error = structure.problem.residuals(found.state)[0]
    assert found.state.values == pytest.approx(state.values, rel=1e-4)
    assert not np.any(error[300:420])
    assert not np.any(error[1000:1180])
    assert np.std(error) == pytest.approx(1e-7 * np.sqrt(0.9), rel=0.1)
    (rows,) = structure.problem.derivatives(found.state, [error])
    assert not np.any(rows[:, 300:420])
    level = noise_of(structure.problem.segments, [error], LINEAR)[0].density
    assert np.median(np.sqrt(level)) == pytest.approx(1e-7, rel=0.1)


def test_a_stretch_is_cut_where_what_drives_it_is_unknown():
    recording = replace(sweep(LINEAR), unknown=((1200, 1210),))
    segments = problem_of(LINEAR, [recording])[0].problem.segments
    assert [(s.start, s.stop) for s in segments] == [(0, 1200), (1210, 3000)]
