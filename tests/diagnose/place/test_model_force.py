"""The force of a model's laws along a given motion, against closed forms and differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.model_force import OwnForce, numbers, term_force
from dashpot.model import Oscillator, Response
from dashpot.model.inner_force import InnerForce
from dashpot.model.terms import with_term

VALUES = {"mass": 0.5, "omega0": 60.0, "cubic": 2e8, "preload": 0.05, "viscous": 1.5, "dry": 0.06}
DT = 1e-4


def motion_of(n=50, seed=1):
    random = np.random.default_rng(seed)
    return np.column_stack([2e-3 * random.standard_normal(n), 0.1 * random.standard_normal(n), np.zeros((n, 2))])


def cycle(size=2e-3, omega=60.0, seconds=0.2):
    """(m, 4) of a harmonic motion under a harmonic force of one newton."""
    t = np.arange(round(seconds / DT)) * DT
    return np.column_stack([size * np.sin(omega * t), size * omega * np.cos(omega * t), t, np.sin(2 * omega * t)])


def with_one(effect, **values):
    model = with_term(Oscillator.from_values(VALUES), effect, values)
    return model, model.terms[0]


def test_the_models_own_force_is_that_of_the_inner_force():
    model, _ = with_one("quadratic-drag", coefficient=20.0)
    motion = motion_of()
    force, stiffness, damping = OwnForce(model)(motion, 1e-3)
    assert force == pytest.approx(InnerForce(model)(motion[:, 0], motion[:, 1]), rel=1e-12)
    assert stiffness == pytest.approx(60.0**2 + 3 * 2e8 * motion[:, 0] ** 2)
    assert damping == pytest.approx(np.full(50, 1.5))


def test_eq_17_is_written_out():
    x, v = motion_of().T[:2]
    force, _, _ = OwnForce(Oscillator.from_values(VALUES))(motion_of(), DT)
    expected = 60.0**2 * x + 2e8 * x**3 + 0.05 * np.sign(x) + 1.5 * v + 0.06 * np.sign(v)
    assert force == pytest.approx(expected, rel=1e-12)


def test_its_slopes_are_differences_of_it():
    own, motion = OwnForce(Oscillator.from_values(VALUES)), motion_of()
    _, stiffness, damping = own(motion, DT)
    for column, step, slope in ((0, 1e-8, stiffness), (1, 1e-6, damping)):
        ahead, behind = motion.copy(), motion.copy()
        ahead[:, column] += step
        behind[:, column] -= step
        assert (own(ahead, DT)[0] - own(behind, DT)[0]) / (2 * step) == pytest.approx(slope, rel=1e-5)


def test_the_force_does_not_depend_on_what_is_recorded():
    base = Oscillator.from_values(VALUES)
    speed = replace(base, response=Response("velocity", "m/s"))
    for here, there in zip(OwnForce(base)(motion_of(), DT), OwnForce(speed)(motion_of(), DT), strict=True):
        assert np.array_equal(here, there)


def test_a_term_is_its_closed_form():
    _, drag = with_one("quadratic-drag", coefficient=20.0)
    motion = motion_of()
    assert numbers(drag) == {"coefficient": 20.0}
    assert term_force(drag, motion, DT) == pytest.approx(20.0 * motion[:, 1] * np.abs(motion[:, 1]), rel=1e-12)


def test_a_law_of_the_drive_gives_the_force_that_arrives():
    _, gap = with_one("actuator-dead-zone", threshold=0.3)
    motion = cycle()
    force = motion[:, 3]
    arrived = np.sign(force) * np.maximum(np.abs(force) - 0.3, 0.0)
    assert term_force(gap, motion, DT) == pytest.approx(arrived, abs=1e-12)


def test_laws_of_the_drive_and_the_sensor_are_no_part_of_the_own_force():
    base = Oscillator.from_values(VALUES)
    motion = cycle()
    for effect, values in (("actuator-dead-zone", {"threshold": 0.3}), ("sensor-offset", {"offset": 1e-3})):
        model, _ = with_one(effect, **values)
        assert OwnForce(model).terms == ()
        assert np.array_equal(OwnForce(model)(motion, DT)[0], OwnForce(base)(motion, DT)[0])


def test_a_memory_is_carried_along_the_motion():
    """A Maxwell branch under a harmonic motion (Findley, Lai, Onaran 1976): k x tau s / (1 + tau s)."""
    model, branch = with_one("viscoelastic", stiffness=500.0, rate=100.0)
    motion = cycle(seconds=1.0)
    turn = 60.0 / 100.0
    response = 500.0 * 2e-3 * 1j * turn / (1 + 1j * turn)
    expected = (response * np.exp(1j * 60.0 * motion[:, 2])).imag
    force = term_force(branch, motion, DT)
    late = slice(2000, None)
    assert force[late] == pytest.approx(expected[late], abs=2e-3 * abs(response))
    beside = OwnForce(model)(motion, DT)[0] - OwnForce(Oscillator.from_values(VALUES))(motion, DT)[0]
    assert beside == pytest.approx(force, abs=1e-9)
