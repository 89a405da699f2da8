"""The way up to a simulation: which of several climbs is the best, and what each of them says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.fit import climb as module
from dashpot.identify.fit.climb import Climb, _climbed, best_climb, from_near
from dashpot.identify.fit.from_prediction import Maxima
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.output_error import State
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording

LINEAR = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
FIXED = ("cubic", "preload", "dry")
FS, OMEGA = 250.0, np.hypot(60.0, 0.5)


def decay(n=500, amplitude=6e-3, tone=0.0, other=40.0):
    """A damped sine in closed form; ``tone``: of another motion, which no model of one mode explains."""
    t = np.arange(n) / FS
    x = amplitude * np.exp(-0.5 * t) * np.cos(60.0 * t) + tone * np.cos(other * t)
    return Recording("decay", FS, x + 1e-6 * np.random.default_rng(4).standard_normal(n), free=True)


def problem_of(*recordings, **changed):
    model = Oscillator.from_values(LINEAR | changed)
    structure = Structure(model, data_of(recordings, Oscillator.from_values(LINEAR)), FIXED)
    return structure.problem, structure.state(None), model


# Which is the best ---------------------------------------------------------------------------------------------------


@pytest.fixture
def climbs(monkeypatch):
    """``climbs(first, other, ...)``: what each start leads to; a text where it simulates nothing. Gives those tried."""

    def make(*outcomes):
        tried = []

        def climbed(problem, state, maxima):
            tried.append(float(state.values[0]))
            made = outcomes[int(state.values[0])]
            if isinstance(made, str):
                raise BadInput(made)
            return made

        monkeypatch.setattr(module, "_climbed", climbed)
        return tried

    return make


class Model:
    """So much of a model as a start needs."""

    def __init__(self, value):
        self.value = value

    def values(self):
        return {"omega0": self.value}


def to(log_nrmse, whole=True, lost=False):
    return Climb(None, None, {}, 0, whole, log_nrmse, lost)  # pyright: ignore[reportArgumentType]


def best(count):
    start = State(np.zeros(1), np.zeros((1, 2)))
    return best_climb(None, start, lambda: [Model(float(k)) for k in range(1, count)])  # pyright: ignore


@pytest.mark.parametrize(
    ("first", "asked"),
    [
        (to(-3.0), False),
        (to(-3.0, lost=True), True),
        (to(-3.0, whole=False), True),
        (to(-3.0, whole=False, lost=True), True),
        ("no", True),
    ],
)
def test_others_are_asked_for_where_the_first_explains_little(climbs, first, asked):
    tried = climbs(first, to(-1.0), to(-2.0))
    best(3)
    assert tried == ([0.0, 1.0, 2.0] if asked else [0.0])


@pytest.mark.parametrize(
    ("outcomes", "chosen"),
    [
        ((to(-3.0, lost=True), to(-4.0, lost=True), to(-2.0)), 1),
        ((to(-1.5, whole=False), to(-1.0), to(-2.0)), 2),
        ((to(-2.5, whole=False), to(-0.1), to(-2.0)), 0),
        ((to(-1.0, whole=False), to(-2.0, whole=False), "no"), 1),
        (("no", "neither", to(0.0, lost=True)), 2),
        ((to(-1.0, lost=True), "no", "neither"), 0),
    ],
)
def test_what_leaves_least_of_the_whole_is_taken(climbs, outcomes, chosen):
    climbs(*outcomes)
    assert best(3) is outcomes[chosen]


def test_where_none_simulates_the_first_problem_is_said(climbs):
    climbs("the first", "the second")
    with pytest.raises(BadInput, match="the first"):
        best(2)


# One climb -----------------------------------------------------------------------------------------------------------


def test_a_climb_finds_the_rig_from_far_off():
    """Twenty cycles, of which twelve are told first."""
    problem, state, model = problem_of(decay(), omega0=54.0, viscous=3.0)
    climb = best_climb(problem, state, lambda: [model] * 0)
    assert climb.state.values[[1, 4]] == pytest.approx([OMEGA, 1.0], rel=1e-3)
    assert (climb.whole, climb.lost) == (True, False)
    assert [segment.n for segment in climb.problem.segments] == [500]
    assert climb.rungs == {}  # it keeps step by then
    assert climb.iterations >= 2
    left = problem.residuals(climb.state)[0]
    assert climb.log_nrmse == pytest.approx(np.log(np.std(left) / np.std(problem.segments[0].response)), rel=1e-3)


def test_steps_of_all_stages_count(monkeypatch):
    taken, own = [], module.from_prediction

    def noted(problem, state, *known):
        taken.append((problem.segments[0].n, own(problem, state, *known)))
        return taken[-1][1]

    monkeypatch.setattr(module, "from_prediction", noted)
    problem, state, _ = problem_of(decay(), omega0=58.0)
    climb = best_climb(problem, state, tuple)
    assert [n for n, _ in taken] == [int(12 * 2 * np.pi / 60.0 * FS), 500]
    assert climb.iterations == sum(found[2] for _, found in taken)
    assert min(found[2] for _, found in taken) > 0


def test_what_simulates_the_beginning_alone_is_not_whole(monkeypatch):
    own = module.from_prediction

    def not_beyond(problem, state, *known):
        if problem.segments[0].n == 500:
            raise BadInput("not so far")
        return own(problem, state, *known)

    monkeypatch.setattr(module, "from_prediction", not_beyond)
    problem, state, _ = problem_of(decay())
    climb = best_climb(problem, state, tuple)
    assert not climb.whole
    assert climb.problem.segments[0].n < 500


def stuck(monkeypatch, *recordings):
    """A climb whose search stays where it began: with a model at rest what it leaves is the motion itself."""
    monkeypatch.setattr(module, "from_prediction", lambda problem, state, maxima=None: (state, {}, 1))
    problem, state, _ = problem_of(*recordings)
    return problem, state


@pytest.mark.parametrize(("part", "lost"), [(0.4, False), (0.6, True)])
def test_more_than_half_of_a_motion_is_lost(monkeypatch, part, lost):
    problem, state = stuck(monkeypatch, decay())
    state = replace(state, initial=(1.0 - part) * np.array([[6e-3, -0.5 * 6e-3]]))
    climb = best_climb(problem, state, tuple)
    assert climb.lost is lost
    assert np.exp(climb.log_nrmse) == pytest.approx(part, rel=0.02)


@pytest.mark.parametrize(("quiet", "lost"), [(0.008, False), (0.012, True)])
def test_what_moves_a_hundredth_of_the_loudest_is_not_missed(monkeypatch, quiet, lost):
    problem, state = stuck(monkeypatch, decay(), decay(amplitude=quiet * 6e-3))
    state = replace(state, initial=np.array([[6e-3, -3e-3], [0.0, 0.0]]))
    assert best_climb(problem, state, tuple).lost is lost


def test_segments_count_by_their_length_and_no_further_than_a_thousand(monkeypatch):
    problem, state = stuck(monkeypatch, decay(750), decay(250))
    begins = np.array([[6e-3, -3e-3], [6e-3, -3e-3]])
    climb = best_climb(problem, replace(state, initial=begins * np.array([[0.9], [0.5]])), tuple)
    assert climb.log_nrmse == pytest.approx(0.75 * np.log(0.1) + 0.25 * np.log(0.5), rel=0.02)
    away = best_climb(problem, replace(state, initial=begins * np.array([[0.9], [1e6]])), tuple)
    assert away.log_nrmse == pytest.approx(0.75 * np.log(0.1) + 0.25 * np.log(1e3), abs=0.02)


def test_a_start_that_leads_where_another_led_is_followed_no_further():
    problem, state, _ = problem_of(decay(), omega0=58.0)
    maxima = Maxima()
    first = _climbed(problem, state, maxima)
    with pytest.raises(BadInput, match="another start has converged here"):
        _climbed(problem, replace(state, values=state.values * np.array([1.0, 1.01, 1.0, 1.0, 1.1, 1.0])), maxima)
    assert first.state.values[1] == pytest.approx(OMEGA, rel=1e-4)


# From near by --------------------------------------------------------------------------------------------------------


def test_from_near_is_one_search(monkeypatch):
    problem, state, _ = problem_of(decay(), omega0=59.9)
    asked = []
    monkeypatch.setattr(module, "search", lambda *what, **how: asked.append(how) or search(*what, **how))
    climb = from_near(problem, state)
    assert climb is not None
    assert asked == [{"tolerance": 1.0}]
    assert climb.state.values[1] == pytest.approx(OMEGA, rel=1e-4)
    assert (climb.problem, climb.whole, climb.lost, climb.rungs, climb.log_nrmse) == (problem, True, False, {}, 0.0)
    assert climb.iterations > 0


def test_from_near_needs_a_simulation():
    problem, state, _ = problem_of(decay(), cubic=-1e12)
    assert from_near(problem, state) is None
