"""A sample beside a jump may be on either side of it, and costs nothing there."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify.fit.choose_noise_model import plain_cost
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.jump_sides import nearer_sides
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model import Oscillator, Response


def step(signs):
    """A response that is one while its surface is on the one side, and minus one on the other."""
    return np.where(signs[:, 0] > 0, 1.0, -1.0)


def crossed(at, n=10):
    """(n, 2) signs of a surface that is crossed after a sample."""
    return np.stack([np.where(np.arange(n) <= at, 1, -1), np.zeros(n)], axis=1).astype(np.int8)


def shown(measured, noise=0.01):
    return SimpleNamespace(response=measured, noise=noise)


@pytest.mark.parametrize("off", [-1, 0, 1])
def test_a_jump_one_sample_early_or_late_is_none_the_worse(off):
    measured, signs = step(crossed(4)), crossed(4 + off)
    response, taken = nearer_sides(shown(measured), step(signs), signs, step)
    assert np.array_equal(response, measured)
    assert np.array_equal(taken, crossed(4))


def test_a_jump_two_samples_off_is():
    measured, signs = step(crossed(4)), crossed(6)
    response, _ = nearer_sides(shown(measured), step(signs), signs, step)
    assert np.flatnonzero(response != measured).tolist() == [5]


def test_what_does_not_jump_is_as_it_is():
    signs = crossed(10)
    response = np.linspace(0.0, 1.0, 10)
    assert nearer_sides(shown(response + 1.0), response, signs, step)[0] is response


@pytest.mark.parametrize(("noise", "asked"), [(2.0 / 3.6, False), (2.0 / 3.8, True), (1e-3, True)])
def test_a_side_is_asked_for_where_a_sample_is_decisively_off(noise, asked):
    """By odds of a thousand: 3.7 standard deviations."""
    measured, signs = step(crossed(4)), crossed(5)
    rest = np.where(np.arange(10) == 5, 0.0, 10.0)  # what is left elsewhere is no less than the noise
    response, _ = nearer_sides(shown(measured + rest, noise), step(signs), signs, step)
    assert bool(response[5] == measured[5]) is asked


def test_what_is_left_elsewhere_is_the_noise_where_that_is_less():
    """Jumps are in the highest frequencies too, from which a recording's noise is measured."""
    measured, signs = step(crossed(4)), crossed(5)
    rest = np.where(np.arange(10) == 5, 0.0, 1e-3)
    response, _ = nearer_sides(shown(measured + rest, 10.0), step(signs), signs, step)
    assert response[5] == measured[5]


def test_near_enough_no_other_run_is_made():
    def never(_signs):
        raise AssertionError

    signs = crossed(4)
    nearer_sides(shown(step(signs) + 0.01, 0.01), step(signs), signs, never)


@pytest.mark.parametrize("noise", [1e-7, 1e-6])
def test_the_likelihood_of_an_accelerometer_decay_has_no_large_steps(noise):
    """Friction and preload make two jumps a half cycle; over two standard errors of the frequency it is a parabola."""
    recording = recording_of(begin=(8e-3, 0.0), quantity="acceleration", noise=noise, seconds=6.0)
    values = {name: value for name, value in TRUTH.items() if name != "mass"}
    model = Oscillator.from_values(values, response=Response("acceleration", "m/s2"))
    structure = Structure(model, data_of([recording], model, coarse=False))
    problem = structure.problem
    state = search(problem, settled(problem, structure.state(None)), tolerance=1e-3).state
    place = list(model.parameters()).index("omega0")
    moves = np.linspace(-1.0, 1.0, 41) * 10 * noise
    costs = []
    for move in moves:
        moved = state.values.copy()
        moved[place] *= 1 + move
        costs.append(plain_cost(problem.residuals(replace(state, values=moved))))
    assert np.ptp(costs) > 20.0
    # as simulated it is off by 190 of log-likelihood
    assert costs == pytest.approx(np.polyval(np.polyfit(moves, costs, 2), moves), abs=2 * DECISIVE)
    assert abs(int(np.argmin(costs)) - 20) <= 2


def accelerometer():
    recording = recording_of(begin=(8e-3, 0.0), quantity="acceleration", noise=1e-6, seconds=4.0)
    model = Oscillator.from_values(
        {n: v for n, v in TRUTH.items() if n != "mass"}, response=Response("acceleration", "m/s2")
    )
    structure = Structure(model, data_of([recording], model, coarse=False))
    return structure.problem, settled(structure.problem, structure.state(None))


def test_derivatives_are_taken_under_the_signs_that_the_residuals_had(monkeypatch):
    problem, state = accelerometer()
    afresh = problem.derivatives(state, problem.residuals(state))
    problem.forget()
    residuals, asked, beside = problem.residuals(state), [], problem._beside_jumps
    monkeypatch.setattr(problem, "_beside_jumps", lambda *given: asked.append(given) or beside(*given))
    assert np.array_equal(problem.derivatives(state, residuals)[0], afresh[0])
    assert not asked
    elsewhere = replace(state, values=state.values * 1.001)
    problem.derivatives(elsewhere, residuals)  # another point has other signs
    assert len(asked) == 1


def test_another_zero_of_the_sensor_asks_for_the_signs_again(monkeypatch):
    problem, state = accelerometer()
    problem = problem.with_offsets((Offset(0, "response", 0.1),))
    asked, beside = [], problem._beside_jumps
    monkeypatch.setattr(problem, "_beside_jumps", lambda *given: asked.append(given) or beside(*given))
    here = replace(state, offsets=np.zeros(1))
    residuals = problem.residuals(here)
    problem.derivatives(here, residuals)
    assert len(asked) == 1
    problem.derivatives(replace(state, offsets=np.full(1, 0.1)), residuals)
    assert len(asked) == 2
