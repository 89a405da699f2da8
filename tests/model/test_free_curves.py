"""Learnt curves: what they can be, what they store, that finer ones are the same, and a straight line beyond."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from dashpot.model.equations import equations
from dashpot.model.law import Motion
from dashpot.model.laws.free_curves import FINENESS, LAWS, heights
from dashpot.model.library import find
from scipy.integrate import solve_ivp

REACH = 1.7
EFFECTS = ["free/spring", "free/damping", "free/surface", "free/inertia", "free/drive", "free/sensor"]


def drawn(name: str, seed: int = 1) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    return {p.name: float(rng.normal()) if p.strength else REACH for p in find(name).parameters}


def force_of(name: str, values: dict[str, float], a: float = 0.0) -> ca.Function:
    """Force over x and v; of a map what it adds to a signal x."""
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    law, motion = find(name), Motion(x, v, ca.SX.sym("t"), a=a)
    path = law.drive or law.record
    made = path(motion, values, x) - x if path else law.force(motion, values) if law.force else None
    assert made is not None
    return ca.Function("force", [x, v], [made])


def test_each_is_an_effect_of_its_own_with_finer_ones():
    assert list(dict.fromkeys(law.effect for law in LAWS)) == EFFECTS
    coarse, fine = FINENESS
    for law in LAWS:
        assert law.learnt
        assert all(p.strength or p.scale for p in law.parameters)
        assert law.finer == (f"{law.effect}/{fine}" if law.name.endswith(f"/{coarse}") else None)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_nothing_at_rest_and_no_straight_line_of_eq_17(law):
    """Value and slope at zero are those that omega0, viscous, mass and, of a damping over the place, viscous have."""
    force = force_of(law.name, drawn(law.name), a=1.0)
    step = 1e-5
    assert float(force(0.0, 0.0)) == pytest.approx(0.0, abs=1e-14)
    place, speed = (0.0, step) if law.effect in ("free/damping", "free/surface", "free/inertia") else (step, 0.0)
    assert float(force(place, speed)) / step == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_straight_line_beyond(law):
    """One spacing beyond the last knot most have no bend, a damping over the place and a mass no slope."""
    values = {name: 0.1 * value if name != "reach" else value for name, value in drawn(law.name).items()}
    force, level = force_of(law.name, values, a=1.0), law.effect in ("free/surface", "free/inertia")
    at = np.linspace(1.5, 3.0, 7) * REACH
    for side in (1.0, -1.0):
        value = [float(force(side * q, 1.0) if law.effect != "free/damping" else force(0.0, side * q)) for q in at]
        bend = np.diff(value) if level else np.diff(value, 2)
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


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_finer_one_is_the_same_curve(effect):
    coarse, fine = (f"{effect}/{n}" for n in FINENESS)
    values = drawn(coarse)
    finer = [p.name for p in find(fine).parameters if p.strength]
    same = {p.name: REACH for p in find(fine).parameters} | dict(zip(finer, heights(values), strict=True))
    one, other = force_of(coarse, values, a=0.7), force_of(fine, same, a=0.7)
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


def test_a_mass_takes_what_its_energy_grows_by_and_is_never_less_than_a_tenth():
    """Lagrange: d/dt of the kinetic energy's slope in the speed, less its slope in the place."""
    law, values = find("free/inertia/6"), drawn("free/inertia/6", 5)
    x, v, a = ca.SX.sym("x"), ca.SX.sym("v"), ca.SX.sym("a")
    motion = Motion(x, v, ca.SX.sym("t"), a=a)
    assert law.force is not None
    assert law.stored is not None
    energy = law.stored(motion, values)
    momentum = ca.gradient(energy, v)
    wanted = ca.jacobian(momentum, x) * v + ca.jacobian(momentum, v) * a - ca.gradient(energy, x)
    gap = ca.Function("gap", [x, v, a], [wanted - law.force(motion, values)])
    for place in (-3.0, -0.9, -0.2, 0.01, 0.5, 1.6, 4.0):
        assert abs(float(gap(place, 1.3, -0.8))) < 1e-12
    heavy = ca.Function("mass", [x], [law.force(Motion(x, 0.0, 0.0, a=1.0), {**values, "at-7": -90.0})])
    assert float(heavy(REACH)) == pytest.approx(-0.9)
    assert float(heavy(0.1 * REACH)) > -0.9


def test_the_energy_of_a_run_with_a_learnt_mass_is_kept(with_law):
    """No damping, no force: m(x) x'^2 / 2 and the spring's energy stay, in the equations that all renderings have."""
    own = {f"free/inertia/6.{name}": value for name, value in drawn("free/inertia/6", 5).items()}
    own["free/inertia/6.reach"] = 8e-3
    model = with_law("free/inertia/6", dry=0.0, viscous=0.0, preload=0.0, **own)
    eq = equations(model)
    p = ca.DM(list(model.values().values()))
    made = ca.substitute([eq.zdot, eq.energy], [eq.t, eq.u, eq.u_rate, eq.p], [0, 0, 0, p])
    made = [ca.substitute(part, eq.s, ca.DM.ones(eq.s.numel(), 1)) for part in made]
    field, energy = ca.Function("field", [eq.z], [made[0]]), ca.Function("energy", [eq.z], [made[1]])
    run = solve_ivp(lambda t, z: np.array(field(z)).ravel(), (0, 0.3), [7e-3, 0.0], rtol=1e-10, atol=1e-13)
    kept = np.array(energy(run.y)).ravel()
    assert np.ptp(kept) < 1e-6 * kept[0]
    moving = ca.Function("moving", [eq.z], [ca.substitute(eq.moving, eq.p, p)])
    assert float(np.ptp(np.array(moving(run.y)))) > 0.05
