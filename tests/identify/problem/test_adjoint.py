"""What a weighted sum of a response feels of each sample of its force: against the runs with that sample moved."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem import adjoint
from dashpot.identify.problem.adjoint import felt, pushed
from dashpot.model import Response, oscillator_with
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import staircase, straight_lines

N, DT = 1500, 1 / 400
T = np.arange(N) * DT
FORCE = 2.0 * np.sin(2 * np.pi * (9.0 + T) * T)
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
LINEAR = TRUTH | {"preload": 0.0, "dry": 0.0}
MEMORY = {"viscoelastic.stiffness": 2e3, "viscoelastic.rate": 40.0}


def of_run(values, quantity, hold, effects=()):
    model = oscillator_with(values, effects, response=Response(quantity, UNITS[quantity]))
    core, force = core_of(model), staircase(FORCE) if hold == "zero" else straight_lines(FORCE, DT)
    p = np.array([model.values()[name] for name in core.parameter_names])
    arguments = (p, np.array([1e-3, 0.0]), force, N, DT, internal_step(model, model.values(), 8e-3))
    return core, arguments


@pytest.mark.parametrize("hold", ["linear", "zero"])
@pytest.mark.parametrize(
    ("values", "quantity", "effects"),
    [
        (TRUTH, "displacement", ()),
        (LINEAR, "velocity", ()),
        (LINEAR, "acceleration", ()),
        (TRUTH | MEMORY, "displacement", ("viscoelastic",)),
    ],
)
def test_each_sample_of_the_force_is_felt_as_when_it_is_moved(values, quantity, effects, hold, monkeypatch):
    monkeypatch.setattr(adjoint, "_AT_ONCE", 400)  # in several parts
    core, arguments = of_run(values, quantity, hold, effects)
    weights = np.stack([np.cos(2 * np.pi * 11.0 * T), np.sin(2 * np.pi * 5.0 * T**2)])
    found = np.full(weights.shape, np.nan)
    for part, own in felt(core.transitions(*arguments)[1], weights, held=hold == "zero"):
        found[:, part] = own
    kick, places = 1e-6, (1, 2, 399, 400, 701, 1203, N - 25)
    for place in places:
        added = np.zeros(N)
        added[place] = kick
        there = core.record(*arguments, added=added)
        added[place] = -kick
        moved = weights @ (there - core.record(*arguments, added=added)) / (2 * kick)
        # a straight line is taken for its mean over an interval, a held force is exact
        allowed = 1e-5 if hold == "zero" else 5e-3
        assert found[:, place] == pytest.approx(moved, rel=allowed, abs=allowed * float(np.max(np.abs(found))))


@pytest.mark.parametrize(("values", "quantity"), [(TRUTH, "displacement"), (LINEAR, "acceleration")])
def test_a_small_force_pushes_the_response_as_when_it_is_added(values, quantity):
    core, arguments = of_run(values, quantity, "linear")
    forces = 1e-6 * np.stack([np.cos(2 * np.pi * 11.0 * T), np.sin(2 * np.pi * 5.0 * T**2)])
    found = pushed(core.transitions(*arguments)[1], 0.5 * (forces[:, :-1] + forces[:, 1:]), forces)
    for force, change in zip(forces, found, strict=True):
        moved = (core.record(*arguments, added=force) - core.record(*arguments, added=-force)) / 2
        assert change == pytest.approx(moved, abs=5e-3 * float(np.max(np.abs(moved))))


def test_where_it_does_not_simulate_nothing_is_known():
    core, arguments = of_run(TRUTH | {"cubic": -1e9}, "displacement", "linear")
    assert np.isnan(core.transitions(*arguments)[1][0][-1]).all()
