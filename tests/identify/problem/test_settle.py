"""Initial states found by themselves, before any parameter is; motions by the independent integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator, Response
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import Core

FS, NOISE = 1000.0, 1e-6
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
BEGIN = (6e-3, 0.25)


def structure(quantity="displacement", begin=BEGIN, force=None, **changed):
    """A decay, or a driven stretch, and the true rig with some values changed."""
    n = 2500
    drive = np.zeros(n) if force is None else force[:n]
    x, v = integrate(TRUTH, drive, 1 / FS, *begin)
    m, c, dry, w, c3, pre = (TRUTH[k] for k in ("mass", "viscous", "dry", "omega0", "cubic", "preload"))
    a = drive / m - c * v - dry * np.sign(v) - w**2 * x - c3 * x**3 - pre * np.sign(x)
    y = {"displacement": x, "velocity": v, "acceleration": a}[quantity]
    noise = NOISE * w ** list(UNITS).index(quantity)
    y = y + noise * np.random.default_rng(0).standard_normal(n)
    recording = Recording("run", FS, y, force, quantity, UNITS[quantity], free=force is None, hold="linear")
    model = Oscillator.from_values(TRUTH | changed, response=Response(quantity, UNITS[quantity]))
    return Structure(model, data_of([recording], model, coarse=False))


def errors(state, begin=BEGIN):
    """Of displacement and velocity, both as a part of the first motion's size."""
    size = np.hypot(begin[0], begin[1] / TRUTH["omega0"])
    return np.abs(state.initial[0, :2] - begin) / size / np.array([1.0, TRUTH["omega0"]])


@pytest.mark.parametrize("quantity", UNITS)
def test_the_beginning_of_a_decay_is_found(quantity):
    exact = structure(quantity)
    start = exact.state(None)
    begun = settled(exact.problem, start)
    assert np.all(errors(start) < 0.3)  # what the signal alone says
    assert np.all(errors(begun) < 1e-3)
    assert np.array_equal(begun.values, start.values)


@pytest.mark.parametrize("quantity", UNITS)
def test_from_a_beginning_that_is_far_off(quantity):
    """Half the size, a quarter of a turn off; not so far that it would be another motion."""
    exact = structure(quantity)
    start = exact.state(None)
    start.initial[0, :2] = 0.5 * BEGIN[1] / TRUTH["omega0"], -0.5 * BEGIN[0] * TRUTH["omega0"]
    assert np.all(errors(settled(exact.problem, start)) < 1e-3)


def test_with_wrong_parameters_the_first_cycles_are_met_no_worse():
    wrong = structure(omega0=0.95 * TRUTH["omega0"], viscous=2 * TRUTH["viscous"])
    start = wrong.state(None)
    begun = settled(wrong.problem, start)
    few = round(2 * 2 * np.pi / TRUTH["omega0"] * FS)
    before, after = (float(np.std(wrong.problem.residuals(s)[0][:few])) for s in (start, begun))
    assert after <= before
    assert np.all(errors(begun) < 0.5)  # a larger beginning makes up for some of the damping


def test_a_mass_that_begins_at_rest_is_left_there():
    t = np.arange(2500) / FS
    still = structure(begin=(0.0, 0.0), force=np.sin(2 * np.pi * (8 * t + 2 * t**2)))
    (segment,) = still.segments
    assert segment.rests
    begun = settled(still.problem, still.state(None))
    assert np.all(begun.initial == 0.0)


def test_a_stretch_that_begins_in_motion_under_a_force():
    t = np.arange(2500) / FS
    moving = structure(force=np.sin(2 * np.pi * (8 * t + 2 * t**2)))
    assert np.all(errors(settled(moving.problem, moving.state(None))) < 1e-3)


@pytest.mark.parametrize("faster", [1.1, 1.25, 1.4])
def test_a_pendulum_begun_too_fast_is_held_back(faster):
    """At 1.1 it swings too far, at 1.25 and 1.4 it goes over the top: the first quarter of a cycle leads back."""
    from scipy.integrate import solve_ivp

    pace, damping, begin = 5.5, 0.05, np.array([-1.25, 6.0 * 5.5 / 5.0])
    t = np.arange(1500) / 150.0
    motion = solve_ivp(
        lambda _, z: [z[1], -damping * z[1] - pace**2 * np.sin(z[0])], (0, t[-1]), begin, t_eval=t, rtol=1e-10
    ).y[0]
    motion = motion + 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    recording = Recording("pendulum", 150.0, motion, None, "displacement", "rad", free=True)
    values = {"omega0": 1e-3, "cubic": 0.0, "preload": 0.0, "viscous": damping, "dry": 0.0}
    plain = Oscillator.from_values(values | {"omega0": pace}, response=Response("displacement", "rad"))
    model = with_term(plain, "softening-stiffness/sine", {"stiffness": pace**2, "width": 1.0})
    model = model.with_parameters({"omega0": replace(model.parameters()["omega0"], value=1e-3)})
    swinging = Structure(model, data_of([recording], plain, coarse=False))
    start = swinging.state(None)
    start.initial[0, :2] = begin * np.array([1.0, faster])
    begun = settled(swinging.problem, start)
    assert begun.initial[0, :2] == pytest.approx(begin, rel=2e-3)


def test_where_nothing_simulates_the_state_stays():
    """A spring that gives way far inside of the motion: no number is made of no number."""
    falling = structure(cubic=-20 * TRUTH["omega0"] ** 2 / BEGIN[0] ** 2)
    start = falling.state(None)
    assert not np.all(np.isfinite(falling.problem.residuals(start)[0]))
    assert np.all(np.isfinite(settled(falling.problem, start).initial))


@cache
def rung():
    """A light mass rings on one that friction and preload soon hold, in two stretches; an accelerometer shows it."""
    values = {"mass": 2.123, "omega0": 113.9, "cubic": 0.0, "preload": 0.815, "viscous": 7.78, "dry": 0.263}
    hung = {"mass-ratio": 0.0474, "frequency": 163.7, "damping": 1.71}
    model = Oscillator.from_values(values, response=Response("acceleration", "m/s2"))
    model = with_term(model, "attached-resonator", hung)
    fs, n, middle = 3600.0, 2500, 800
    core = Core(model)
    how = np.array(list(model.values().values())), np.array([0.0, 0.15, 0.0, 0.0]), None, n, 1 / fs, 1e-3
    y = core.record(*how) + 0.08 * np.random.default_rng(1).standard_normal(n)
    recording = Recording("ringing", fs, y, None, "acceleration", "m/s2", free=True)
    data = data_of([recording], model, coarse=False)
    whole = replace(data.segments[0], start=0, stop=n, response=y, time=0.0)
    parts = (whole.part(0, middle), whole.part(middle, n))
    cut = replace(data, segments=parts, sensor=data.sensor[:1] * 2, force=data.force[:1] * 2)
    return Structure(model, cut), core.record(*how, states=True)[middle]


def test_what_no_sensor_shows_goes_on_from_the_stretch_before():
    """From an attached mass at rest another swing of it would be found: what friction does then hangs by a hair."""
    exact, states = rung()
    begun = settled(exact.problem, exact.state(None))
    assert exact.problem.core.begin(begun.initial[1]) == pytest.approx(states, rel=0.1)
    assert np.std(exact.problem.residuals(begun)[1]) < 0.12


@pytest.mark.parametrize(("slide", "memory"), [(True, np.inf), (False, 1.0)])
def test_nothing_goes_on_where_each_stretch_is_to_forget_the_others(slide, memory):
    """Pieces of a slide are cut so that nothing adds up; a prediction forgets."""
    exact, _ = rung()
    problem = exact.problem.over([replace(s, slide=slide) for s in exact.problem.segments]).predicting(memory)
    together, alone = settled(problem, exact.state(None)), settled(problem.over(problem.segments[1:]), _second(exact))
    assert together.initial[1] == pytest.approx(alone.initial[0])


def _second(exact):
    state = exact.state(None)
    return replace(state, initial=state.initial[1:])
