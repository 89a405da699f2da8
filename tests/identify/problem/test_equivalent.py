"""Describing functions against closed forms; the noise that a driven pendulum passes on against a simulation of it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of, expected_noise
from dashpot.identify.problem.equivalent import equivalent
from dashpot.model import Response, oscillator_with
from dashpot.recording import Recording
from scipy.integrate import solve_ivp
from scipy.special import jv

NOTHING = {"omega0": 0.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
A, PACE, SINE = 1.3, 6.0, "softening-stiffness/sine"


def test_eq_17_is_that_of_eqs_6_and_7():
    stiffness, damping = equivalent(TRUTH, 8e-3, 80.0)
    assert stiffness == pytest.approx(
        TRUTH["omega0"] ** 2 + 0.75 * TRUTH["cubic"] * 8e-3**2 + 4 * TRUTH["preload"] / (np.pi * 8e-3)
    )
    assert damping == pytest.approx(TRUTH["viscous"] + 4 * TRUTH["dry"] / (np.pi * 80.0 * 8e-3))


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ({f"{SINE}.stiffness": 30.0, f"{SINE}.width": 1.0}, (60 * jv(1, A) / A, 0.0)),
        ({"quintic-stiffness.coefficient": 2.0}, (2.0 * 5 / 8 * A**4, 0.0)),
        ({"quadratic-drag.coefficient": 0.5}, (0.0, 0.5 * 8 / (3 * np.pi) * A * PACE)),
        ({"cubic-damping.coefficient": 0.1}, (0.0, 0.1 * 0.75 * (A * PACE) ** 2)),
        ({"constant-force.load": 3.0}, (0.0, 0.0)),
    ],
)
def test_a_law_has_the_describing_function_of_the_books(law, expected):
    assert equivalent(NOTHING | law, A, PACE) == pytest.approx(expected, rel=1e-3, abs=1e-9)


def pendulum(force, dt, gravity=36.0, viscous=0.4):
    """Angle (n,) from rest under a moment per inertia in straight lines between its samples."""
    t = dt * np.arange(force.size)

    def rates(now, y):
        return y[1], np.interp(now, t, force) - viscous * y[1] - gravity * np.sin(y[0])

    return solve_ivp(rates, (0, t[-1]), (0.0, 0.0), t_eval=t, rtol=1e-8, atol=1e-10, max_step=dt).y[0]


@pytest.mark.long
def test_the_noise_floor_of_a_driven_pendulum_knows_what_its_spring_is():
    """All its stiffness is in the sine; omega0 = 0 would make a slide of it, and noise as large as the motion."""
    dt, random = 0.02, np.random.default_rng(4)
    t = dt * np.arange(6000)
    force = 3.0 * np.sin(2 * np.pi * (0.5 + 0.7 * t / t[-1]) * t)
    noise = 0.2
    moved = pendulum(force, dt)
    made = np.std(pendulum(force + noise * random.standard_normal(t.size), dt) - moved)
    recording = Recording("pendulum", 1 / dt, moved, force, "displacement", "rad")
    model = oscillator_with(
        NOTHING | {"mass": 1.0, "omega0": 0.01, "viscous": 0.4, f"{SINE}.stiffness": 36.0, f"{SINE}.width": 1.0},
        response=Response("displacement", "rad"),
        effects=(SINE,),
    )
    data = data_of([recording], model)
    assert not data.segments[0].slide
    (segment,) = data.segments
    level = expected_noise(segment, model.values(), 0.0, noise)
    assert level == pytest.approx(made, rel=0.25)
    plain = {name: value for name, value in model.values().items() if "." not in name}
    assert expected_noise(segment, plain, 0.0, noise) > 5 * made  # without its spring
