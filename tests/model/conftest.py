"""The paper's stand, laws that only tests know, and random states of any model."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi
import numpy as np
import pytest
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.equations import equations, signed
from dashpot.model.law import Law, LawParameter
from dashpot.model.library import KNOWN

RIG = {
    "mass": 0.27,
    "omega0": 2 * math.pi * 12.67,
    "cubic": 4.6e5,
    "preload": 0.02 / 0.27,
    "viscous": 5.0,
    "dry": 0.015,
}


@pytest.fixture
def rig():
    """``rig(cubic=0.0)``: an oscillator with the stand's values but for those given; ``effects`` as in from_values."""

    def make(effects: tuple[str, ...] = (), **changed: float) -> Oscillator:
        values = {name: changed.pop(name, value) for name, value in RIG.items()}
        return oscillator_with({**values, **changed}, effects=effects)

    return make


@pytest.fixture
def contact(monkeypatch):
    """A linear spring that acts beyond +gap only, put into the library for one test."""
    law = Law(
        name="contact",
        path="restoring",
        parameters=(LawParameter("stiffness", "1/s2", "contact stiffness"), LawParameter("gap", "X", "clearance", 0.0)),
        force=lambda motion, p: p["stiffness"] * (motion.x - p["gap"]) * (1 + motion.sign(motion.x - p["gap"])) / 2,
        equation="contact",
        sentence="A contact.",
        source="test",
    )
    monkeypatch.setitem(KNOWN, "contact", law)


class AtRandom:
    """A model at 400 random states: ``here(here.eq.energy)`` is an expression there, its signs written out.

    Displacement, velocity, time and force are the same for every model; inner states are about what they follow.
    """

    def __init__(self, model, inner):
        self.eq = equations(model)
        self.p = casadi.DM(list(model.values().values()))
        random = np.random.default_rng(1)

        def spread(size):
            return size * random.uniform(-1.0, 1.0, 400)

        rows = [spread(8e-3), spread(8e-3 * RIG["omega0"])]
        self.t, self.u = 0.5 + spread(0.5), spread(1.0)
        for leader, size in zip(self.eq.follows[2:], inner, strict=True):
            rows.append((0.0 if leader is None else rows[leader]) + spread(size))
        self.z = np.array(rows)

    def __call__(self, expression, z=None, t=None, u=None):
        """(rows, states), or (states,) where the expression is a scalar; at other states where these are given."""
        eq = self.eq
        plain = casadi.densify(casadi.substitute(signed(eq, expression), eq.p, self.p))
        point = [own if given is None else given for own, given in ((self.z, z), (self.t, t), (self.u, u))]
        values = np.array(casadi.Function("f", [eq.z, eq.t, eq.u], [plain])(point[0], point[1][None], point[2][None]))
        return values[0] if expression.is_scalar() else values


@pytest.fixture
def at_random(offsets):
    """``at_random(model)``: the model at random states, see there."""
    return lambda model: AtRandom(model, 1e3 * np.array(offsets(model)))


@pytest.fixture
def share(at_random):
    """``share(model)``: what its terms add to energy and dissipated power, (states,) each, and the size of all."""

    def make(model: Oscillator):
        full, base = at_random(model), at_random(replace(model, terms=()))
        size = float(full.p[0]) * np.max(np.abs(full(full.eq.zdot[1] * full.eq.z[1])))
        return full(full.eq.energy) - base(base.eq.energy), full(full.eq.dissipated) - base(base.eq.dissipated), size

    return make
