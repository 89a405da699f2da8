"""One expression, many renderings: compiled engine, CasADi step, right-hand sides."""

from __future__ import annotations

import itertools

import casadi
import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.model.laws import LIBRARY
from dashpot.simulate.casadi_step import exact_step
from dashpot.simulate.core import core_of, internal_step

DT = 1e-3


def both(model, force):
    core, p = core_of(model), np.array(list(model.values().values()))
    longest = internal_step(model, model.values(), 9e-3)
    compiled = core.record(p, np.zeros(2), force, len(force), DT, longest, states=True)
    step = exact_step(model, DT, longest)
    z, stepped = np.zeros(2), [np.zeros(2)]
    for here, there in itertools.pairwise(force):
        z = np.array(step(z, [here, there], p, 0.0, DT)).ravel()
        stepped.append(z)
    return compiled, np.array(stepped)


@pytest.fixture
def rig():
    return Oscillator.from_values(TRUTH)


def test_the_casadi_step_and_the_compiled_engine_agree(rig):
    t = np.arange(2500) * DT
    force = 1.0 * np.sin(2 * np.pi * (8 * t + 2 * t**2))
    force[1800:] = 0.0
    compiled, stepped = both(rig, force)
    assert np.max(np.abs(compiled - stepped)[:, 0]) < 1e-6 * np.max(np.abs(compiled[:, 0]))


def test_they_agree_where_the_mass_sticks_again_and_again(rig):
    random = np.random.default_rng(3)
    force = 0.03 * np.sin(2 * np.pi * 6 * np.arange(3000) * DT) + 0.002 * random.standard_normal(3000)
    compiled, stepped = both(rig, force)
    assert np.mean(compiled[:, 1] == 0.0) > 0.02  # it does stick
    assert np.max(np.abs(compiled - stepped)[:, 0]) < 1e-6 * np.max(np.abs(compiled[:, 0]))


def test_a_single_force_is_held_and_left_out_parameters_are_the_identified_ones(rig):
    step = exact_step(rig, DT, 1e-3)
    held = step(x=[1e-3, 0.1], u=0.5)["x_next"]
    spelled = step(x=[1e-3, 0.1], u=[0.5, 0.5], p=list(rig.values().values()), dt=DT)["x_next"]
    assert np.array_equal(np.array(held), np.array(spelled))


@pytest.mark.parametrize(
    ("effect", "changed"),
    [(effect, {}) for effect in LIBRARY]
    + [("hysteresis", {"hysteresis.exponent": power}) for power in (1.0, 2.0, 1.37)],
)
def test_the_right_hand_side_of_the_engine_is_that_of_the_expression(effect, changed, with_law):
    import ctypes

    from dashpot.model.equations import equations, signed

    model = with_law(effect, **changed)
    eq = equations(model)
    plain = casadi.Function("f", [eq.z, eq.t, eq.u, eq.p], [signed(eq, eq.zdot)])
    core, p = core_of(model), np.array(list(model.values().values()))
    doubles = ctypes.POINTER(ctypes.c_double)
    random = np.random.default_rng(0)
    for _ in range(20):
        z = random.standard_normal(core.states) * [5e-3, 0.4, *np.tile([5e-3, 0.4], 2)][: core.states]
        t, u, out = random.uniform(), random.standard_normal(), np.zeros(core.states)
        core._library.dp_rates(
            p.ctypes.data_as(doubles), z.ctypes.data_as(doubles), ctypes.c_double(t), ctypes.c_double(u),
            out.ctypes.data_as(doubles),
        )  # fmt: skip
        assert out == pytest.approx(np.array(plain(z, t, u, p)).ravel(), rel=1e-12, abs=1e-12)
