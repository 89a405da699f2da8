"""The nearest law of a learnt curve: truth by least squares on known functions, as for closed forms."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from dashpot.model.formula.curve import LearntCurve
from dashpot.model.formula.nearest_law import NearestLaw, _as_recorded, nearest_law
from dashpot.model.formula.search import whitener_of
from dashpot.model.laws.free_curves import Curve

from .test_closed_form import NOISE, SAMPLES, columns

#: Of the learnt springs of twelve intervals over a reach of one.
SPACING = 1.0 / 6.0


def softening(x: np.ndarray) -> np.ndarray:
    return x + 0.3 * np.tanh(x / 0.3)


def shapes(x: np.ndarray) -> np.ndarray:
    """(n, 14) a constant and the heights of a learnt damping over the place, over a reach of one."""
    names = [f"at-{k}" for k in range(13)]
    q, heights = ca.SX.sym("q"), [ca.SX.sym(name) for name in names]
    made = Curve(12, names, 1).at(q, dict(zip(names, heights, strict=True)))
    slopes = ca.Function("slopes", [q], [ca.jacobian(made, ca.vertcat(*heights)).T])
    each = np.array(slopes.map(x.size)(x[None])).reshape(len(names), x.size, order="F").T
    return np.column_stack([np.ones(x.size), each])


def learnt(function, noise: float = 5.0, seed: int = 1, basis=columns) -> LearntCurve:
    """A curve with its covariance by least squares; ``noise`` in ``NOISE``."""
    rng = np.random.default_rng(seed)
    x = np.sin(rng.uniform(0, 2 * np.pi, SAMPLES)) * rng.uniform(0, 1, SAMPLES)
    rows, level = basis(x), noise * NOISE
    covariance = np.linalg.inv(rows.T @ rows) * level**2
    values = covariance @ (rows.T @ (function(x) + level * rng.standard_normal(SAMPLES))) / level**2
    at = np.linspace(-1.0, 1.0, 121)
    rows = basis(at)
    return LearntCurve("free/spring", at, rows @ values, rows @ covariance @ rows.T, spacing=SPACING)


def nearest(function, **how) -> NearestLaw:
    found = nearest_law(learnt(function, **how), "m")
    assert found is not None
    return found


@pytest.mark.parametrize("noise", [5.0, 20.0])
def test_a_curve_that_is_a_law_is_that_law_over_all(noise):
    found = nearest(softening, noise=noise)
    assert (found.law, found.whole) == ("softening-stiffness", True)
    assert (found.low, found.high) == (-1.0, 1.0)
    for name, true, unit in (("stiffness", 1.0, "1/s2"), ("width", 0.3, "m")):
        parameter = found.parameters[name]
        assert parameter.std is not None
        assert abs(parameter.value - true) < 3 * parameter.std < 0.1
        assert parameter.unit == unit


@pytest.mark.parametrize("place", [0.4, 0.6, 0.75])
@pytest.mark.parametrize(("way", "slope"), [("more", 2.0), ("less", -0.8)])
def test_a_law_up_to_a_place_and_another_force_beyond_is_said_so(place, way, slope):
    def departing(x: np.ndarray) -> np.ndarray:
        return softening(x) + slope * np.maximum(x - place, 0.0)

    found = nearest(departing, noise=20.0)
    assert found.law == "softening-stiffness"
    assert found.high == pytest.approx(place, abs=SPACING)
    assert (found.below, found.above) == ("", way)
    assert found.low == -1.0


def test_on_both_sides_alike_the_places_are_alike():
    found = nearest(lambda x: softening(x) + np.sign(x) * np.maximum(np.abs(x) - 0.6, 0.0))
    assert found.law == "softening-stiffness"
    assert found.high == -found.low == pytest.approx(0.6, abs=0.5 * SPACING)
    assert (found.below, found.above) == ("more", "more")


def test_the_negative_side_alone():
    found = nearest(lambda x: softening(x) + 0.5 * np.maximum(-x - 0.5, 0.0))
    assert (found.law, found.below, found.above) == ("softening-stiffness", "less", "")
    assert found.low == pytest.approx(-0.5, abs=0.5 * SPACING)


@pytest.mark.parametrize(
    ("function", "law"),
    [
        (lambda x: x + 0.2 * x**3, ""),
        (lambda x: x + 0.2 * x**2, "quadratic-stiffness"),
        (lambda x: x + 0.2 * x**5, "quintic-stiffness"),
        (lambda x: x + 2.0 * np.maximum(x - 0.5, 0.0), "one-sided-stop"),
        (lambda x: x + 0.2 * np.sign(x) * np.maximum(np.abs(x) - 0.3, 0.0), "clearance"),
    ],
    ids=["cubic", "quadratic", "quintic", "stop", "clearance"],
)
def test_other_laws_are_known(function, law):
    found = nearest(function)
    assert found.law == law
    assert found.whole


def test_where_eq17_is_enough_up_to_a_place_no_law_is_named():
    found = nearest(lambda x: x + 3 * np.sign(x) * np.maximum(np.abs(x) - 0.5, 0.0) ** 2)
    assert found.law == ""
    assert found.parameters == {}
    assert found.high == -found.low == pytest.approx(0.5, abs=SPACING)
    assert found.above == "more"


def test_a_resistance_and_a_damping_over_the_place():
    drag = replace(learnt(lambda v: v + 0.5 * v * np.abs(v)), effect="free/damping")
    found = nearest_law(drag, "mm")
    assert found is not None
    assert (found.law, found.whole) == ("quadratic-drag", True)
    assert found.parameters["coefficient"].value == pytest.approx(0.5, abs=0.02)
    assert found.parameters["coefficient"].unit == "1/mm"


def test_a_damping_over_the_place():
    film = learnt(lambda x: 1.0 + 0.5 * x**2, noise=20.0, basis=shapes)
    found = nearest_law(replace(film, effect="free/surface"), "m")
    assert found is not None
    assert (found.law, found.whole) == ("displacement-dependent-damping", True)
    assert found.parameters["coefficient"].value == pytest.approx(0.5, abs=0.01)
    even = learnt(lambda x: 1.0 + 0.5 * np.maximum(x - 0.3, 0.0), noise=20.0, basis=shapes)
    found = nearest_law(replace(even, effect="free/surface"), "m")
    assert found is not None
    assert (found.law, found.below, found.above) == ("", "", "more")
    assert found.high == pytest.approx(0.3, abs=SPACING)


def test_a_shape_that_no_law_has_is_not_named_as_one_over_all():
    found = nearest_law(learnt(lambda x: x + 0.08 * np.exp(-(((x - 0.4) / 0.2) ** 2))), "m")
    assert found is None or not found.whole


def test_the_whitener_takes_of_a_bend_what_the_fit_did():
    """The fit to a bend rings about it where the motion was: of a known truth less is left than chance leaves."""

    def bent(x: np.ndarray) -> np.ndarray:
        return x + np.sign(x) * np.maximum(np.abs(x) - 0.6, 0.0)

    curve = learnt(bent)
    plain = whitener_of(curve.covariance)
    whitener = _as_recorded(curve.at, plain)
    left, before = (float(np.sum((each @ (curve.value - bent(curve.at))) ** 2)) for each in (whitener, plain))
    assert left < 24.0 < before  # 95 % of what chance leaves in 14 coordinates
    assert whitener @ curve.covariance @ whitener.T == pytest.approx(np.eye(14), abs=1e-6)
