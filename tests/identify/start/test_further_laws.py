"""Laws beside Eq. 17 that somebody says are there, and values that somebody knows; rigs by scipy's integrator."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.problem.data import data_of
from dashpot.identify.start.further_laws import with_laws
from dashpot.model import Oscillator, Response, oscillator_with
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

W = 2 * np.pi * 5.0
DRAG = {"mass": 0.8, "omega0": W, "viscous": 0.4, "quadratic-drag.coefficient": 6.0}
NOTHING_ELSE = {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
GRAVITY = (2 * np.pi * 0.8) ** 2
SINE = "softening-stiffness/sine"


def integrated(acceleration, x0, seconds, fs, *, noise, force=None, name="run", unit="m"):
    """x'' = acceleration(x, x') + force(t) / mass, from rest at x0."""
    t = np.arange(round(seconds * fs)) / fs

    def rates(time, y):
        return y[1], acceleration(*y) + (0.0 if force is None else force(time) / DRAG["mass"])

    x = solve_ivp(rates, (0, t[-1]), (x0, 0.0), t_eval=t, method="DOP853", rtol=1e-10, atol=1e-13, max_step=0.02).y[0]
    x = x + noise * np.random.default_rng(0).standard_normal(t.size)
    return Recording(name, fs, x, None if force is None else np.array([force(when) for when in t]), unit=unit)


def dragged(x, v):
    return -W * W * x - 0.4 * v - 6.0 * v * abs(v)


@cache
def drag():
    """A decay and a sweep of a rig in water."""
    decay = integrated(dragged, 1e-2, 8.0, 200.0, noise=1e-6, name="decay")
    sweep = integrated(
        dragged,
        0.0,
        8.0,
        200.0,
        noise=1e-6,
        name="sweep",
        force=lambda t: 2 * math.sin(2 * np.pi * (3 * t + 0.25 * t * t)),
    )
    return decay, sweep


@cache
def dragging():
    """What is identified from them with the law that is there; made once."""
    return identify(drag(), effects=["quadratic-drag"])


@cache
def dragging_alone():
    """The same where nothing else of Eq. 17 is there."""
    return identify(drag(), effects=["quadratic-drag"], fixed=NOTHING_ELSE)


@cache
def pendulum(angle, viscous, seconds):
    def swinging(x, v):
        return -GRAVITY * math.sin(x) - viscous * v

    return integrated(swinging, angle, seconds, 100.0, noise=1e-4, name="pendulum", unit="rad")


def scores(oscillator, truth):
    known = oscillator.parameters()
    return {name: (known[name].value - value) / known[name].std for name, value in truth.items() if known[name].std}


@pytest.mark.parametrize("fixed", [{}, NOTHING_ELSE])
def test_drag_is_found_beside_eq_17(fixed):
    oscillator = (dragging_alone() if fixed else dragging()).oscillator
    assert len(scores(oscillator, DRAG)) == len(DRAG)
    assert np.all(np.abs(list(scores(oscillator, DRAG).values())) < 4)
    assert oscillator.parameters()["quadratic-drag.coefficient"].std < 0.01
    for name in NOTHING_ELSE:
        parameter = oscillator.parameters()[name]
        assert (parameter.value, parameter.std) == (0.0, None) if fixed else abs(parameter.value) < 4 * parameter.std


def test_without_the_law_it_is_missed():
    """Else the tests above would say nothing."""
    poor, good = identify(drag()), dragging()
    assert max(s.over_noise for s in good.fit.segments) < 1.1
    assert min(s.over_noise for s in poor.fit.segments) > 10
    assert any("Eq. 17 family does not" in note for note in poor.notes)


@pytest.mark.parametrize(
    ("angle", "viscous", "seconds"),
    [
        (2.0, 0.05, 25.0),
        pytest.param(2.0, 0.2, 50.0, marks=pytest.mark.long),
        pytest.param(2.5, 0.1, 25.0, marks=pytest.mark.long),
    ],
)
def test_a_pendulums_radian(angle, viscous, seconds):
    """Gravity alone: the width of the sine is one radian, and where it may be free no linear spring is left."""
    recording = pendulum(angle, viscous, seconds)
    truth = {f"{SINE}.width": 1.0, f"{SINE}.stiffness": GRAVITY, "viscous": viscous}
    identification = identify([recording], effects=[SINE], fixed=NOTHING_ELSE | {"omega0": 1e-3})
    assert identification.fit.segments[0].over_noise < 1.1
    assert np.all(np.abs(list(scores(identification.oscillator, truth).values())) < 4)
    free = identify([recording], effects=[SINE], fixed=NOTHING_ELSE).oscillator
    # omega0 enters by its square: at zero its own error is none, and the spring together is what was measured
    assert free.omega0.value**2 < 0.01 * GRAVITY
    whole = free.omega0.value**2 + free.parameters()[f"{SINE}.stiffness"].value
    assert whole == pytest.approx(GRAVITY, rel=1e-4)
    assert free.parameters()[f"{SINE}.width"].value == pytest.approx(1.0, abs=4e-3)


@cache
def gyro():
    """The speed of a pendulum that swings down from two radians, as a rate gyro shows it."""
    t = np.arange(2500) / 100.0
    v = solve_ivp(
        lambda _, y: (y[1], -GRAVITY * math.sin(y[0]) - 0.2 * y[1]),
        (0, t[-1]),
        (2.0, 0.0),
        t_eval=t,
        method="DOP853",
        rtol=1e-10,
        atol=1e-13,
    ).y[1]
    return Recording(
        "gyro", 100.0, v + 1e-4 * np.random.default_rng(0).standard_normal(t.size), quantity="velocity", unit="rad/s"
    )


def test_a_rate_gyro_on_a_pendulum_tells_its_angle():
    """Where gravity is the law's, omega0 is zero and no measure of the motion's pace."""
    oscillator = identify([gyro()], effects=[SINE], fixed=NOTHING_ELSE).oscillator
    assert oscillator.parameters()[f"{SINE}.width"].value == pytest.approx(1.0, abs=4e-3)
    # of the speed's peak over the small motion's pace
    assert oscillator.amplitude.max == pytest.approx(np.max(np.abs(gyro().response)) / math.sqrt(GRAVITY), rel=0.1)


def test_a_mass_that_is_known_comes_with_the_decay():
    decay, _ = drag()
    without = identify([decay], effects=["quadratic-drag"], fixed=NOTHING_ELSE).oscillator
    assert without.mass is None
    known = identify([decay], effects=["quadratic-drag"], fixed=NOTHING_ELSE | {"mass": 0.8}).oscillator
    assert (known.mass.value, known.mass.std) == (0.8, None)
    for name, parameter in without.parameters().items():
        assert known.parameters()[name].value == pytest.approx(parameter.value, rel=1e-9)


def test_a_parameter_that_is_fixed_stays_and_the_others_give_way():
    value = W * 1.001
    held = identify(drag(), effects=["quadratic-drag"], fixed={"omega0": value})
    assert (held.oscillator.omega0.value, held.oscillator.omega0.std) == (value, None)
    assert "omega0" not in held.fit.names
    assert max(s.over_noise for s in held.fit.segments) > 2  # a thousandth of a frequency is many errors
    known = identify(drag(), effects=["quadratic-drag"], fixed={"quadratic-drag.coefficient": 6.0}).oscillator
    assert known.parameters()["quadratic-drag.coefficient"].value == 6.0
    assert np.all(np.abs(list(scores(known, {k: v for k, v in DRAG.items() if "drag" not in k}).values())) < 4)


def test_a_start_brings_its_laws_and_leads_to_the_same_place():
    fresh = dragging_alone().oscillator
    values = DRAG | NOTHING_ELSE | {"omega0": 0.9 * W, "quadratic-drag.coefficient": 1.0, "mass": 1.0}
    start = oscillator_with(values, effects=("quadratic-drag",), name="from a file")
    again = identify(drag(), start=start, fixed=NOTHING_ELSE, name="run").oscillator
    assert [term.effect for term in again.terms] == ["quadratic-drag"]
    assert again.name == "run"
    for name, parameter in fresh.parameters().items():
        assert again.parameters()[name].value == pytest.approx(parameter.value, rel=1e-4, abs=1e-12)
    # a law that it has already is not put in a second time
    twice = identify(drag(), start=start, effects=["quadratic-drag"], fixed=NOTHING_ELSE).oscillator
    assert twice.values() == again.values()


@pytest.mark.parametrize("fixed", [{"omga0": 1.0}, {"quadratic-drag.coefficient": 6.0}, {"hysteresis.stiffness": 1.0}])
def test_a_name_that_the_model_does_not_have_cannot_be_fixed(fixed):
    (name,) = fixed
    with pytest.raises(BadInput, match=f"there is no parameter '{name}' to fix; .*he model has mass, omega0"):
        identify(drag()[:1], fixed=fixed)


def test_a_law_that_nobody_knows_is_refused_with_its_neighbours():
    with pytest.raises(BadInput, match=r"quadratic-darg.*quadratic-drag"):
        identify(drag()[:1], effects=["quadratic-darg"])


def test_a_law_is_put_where_the_recordings_like_it():
    """From a model without it, and with a law that is there already: neither moves the other away."""
    model = Oscillator.from_values({"mass": 0.8, "omega0": W, "viscous": 1.0} | NOTHING_ELSE)
    data = data_of(drag(), model)
    parameters = with_laws(model, ["quadratic-drag"], data).parameters()
    assert parameters["quadratic-drag.coefficient"].value == pytest.approx(6.0, rel=0.2)
    assert with_laws(model, [], data) is model


@pytest.mark.parametrize("fixed", [NOTHING_ELSE, {}])
def test_what_is_known_stays_while_a_law_is_put(fixed):
    """A cubic spring that is free does most of what the sine is there for, and the motion tells them apart."""
    model = Oscillator.from_values(
        {"omega0": math.sqrt(GRAVITY), "viscous": 0.2} | NOTHING_ELSE, response=Response("velocity", "rad/s")
    )
    put = with_laws(model, [SINE], data_of([gyro()], model), fixed).parameters()
    assert all(put[name].value == value for name, value in fixed.items())
    assert put[f"{SINE}.width"].value == pytest.approx(1.0, abs=0.1)
