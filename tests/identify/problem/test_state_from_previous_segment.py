"""What a stretch goes on with where no sensor shows it: an accelerometer on a rig that is struck."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.state_from_previous_segment import before, continued_from_previous, goes_on
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator, Response
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import Core
from dashpot.simulate.force import force_between

FS, NOISE = 3600.0, 0.3
#: Friction holds the mass within 110 µm of its middle position; it rings some 5 mm.
VALUES = {"mass": 0.148, "omega0": 235.0, "cubic": 2.3e7, "preload": 3.0, "viscous": 10.4, "dry": 9.0}
HUNG = {"mass-ratio": 0.05, "frequency": 160.0, "damping": 3.0}
BLOWS = ((0.08, 180.0), (0.62, 150.0), (1.1, 210.0), (1.63, 160.0))


@cache
def struck(hung=False):
    """Model, recording, and (n, states) of a rig that is hit four times, each time once friction holds it."""
    model = Oscillator.from_values(VALUES, response=Response("acceleration", "m/s2"))
    model = with_term(model, "attached-resonator", HUNG) if hung else model
    t = np.arange(round(2.1 * FS)) / FS
    force = np.zeros(t.size)
    for at, peak in BLOWS:
        inside = (t >= at) & (t < at + 2.5e-3)
        force[inside] += peak * np.sin(np.pi * (t[inside] - at) / 2.5e-3)
    core = Core(model)
    driven = force_between(force, 1 / FS, "linear", 5000.0)
    how = np.array(list(model.values().values())), np.zeros(core.states), driven, t.size, 1 / FS, 1e-3
    shown = core.record(*how, quantity="acceleration") + NOISE * np.random.default_rng(1).standard_normal(t.size)
    recording = Recording("hits", FS, shown, force, "acceleration", "m/s2", hold="linear")
    return model, recording, core.record(*how, states=True)


@cache
def structure(hung=False, **changed):
    model, recording, states = struck(hung)
    parameters = model.parameters()
    moved = {name: replace(parameters[name], value=value) for name, value in changed.items()}
    return Structure(model.with_parameters(moved), data_of([recording], model, coarse=False)), states


def resting(problem):
    return [i for i, segment in enumerate(problem.segments) if goes_on(segment)]


def test_all_but_the_first_blow_go_on_from_a_motion():
    problem = structure()[0].problem
    assert len(resting(problem)) == len(BLOWS) - 1
    assert not goes_on(problem.segments[0])
    assert problem.segments[0].rests
    assert all(problem.free_states(problem.segments[i]) == () for i in resting(problem))


@pytest.mark.parametrize("hung", [False, True])
def test_the_mass_begins_where_friction_held_it_and_what_hangs_on_it_rings_on(hung):
    exact, states = structure(hung)
    problem = exact.problem
    begun = settled(problem, exact.state(None))
    size = np.ptp(states, axis=0)
    for i in resting(problem):
        true = states[problem.segments[i].start]
        assert np.all(np.abs(problem.core.begin(begun.initial[i]) - true) < 2e-4 * size)
    held = [abs(states[problem.segments[i].start][0]) for i in resting(problem)]
    assert hung or max(held) > 1e-3 * size[0]


def test_nothing_is_found_that_follows():
    """The fit of a rig that friction holds is at the noise, and tells the truth; one that begins at nothing is not."""
    off, _ = structure(mass=0.149, dry=7.0)
    fitted = off.fit()
    assert np.std(np.concatenate(fitted.residuals)) == pytest.approx(NOISE, rel=0.03)
    found = fitted.model.parameters()
    assert found["mass"].value == pytest.approx(VALUES["mass"], rel=2e-4)
    assert found["dry"].value == pytest.approx(VALUES["dry"], rel=2e-3)
    alone = replace(fitted, initial=np.zeros_like(fitted.initial))
    left = np.concatenate(off.problem.residuals(replace(off.state(alone.initial), values=off.state(None).values)))
    assert np.std(left) > 2 * NOISE


def test_a_beginning_follows_the_parameters():
    exact, _ = structure()
    less, _ = structure(dry=6.0)
    begun = settled(exact.problem, exact.state(None))
    moved = continued_from_previous(exact.problem, replace(begun, values=less.state(None).values))
    anew = settled(less.problem, less.state(None))
    for i in resting(exact.problem):
        assert moved.initial[i][0] != pytest.approx(begun.initial[i][0], rel=1e-3)
        assert moved.initial[i] == pytest.approx(anew.initial[i], rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(("viscous", "moves"), [(20.0, False), (14.0, True)])
def test_a_model_that_moves_still_says_nothing_of_where_the_mass_rests(viscous, moves):
    """Without friction, which left exp(-viscous t / 2) of the motion, a hundredth being where it counts as rest."""
    free, _ = structure(dry=0.0, preload=0.0, viscous=viscous)
    begun = settled(free.problem, free.state(None))
    gone = [np.any(begun.initial[i]) for i in resting(free.problem)]
    assert not any(gone) if moves else all(gone)


def test_a_prediction_forgets():
    exact, _ = structure()
    problem = exact.problem.predicting(1.0)
    start = exact.state(None)
    assert continued_from_previous(problem, start) is start
    assert not np.any(settled(problem, start).initial[resting(problem)])


@pytest.mark.parametrize(("quantity", "shown"), [("displacement", True), ("velocity", False)])
def test_a_sensor_of_displacement_shows_where_the_mass_rests(quantity, shown):
    exact, _ = structure(True)
    less = exact.problem.over([replace(s, quantity=quantity) for s in exact.problem.segments])
    begun = settled(less, settled(exact.problem, exact.state(None)))
    assert np.all(np.any(begun.initial[resting(less), 2:], axis=1))
    assert np.any(begun.initial[resting(less), :2]) != shown


def test_a_gap_is_bridged_only_where_the_mass_rests_and_never_in_a_slide():
    segments = structure()[0].problem.segments
    i = resting(structure()[0].problem)[0]
    assert before(segments)[i] == i - 1
    assert segments[i - 1].stop == segments[i].after < segments[i].start
    assert i not in before([replace(s, rests=False) for s in segments])
    assert i not in before([replace(s, slide=True) for s in segments])


def test_without_the_stretch_before_it_one_begins_as_it_did():
    exact, _ = structure()
    begun = settled(exact.problem, exact.state(None))
    kept = [0, 1, 3]  # the blow between moved the mass from where the first one left it
    less = exact.problem.over([exact.problem.segments[i] for i in kept])
    assert before(less.segments) == {1: 0}
    other = replace(begun, initial=begun.initial[kept])
    assert np.array_equal(continued_from_previous(less, other).initial, other.initial)
    assert np.array_equal(settled(less, other).initial, other.initial)
