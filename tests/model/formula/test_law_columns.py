"""Laws as functions of one variable: which there are, and that they are the laws."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.model.formula.curve import LearntCurve
from dashpot.model.formula.law_columns import columns_for
from dashpot.model.law import Scales

AT = np.linspace(-1.0, 1.0, 41)


def curve(variable: str = "x", times: str = "") -> LearntCurve:
    effect = {("x", ""): "free/spring", ("v", ""): "free/damping", ("x", "v"): "free/surface"}[variable, times]
    return LearntCurve(effect, AT, AT, np.eye(AT.size))


def laws(variable: str = "x", times: str = "") -> dict:
    return {"" if one.law is None else one.law.name: one for one in columns_for(curve(variable, times))}


def test_only_laws_of_the_variable_alone_are_asked():
    springs = {"", "quadratic-stiffness", "softening-stiffness", "clearance", "one-sided-stop", "gas-spring"}
    assert set(laws()) >= springs
    assert set(laws("v")) >= {"", "quadratic-drag", "cubic-damping", "stribeck", "asymmetric-friction"}
    assert set(laws("x", "v")) == {"", "displacement-dependent-damping"}
    every = {*laws(), *laws("v"), *laws("x", "v")}
    assert not every & {"hysteresis", "viscoelastic", "stiffness-drift", "constant-force", "actuator-lag"}
    assert not any(name.startswith("free/") for name in every)


@pytest.mark.parametrize(
    ("name", "variable", "times", "inside", "wanted"),
    [
        ("quadratic-stiffness", "x", "", (), lambda q: q**2),
        ("softening-stiffness", "x", "", (0.3,), lambda q: 0.3 * np.tanh(q / 0.3)),
        ("one-sided-stop", "x", "", (0.4,), lambda q: np.maximum(q - 0.4, 0.0)),
        ("one-sided-stop", "x", "", (-0.4,), lambda q: np.minimum(q + 0.4, 0.0)),
        ("clearance", "x", "", (0.4,), lambda q: np.sign(q) * np.maximum(np.abs(q) - 0.4, 0.0)),
        ("quadratic-drag", "v", "", (), lambda q: q * np.abs(q)),
        ("displacement-dependent-damping", "x", "v", (), lambda q: q**2),
    ],
)
def test_a_column_is_the_law_of_a_strength_of_one(name, variable, times, inside, wanted):
    made = laws(variable, times)[name].made(np.array(inside))
    assert made == pytest.approx(wanted(AT), rel=1e-12, abs=1e-15)


def test_the_grid_keeps_to_the_bounds_and_to_both_sides_where_there_are_two():
    scales = Scales(2.0, 1.0, 2.0, 2.0, 1.0)
    stop, soft = (laws()[name].grid(scales)[:, 0] for name in ("one-sided-stop", "softening-stiffness"))
    assert stop.min() == -stop.max() < -2.0 * 0.85
    assert soft.min() > 0
    assert soft.max() > 2.0
    assert laws()[""].grid(scales).shape == (1, 0)
