"""Displacement and velocity at the first sample, of each quantity: closed forms and the independent integrator."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.initial_motion import from_first_cycle, initial_states
from dashpot.identify.problem.segments import Segment

W, DT = 80.0, 1e-3
QUANTITIES = ("displacement", "velocity", "acceleration")


def segment(response, quantity, rests=False):
    return Segment(0, 0, response.size, response, None, DT, 0.0, W, rests, quantity=quantity)


def harmonic(quantity, phase, n=400):
    """x = A cos(W t + phase), and what it begins with."""
    t = np.arange(n) * DT
    motion = 5e-3 * np.exp(1j * (W * t + phase)) * (1j * W) ** QUANTITIES.index(quantity)
    return motion.real, (5e-3 * np.cos(phase), -5e-3 * W * np.sin(phase))


@pytest.mark.parametrize("phase", np.linspace(0.0, 2 * np.pi, 7))
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_harmonic_motion_in_closed_form(quantity, phase):
    response, begin = harmonic(quantity, phase)
    ((x, v),) = initial_states([segment(response, quantity)])
    off = 0.06 if quantity == "displacement" else 1e-9  # a parabola through a seventh of a cycle
    assert x == pytest.approx(begin[0], abs=off * 5e-3)
    assert v == pytest.approx(begin[1], abs=off * 5e-3 * W)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_sensors_zero_is_no_motion(quantity):
    response, begin = harmonic(quantity, 0.7)
    size = float(np.max(np.abs(response)))
    ((x, v),) = initial_states([segment(response + 5 * size, quantity)], [5 * size])
    assert (x, v) == pytest.approx(begin, rel=0.1)
    if quantity != "displacement":  # its line has a constant of its own
        assert from_first_cycle(response + 0.5 * size, DT, W, quantity) == pytest.approx((x, v), rel=0.03)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_stretch_that_rests_begins_at_zero(quantity):
    response, _ = harmonic(quantity, 0.7)
    states = initial_states([segment(response, quantity), segment(response, quantity, rests=True)])
    assert np.all(states[1] == 0.0)
    assert np.all(states[0] != 0.0)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_decay_with_friction_begins_far_from_where_friction_would_hold_it(quantity):
    """The rig's own decay: near enough for the search, though nothing in it is harmonic."""
    x, v = integrate(TRUTH, np.zeros(500), DT, 7e-3, 0.3)
    c, dry, w, c3, pre = (TRUTH[k] for k in ("viscous", "dry", "omega0", "cubic", "preload"))
    a = -c * v - dry * np.sign(v) - w**2 * x - c3 * x**3 - pre * np.sign(x)
    response = {"displacement": x, "velocity": v, "acceleration": a}[quantity]
    ((x0, v0),) = initial_states([segment(response, quantity)])
    assert np.hypot(x0 - 7e-3, (v0 - 0.3) / W) < 0.15 * np.hypot(7e-3, 0.3 / W)


def test_fewer_samples_than_a_cycle():
    response, begin = harmonic("velocity", 0.4, n=20)  # a quarter of one
    assert from_first_cycle(response, DT, W, "velocity") == pytest.approx(begin, rel=1e-6)
