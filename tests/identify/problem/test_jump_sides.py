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
from dashpot.identify.problem.jump_sides import nearer_sides, put_on_same_sides
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model import Oscillator, Response
from dashpot.simulate.core import Core
from dashpot.simulate.sides import Sides


def crossed(at, n=10):
    """A response that is one up to a sample, and minus one behind it."""
    return np.where(np.arange(n) <= at, 1.0, -1.0)


def beside(at):
    """The other sides of that jump."""
    sides = Sides()
    sides.at, sides.shown = np.array([at, at + 1]), np.array([-1.0, 1.0])
    return sides


def shown(measured, noise=0.01):
    return SimpleNamespace(response=measured, noise=noise)


def nearer(segment, response, sides):
    """The response with the samples beside its jumps on the nearer side."""
    made, taken = response.copy(), nearer_sides(segment, response, sides)
    made[sides.at[taken]] = sides.shown[taken]
    return made


@pytest.mark.parametrize("off", [-1, 0, 1])
def test_a_jump_one_sample_early_or_late_is_none_the_worse(off):
    measured = crossed(4)
    assert np.array_equal(nearer(shown(measured), crossed(4 + off), beside(4 + off)), measured)


def test_a_jump_two_samples_off_is():
    measured = crossed(4)
    response = nearer(shown(measured), crossed(6), beside(6))
    assert np.flatnonzero(response != measured).tolist() == [5]


def test_what_does_not_jump_is_as_it_is():
    response = np.linspace(0.0, 1.0, 10)
    assert np.array_equal(nearer(shown(response + 1.0), response, Sides()), response)


@pytest.mark.parametrize(("noise", "asked"), [(2.0 / 3.6, False), (2.0 / 3.8, True), (1e-3, True)])
def test_the_other_side_is_taken_where_a_sample_is_decisively_off(noise, asked):
    """By odds of a thousand: 3.7 standard deviations."""
    measured = crossed(4, 2000)
    rest = np.where(np.arange(2000) == 5, 0.0, 10.0)  # what is left elsewhere is no less than the noise
    response = nearer(shown(measured + rest, noise), crossed(5, 2000), beside(5))
    assert bool(response[5] == measured[5]) is asked


@pytest.mark.parametrize("n", [18, 400])
def test_where_the_noise_is_larger_than_the_jump_no_sample_chooses_its_side(n):
    """Of few samples no noise is measured (zero): what is left is it, and it is known the less, the fewer they are."""
    noise = np.random.default_rng(1).standard_normal((200, n))
    sides = Sides()
    sides.at, sides.shown = np.arange(n), np.full(n, 1.5)
    taken = [nearer_sides(shown(measured, 0.0), np.zeros(n), sides).size for measured in noise]
    assert np.mean(np.array(taken) > 0) < 0.03


def test_what_is_left_elsewhere_is_the_noise_where_that_is_less():
    """Jumps are in the highest frequencies too, from which a recording's noise is measured."""
    measured = crossed(4)
    rest = np.where(np.arange(10) == 5, 0.0, 1e-3)
    response = nearer(shown(measured + rest, 10.0), crossed(5), beside(5))
    assert response[5] == measured[5]


def test_of_several_ways_the_nearest_is_taken():
    sides = Sides()
    sides.at, sides.shown = np.array([3, 3, 3, 7]), np.array([0.4, 0.6, 2.0, 1.0])
    measured = np.zeros(10)
    measured[3] = 0.5 + 0.01
    assert nearer_sides(shown(measured), np.where(np.arange(10) == 3, 1.0, 0.0), sides).tolist() == [1]


@pytest.mark.parametrize("change", [0.0, 0.3, 3.0, -3.0])
@pytest.mark.parametrize("off", [-1, 0, 1])
def test_a_neighbouring_run_is_put_on_the_same_sides_however_far_it_has_moved(off, change):
    moved, sides = crossed(4 + off) + change, beside(4 + off)
    sides.shown += change
    put_on_same_sides(crossed(4), beside(4), moved, sides)
    assert np.array_equal(moved, crossed(4) + change)


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


def test_one_run_tells_both_sides_and_the_derivatives_have_the_side_of_the_residuals(monkeypatch):
    problem, state = accelerometer()
    problem = problem.with_offsets((Offset(0, "response", 0.1),))
    state = replace(state, values=state.values * 1.002, offsets=np.full(1, 1e-3))
    runs, record, carried = [], Core.record, Core.record_with_derivatives
    monkeypatch.setattr(Core, "record", lambda *a, **k: runs.append(1) or record(*a, **k))
    monkeypatch.setattr(Core, "record_with_derivatives", lambda *a, **k: runs.append(2) or carried(*a, **k))
    (residual,) = problem.residuals(state)
    (rows,) = problem.derivatives(state, (residual,))
    assert runs == [1, 2]
    (segment,), other = problem.segments, np.zeros((len(rows), residual.size))
    sides = problem.sides(0)
    raw = problem.simulate(0, state, sides=sides)
    taken_places = nearer_sides(segment, raw, sides)
    taken = sides.at[taken_places]
    assert taken.size >= 4
    assert np.array_equal(np.flatnonzero(np.abs(segment.response - residual - raw) > 1e-9), np.sort(taken))
    assert np.max(np.abs(problem.carry(0, state, range(len(rows)), other) - segment.response + residual)) < 1e-12
    assert np.array_equal(rows, other)
    # by preload and dry friction each sample has what its own side of their jumps has
    preload, ahead = list(problem.core.parameter_names).index("preload"), state.values.copy()
    ahead[preload] += 1e-5
    moved = problem.simulate(0, replace(state, values=ahead), sides=(beyond := problem.sides(0)))
    own = segment.response - residual
    turned = problem.sides(0)
    turned.at, turned.shown = sides.at.copy(), sides.shown.copy()
    for place in taken_places:  # what was the other side is its own now
        turned.shown[place] = raw[sides.at[place]]
    put_on_same_sides(own, turned, moved, beyond)
    quotient, row = (moved - own) / 1e-5, rows[list(problem.free).index(preload)]
    assert np.median(np.abs(quotient - row)[taken]) < 1e-3 * np.max(np.abs(row))


def test_where_nothing_is_asked_for_the_response_has_its_other_sides_all_the_same():
    """As of a driven record that begins at rest, of a model whose parameters all are given."""
    problem, state = accelerometer()
    state = replace(state, values=state.values * 1.002)
    (segment,), (residual,) = problem.segments, problem.residuals(state)
    rows = np.zeros((problem.shared + problem.core.states, segment.n))
    assert np.max(np.abs(problem.carry(0, state, (), rows) - segment.response + residual)) < 1e-12
    assert not np.any(rows)


def test_a_motion_that_runs_away_is_beside_none_of_its_jumps():
    sides = Sides()
    sides.at, sides.shown = np.array([5]), np.array([-1e200])
    assert not nearer_sides(shown(crossed(4)), np.where(np.arange(10) < 5, 1.0, 1e200), sides).size
