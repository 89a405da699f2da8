"""Learnt curves: what they can be, what they store, that finer ones are the same, and a straight line beyond."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from dashpot.model.law import Motion
from dashpot.model.laws.free_curves import FINENESS, LAWS, heights
from dashpot.model.library import find

REACH = 1.7


def drawn(name: str, seed: int = 1) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    return {p.name: float(rng.normal()) if p.strength else REACH for p in find(name).parameters}


def force_of(name: str, values: dict[str, float]) -> ca.Function:
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    made = find(name).force
    assert made is not None
    return ca.Function("force", [x, v], [made(Motion(x, v, ca.SX.sym("t")), values)])


def test_each_is_an_effect_of_its_own_with_finer_ones():
    assert list(dict.fromkeys(law.effect for law in LAWS)) == ["free/spring", "free/damping", "free/surface"]
    coarse, fine = FINENESS
    for law in LAWS:
        assert law.learnt
        assert all(p.strength or p.scale for p in law.parameters)
        assert law.finer == (f"{law.effect}/{fine}" if law.name.endswith(f"/{coarse}") else None)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_nothing_at_rest_and_no_straight_line_of_eq_17(law):
    """Value and slope at zero are those that omega0, viscous and, of a damping over the place, viscous again have."""
    force = force_of(law.name, drawn(law.name))
    step = 1e-5
    assert float(force(0.0, 0.0)) == pytest.approx(0.0, abs=1e-14)
    place, speed = (step, 0.0) if law.effect == "free/spring" else (0.0, step)
    assert float(force(place, speed)) / step == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_straight_line_beyond(law):
    """One spacing beyond the last knot a spring and a resistance have no bend, a damping over the place no slope."""
    force = force_of(law.name, drawn(law.name))
    at = np.linspace(1.5, 3.0, 7) * REACH
    for side in (1.0, -1.0):
        value = [float(force(side * q, 1.0) if law.effect != "free/damping" else force(0.0, side * q)) for q in at]
        bend = np.diff(value, 2) if law.effect != "free/surface" else np.diff(value)
        assert np.max(np.abs(bend)) < 1e-11 * np.max(np.abs(value))


def test_a_cubic_beside_it_makes_any_cubic_spline():
    """Eq. 17's straight line and cubic with the heights at all knots but one are all splines on these knots."""
    names = [p.name for p in find("free/spring/6").parameters if p.strength]
    x = np.linspace(-REACH, REACH, 200)
    unit = {name: np.eye(len(names))[i] for i, name in enumerate(names)}
    columns = [x, x**3]
    for name in names:
        values = {other: float(unit[name][i]) for i, other in enumerate(names)} | {"reach": REACH}
        force = force_of("free/spring/6", values)
        columns.append(np.array([float(force(q, 0.0)) for q in x]))
    basis = np.column_stack(columns)
    assert np.linalg.matrix_rank(basis / np.linalg.norm(basis, axis=0), tol=1e-8) == len(names) + 2
    knot = REACH / 3
    spline = np.maximum(x - knot, 0.0) ** 3 - 0.4 * np.maximum(x + knot, 0.0) ** 3 + 0.2 * np.maximum(x, 0.0) ** 3
    wanted = spline - spline[np.argmin(np.abs(x))]
    constant = np.column_stack([basis, np.ones(x.size)])
    left = wanted - constant @ np.linalg.lstsq(constant, wanted, rcond=None)[0]
    assert np.max(np.abs(left)) < 1e-9


@pytest.mark.parametrize("effect", ["free/spring", "free/damping", "free/surface"])
def test_a_finer_one_is_the_same_curve(effect):
    coarse, fine = (f"{effect}/{n}" for n in FINENESS)
    values = drawn(coarse)
    finer = [p.name for p in find(fine).parameters if p.strength]
    same = {p.name: REACH for p in find(fine).parameters} | dict(zip(finer, heights(values), strict=True))
    one, other = force_of(coarse, values), force_of(fine, same)
    for q in np.linspace(-REACH, REACH, 23):
        assert float(other(q, 0.8 * q)) == pytest.approx(float(one(q, 0.8 * q)), abs=1e-13)


@pytest.mark.parametrize("name", [law.name for law in LAWS if law.effect == "free/spring"])
def test_what_a_spring_stores_is_the_work_done_on_it(name):
    law, values = find(name), drawn(name, 3)
    x = ca.SX.sym("x")
    motion = Motion(x, ca.SX.sym("v"), ca.SX.sym("t"))
    assert law.force is not None
    assert law.stored is not None
    gap = ca.Function("gap", [x], [ca.gradient(law.stored(motion, values), x) - law.force(motion, values)])
    assert max(abs(float(gap(place))) for place in (-3.0, -0.2, 0.01, 0.5, 4.0)) < 1e-11
