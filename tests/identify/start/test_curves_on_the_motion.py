"""Learnt curves of mass, drive and sensor from one linear regression on the measured motion, whose truth is known."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Structure
from dashpot.identify.start.measured_motion import Regression
from dashpot.model import Oscillator
from dashpot.model.law import Motion
from dashpot.model.library import find
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
MASS, OMEGA, VISCOUS = LINEAR["mass"], LINEAR["omega0"], LINEAR["viscous"]
FS, SECONDS, FORCE, REACH, NOISE = 400.0, 5.0, 2.0, 8e-3, 1e-6


def plain(q):
    return q


def bent_force(force):
    """A drive that gives way, the more the larger the force, on one side more."""
    return force / (1 + 0.15 * (force / FORCE) ** 2 + 0.1 * (force / FORCE) ** 3)


def bent_record(x):
    return x - 0.05 * x**2 / REACH - 0.04 * x**4 / REACH**3


def heavier(x):
    """Mass in parts of that at rest, and its slope."""
    return 1 + 0.3 * (x / REACH) ** 2, 0.6 * x / REACH**2


def recorded(mass: Callable | None = None, drive: Callable = plain, sensor: Callable = plain) -> Recording:
    """Under a sweep from 5 to 20 Hz, by an integrator of the test's own."""

    def force(t):
        return FORCE * np.sin(2 * np.pi * (5.0 * t + 1.5 * t**2))

    def rate(t, z):
        x, v = z
        moving, slope = mass(x) if mass else (1.0, 0.0)
        return v, (drive(force(t)) / MASS - OMEGA**2 * x - VISCOUS * v - 0.5 * slope * v**2) / moving

    t = np.arange(round(FS * SECONDS)) / FS
    x = solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], t_eval=t, method="DOP853", rtol=1e-8, atol=1e-12).y[0]
    return Recording("rig", FS, sensor(x) + NOISE * np.random.default_rng(3).standard_normal(t.size), force(t))


def learnt(recording: Recording, name: str) -> tuple[Callable, dict[str, float], float]:
    """What the curve makes of a signal or, of a mass, of the place; all values; the misfit over the plain one."""
    model, law = Oscillator.from_values(LINEAR), find(name)
    regression = Regression(data_of((recording,), model), model)
    guess = regression.best(law)
    assert guess is not None
    q, own = ca.SX.sym("q"), {p.name: guess.values[f"{name}.{p.name}"] for p in law.parameters}
    path = law.drive or law.record
    made = path(Motion(0.0, 0.0, 0.0), own, q) if path else None
    if made is None:
        assert law.force is not None
        made = 1.0 + law.force(Motion(q, 0.0, 0.0, a=1.0), own)
    curve = ca.Function("curve", [q], [made])
    return lambda at: np.array([float(curve(place)) for place in at]), guess.values, guess.misfit / regression.plain()


def test_a_drive_that_bends_is_found_and_the_mass_with_it():
    curve, values, left = learnt(recorded(drive=bent_force), "free/drive/6")
    at = FORCE * np.linspace(-0.9, 0.9, 13)
    slope = values["mass"] / MASS  # a gain and the mass are one
    assert slope == pytest.approx(1.0, abs=0.05)
    assert np.max(np.abs(curve(at) / slope - bent_force(at))) < 0.03 * FORCE
    assert left < 0.3


def test_a_mass_over_the_displacement_is_found():
    curve, values, left = learnt(recorded(mass=heavier), "free/inertia/6")
    x = REACH * np.linspace(-0.8, 0.8, 9)
    whole = values["mass"] / MASS * curve(x)
    assert whole == pytest.approx(heavier(x)[0], rel=0.03)
    assert left < 0.3


def test_a_sensor_that_bends_is_found_to_first_order():
    curve, values, left = learnt(recorded(sensor=bent_record), "free/sensor/6")
    x = REACH * np.linspace(-0.8, 0.8, 9)
    bend = bent_record(x) - x
    gain = MASS / values["mass"]
    assert np.max(np.abs(curve(x) * gain - bent_record(x))) < 0.35 * np.max(np.abs(bend))
    assert left < 0.3


def test_a_drive_is_not_asked_for_without_a_force():
    t = np.arange(round(3.0 * FS)) / FS
    free = Recording("free", FS, REACH * np.exp(-0.5 * VISCOUS * t) * np.cos(OMEGA * t))
    model = Oscillator.from_values({name: value for name, value in LINEAR.items() if name != "mass"})
    regression = Regression(data_of((free,), model), model)
    assert regression.best(find("free/drive/6")) is None
    assert regression.best(find("free/inertia/6")) is not None


@pytest.mark.parametrize(
    ("name", "bent"),
    [
        ("free/drive/6", {"drive": bent_force}),
        ("free/inertia/6", {"mass": heavier}),
        ("free/sensor/6", {"sensor": bent_record}),
    ],
)
def test_from_there_a_fit_comes_to_the_noise(name, bent):
    """But for what six intervals cannot show of a fourth power; the plain model leaves far more."""
    recording, model, law = recorded(**bent), Oscillator.from_values(LINEAR), find(name)
    data = data_of((recording,), model)
    guess = Regression(data, model).best(law)
    assert guess is not None
    fitted = Structure(guess.put_into(model), data, (f"{name}.{law.parameters[-1].name}",)).fit(most=25)
    left = np.sqrt(np.mean(np.concatenate(fitted.residuals) ** 2))
    plain_left = np.sqrt(np.mean(np.concatenate(Structure(model, data).fit(most=25).residuals) ** 2))
    assert left < 3 * NOISE
    assert plain_left > 20 * NOISE
