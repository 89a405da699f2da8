"""From a learnt curve to its closed form and to a law file: truth by least squares on known functions."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from dashpot.model import Oscillator, Parameter
from dashpot.model.formula.atoms import ATOMS
from dashpot.model.formula.closed_form import ClosedForm, closed_forms, law_file
from dashpot.model.formula.curve import KINDS, LearntCurve, curve_of, learnt_terms
from dashpot.model.formula.search import formulas
from dashpot.model.law import Motion
from dashpot.model.laws.free_curves import Curve
from dashpot.model.oscillator import Provenance
from dashpot.model.terms import with_term
from dashpot.model.user_laws import load_law_file

NAMES = [f"at-{k + 1}" for k in range(12)]
NOISE, SAMPLES = 2e-3, 4000


def columns(x: np.ndarray) -> np.ndarray:
    """(n, 14) straight line, cubic and the learnt spring's heights, over a reach of one."""
    q, heights = ca.SX.sym("q"), [ca.SX.sym(name) for name in NAMES]
    made = Curve(12, NAMES, 2).at(q, dict(zip(NAMES, heights, strict=True)))
    slopes = ca.Function("slopes", [q], [ca.jacobian(made, ca.vertcat(*heights)).T])
    each = np.array(slopes.map(x.size)(x[None])).reshape(len(NAMES), x.size, order="F").T
    return np.column_stack([x, x**3, each])


@pytest.fixture(scope="module")
def points() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    x = np.sin(rng.uniform(0, 2 * np.pi, SAMPLES)) * rng.uniform(0, 1, SAMPLES)
    return x, columns(x), NOISE * rng.standard_normal(SAMPLES)


def fitted(points, function) -> tuple[np.ndarray, np.ndarray]:
    """Least squares of a force over the points: coefficients and their covariance."""
    x, basis, noise = points
    covariance = np.linalg.inv(basis.T @ basis) * NOISE**2
    return covariance @ (basis.T @ (function(x) + noise)) / NOISE**2, covariance


def learnt(points, function) -> LearntCurve:
    values, covariance = fitted(points, function)
    at = np.linspace(-1.0, 1.0, 121)
    basis = columns(at)
    return LearntCurve("free/spring", at, basis @ values, basis @ covariance @ basis.T)


@pytest.mark.parametrize(
    ("function", "pieces"),
    [
        (lambda x: x + 0.3 * np.tanh(x / 0.3), {"tanh": 0.3}),
        (lambda x: x + 0.1 * np.expm1(x / 0.5), {"exponential": 0.5}),
        (lambda x: x + 0.1 * np.sin(x / 0.25) + 0.1 * x**2, {"sine": 0.25, "square": 0.0}),
        (lambda x: x + 0.2 * x**2 + 0.1 * x**3, {"square": 0.0, "cube": 0.0}),
    ],
    ids=["tanh", "exponential", "sine and square", "square and cube"],
)
def test_the_form_that_a_curve_was_made_with_is_the_shortest(points, function, pieces):
    best = formulas(learnt(points, function))[0]
    assert best.within
    assert set(best.pieces) == set(pieces)
    for name, inside in zip(best.pieces, best.inside, strict=True):
        assert inside == pytest.approx(pieces[name], rel=0.01)


def test_a_curve_of_no_form_has_none_within_its_band_that_is_short(points):
    def bumps(x: np.ndarray) -> np.ndarray:
        return x + 0.08 * np.exp(-(((x - 0.4) / 0.2) ** 2)) - 0.06 * np.exp(-(((x + 0.3) / 0.15) ** 2))

    assert not any(form.within for form in formulas(learnt(points, bumps)))


def model_with(values: np.ndarray, covariance: np.ndarray) -> Oscillator:
    """An oscillator with the learnt spring, whose omega0² and cubic stand for the straight line and the cubic."""
    base = {"mass": 2.0, "preload": 0.0, "viscous": 0.1, "dry": 0.0}
    model = Oscillator.from_values(base | {"omega0": float(np.sqrt(values[0])), "cubic": float(values[1])})
    heights = dict(zip(NAMES, map(float, values[2:]), strict=True))
    model = with_term(model, "free/spring/12", heights | {"reach": 1.0})
    names = ("omega0", "cubic", *(f"free/spring/12.{name}" for name in NAMES))
    slope = np.diag([0.5 / np.sqrt(values[0]), *np.ones(values.size - 1)])
    rows = tuple(map(tuple, slope @ covariance @ slope))
    provenance = Provenance(recordings=(), method="", software="", parameters=names, covariance=rows)
    return model.with_provenance(provenance) if hasattr(model, "with_provenance") else _with(model, provenance)


def _with(model: Oscillator, provenance: Provenance) -> Oscillator:
    from dataclasses import replace

    return replace(model, identified=provenance)


def test_a_model_s_curve_is_the_whole_force_and_its_errors_those_of_the_covariance(points):
    function = lambda x: x + 0.3 * np.tanh(x / 0.3)  # noqa: E731
    model = model_with(*fitted(points, function))
    (term,) = learnt_terms(model)
    curve, direct = curve_of(model, term), learnt(points, function)
    assert curve.value == pytest.approx(direct.value, rel=1e-9)
    assert curve.std == pytest.approx(direct.std, rel=1e-6)
    (form, *_) = closed_forms(model)
    assert form.text == "c0 x + c1 tanh(x/a1)"
    assert {name: p.unit for name, p in form.constants.items()} == {"c0": "1/s2", "c1": "m/s2", "a1": "m"}
    for name, true in (("c0", 1.0), ("c1", 0.3), ("a1", 0.3)):
        parameter = form.constants[name]
        assert parameter.std is not None
        assert abs(parameter.value - true) < 3 * parameter.std < 0.02
    assert form.at(curve.at) == pytest.approx(function(curve.at), abs=0.002)


@pytest.mark.usefixtures("library")
@pytest.mark.parametrize("piece", ATOMS)
@pytest.mark.parametrize("effect", KINDS)
def test_each_piece_makes_a_law_file_that_loads_and_is_the_piece(tmp_path: Path, piece, effect):
    constants = {"c0": Parameter(1.0, 0.1, "1/s2"), "c1": Parameter(0.7, 0.1, "1"), "a1": Parameter(0.3, 0.1, "m")}
    form, kind = ClosedForm(effect, (piece,), constants, True, 0.0, 1.0), KINDS[effect]
    name = f"learnt-{piece}-{effect.partition('/')[2]}"
    file = tmp_path / f"{name}.py"
    file.write_text(law_file(form, name), encoding="utf-8")
    (law,) = load_law_file(file)
    x, v, t, a = (ca.SX.sym(symbol) for symbol in "xvta")
    motion = Motion(x, v, t, a=a)
    values = {"c1": 0.7, "a1": 0.3}
    path = law.drive or law.record
    made = path(motion, values, x) - x if path else law.force(motion, values) if law.force else None
    assert made is not None
    energy = None if law.stored is None else law.stored(motion, values)
    signs = ca.vertcat(*motion.signs) if motion.signs else ca.SX(0, 1)
    surfaces = ca.vertcat(*motion.surfaces) if motion.surfaces else ca.SX(0, 1)
    at = ca.Function("surfaces", [x, v], [surfaces])
    wanted_energy = None
    if kind.times == "x''":  # what its energy grows by, by Lagrange, at an acceleration of one
        momentum = ca.gradient(energy, v)
        wanted_energy = ca.jacobian(momentum, x) * v + ca.jacobian(momentum, v) - ca.gradient(energy, x)
    made = ca.substitute(made, a, 1)
    force = ca.Function("force", [x, v, signs], [made])
    for place in (-0.9, -0.31, -0.05, 0.12, 0.5, 0.8):
        speed = place if kind.variable == "v" else 0.6 * place
        here = np.sign(np.array(at(place, speed))).ravel()
        wanted = 0.7 * ATOMS[piece].values(np.array([place if kind.variable != "v" else speed]), 0.3)[0]
        if wanted_energy is not None:
            balance = ca.Function("balance", [x, v, signs], [wanted_energy - made])
            assert float(balance(place, speed, here)) == pytest.approx(0.0, abs=1e-12)
            assert float(force(place, 0.0, here)) == pytest.approx(wanted, rel=1e-12, abs=1e-14)
            continue
        wanted *= speed if kind.times == "v" else 1.0
        assert float(force(place, speed, here)) == pytest.approx(wanted, rel=1e-11, abs=1e-14)
        if energy is not None:
            slope = ca.Function("slope", [x, v, signs], [ca.gradient(energy, x)])
            assert float(slope(place, speed, here)) == pytest.approx(wanted, rel=1e-10, abs=1e-13)
    assert (law.stored is not None) == (effect in ("free/spring", "free/inertia"))
