"""The CasADi files: loaded by casadi alone, right in value, described beside."""

from __future__ import annotations

import ctypes
import json
import subprocess
import sys
from pathlib import Path

import casadi
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.export import export
from dashpot.export.casadi_functions import describe, functions
from dashpot.export.facts import Facts
from dashpot.model import Oscillator, Range
from dashpot.model.equations import equations, signed
from dashpot.model.laws import LIBRARY
from dashpot.simulate.compiler import find_compiler
from dashpot.simulate.core import core_of, internal_step

DT = 1e-3
VALUES = list(TRUTH.values())


@pytest.fixture(scope="module")
def model():
    from dataclasses import replace

    return replace(Oscillator.from_values(TRUTH, name="stand"), amplitude=Range(1e-4, 9e-3, "m"))


@pytest.fixture(scope="module")
def folder(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("casadi")
    export(model, path / "rig.casadi")
    return path


def load(folder, suffix):
    return casadi.Function.load(str(folder / f"rig.{suffix}"))


def test_the_files_are_there_and_nothing_else(folder):
    names = sorted(path.name for path in folder.iterdir())
    suffixes = ("casadi", "casadi.json", "output.casadi", "smooth.casadi", "smooth.step.c", "smooth.step.casadi")
    suffixes += ("smooth.step.h", "step.casadi")
    assert names == [f"rig.{suffix}" for suffix in suffixes]


def test_casadi_alone_loads_and_runs_them(folder):
    program = (
        "import casadi, sys\n"
        "f = casadi.Function.load('rig.casadi')\n"
        "assert not any(name.startswith('dashpot') for name in sys.modules)\n"
        "print(float(f(x=[1e-3, 0.1], u=0.5)['xdot'][1]))"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=True)
    x, v, u = 1e-3, 0.1, 0.5
    inner = TRUTH["omega0"] ** 2 * x + TRUTH["cubic"] * x**3 + TRUTH["preload"] + TRUTH["viscous"] * v + TRUTH["dry"]
    assert float(run.stdout) == pytest.approx(u / TRUTH["mass"] - inner, rel=1e-12)


@pytest.mark.parametrize("suffix", ["casadi", "step.casadi", "output.casadi", "smooth.casadi", "smooth.step.casadi"])
def test_inputs_and_outputs_are_named_and_the_identified_values_are_the_default(folder, suffix):
    f = load(folder, suffix)
    assert [f.name_in(i) for i in range(f.n_in())] == ["x", "u", "p"]
    output = "x_next" if "step" in suffix else "y" if "output" in suffix else "xdot"
    assert [f.name_out(i) for i in range(f.n_out())] == [output]
    x, u = [2e-3, -0.1], 0.3
    default = np.array(next(iter(f(x=x, u=u).values()))).ravel()
    assert default == pytest.approx(np.array(f(x, u, VALUES)).ravel(), rel=1e-15)
    heavier = [2 * VALUES[0], *[np.inf] * (len(VALUES) - 1)]  # one parameter set, the rest as identified
    assert np.array(f(x, u, heavier)).ravel() != pytest.approx(default)


@pytest.mark.parametrize("suffix", ["casadi", "smooth.casadi", "smooth.step.casadi"])
def test_derived_functions_without_p_are_those_of_the_identified_values(folder, suffix):
    f, at = load(folder, suffix), {"x": [2e-3, -0.1], "u": 0.3}
    (output,) = f.name_out()
    known, left_out = f.jacobian()(**at, p=VALUES), f.jacobian()(**at)
    for name, value in known.items():  # by x, by u, and by p itself
        assert np.array(left_out[name]) == pytest.approx(np.array(value), rel=1e-12)
        assert np.any(np.array(value))
    without = f.factory("J", ["x", "u"], [f"jac:{output}:x"])
    assert np.array(without(**at)[f"jac_{output}_x"]) == pytest.approx(np.array(known[f"jac_{output}_x"]), rel=1e-12)
    x, u = casadi.MX.sym("x", 2), casadi.MX.sym("u")
    composed = casadi.Function("J", [x, u], [casadi.jacobian(f(x=x, u=u)[output], x)])
    assert np.array(composed(*at.values())) == pytest.approx(np.array(known[f"jac_{output}_x"]), rel=1e-12)
    if "step" in suffix:
        rows, z = np.array(f.mapaccum(3)(x=at["x"], u=np.full((2, 3), 0.3))["x_next"]), at["x"]
        for k in range(3):
            z = f(z, 0.3, VALUES)
            assert rows[:, k] == pytest.approx(np.array(z).ravel(), rel=1e-12)


def test_the_smooth_step_and_its_jacobian_in_c_are_those_of_casadi(folder, tmp_path):
    compiler = find_compiler()
    if compiler is None:
        pytest.skip("there is no C compiler")
    library = tmp_path / "step.so"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC", "-I", str(folder)]
    subprocess.run([compiler, *flags, str(folder / "rig.smooth.step.c"), "-o", str(library), "-lm"], check=True)
    c, step = ctypes.CDLL(str(library)), load(folder, "smooth.step.casadi")
    x, u, p = (ctypes.c_double * 2)(2e-3, -0.1), (ctypes.c_double * 2)(0.3, 0.4), (ctypes.c_double * 6)(*VALUES)
    x_next, a, b = (ctypes.c_double * 2)(), (ctypes.c_double * 4)(), (ctypes.c_double * 4)()
    derivative = step.jacobian()(x=list(x), u=list(u))
    for given in (p, None):
        assert c.stand_smooth_step(x, u, given, x_next) == 0
        assert c.stand_smooth_step_jacobian(x, u, given, a, b) == 0
        assert list(x_next) == pytest.approx(np.array(step(x=list(x), u=list(u))["x_next"]).ravel(), rel=1e-12)
        for got, name in ((a, "x"), (b, "u")):
            wanted = np.array(derivative[f"jac_x_next_{name}"])
            assert np.reshape(list(got), (2, 2), order="F") == pytest.approx(wanted, rel=1e-9)


def test_the_mass_sticks_within_its_friction(folder):
    f = load(folder, "casadi")
    limit = TRUTH["mass"] * (TRUTH["dry"] + TRUTH["preload"])
    assert np.array(f(x=[0, 0], u=0.99 * limit)["xdot"]).ravel() == pytest.approx([0.0, 0.0])
    assert float(f(x=[0, 0], u=1.01 * limit)["xdot"][1]) == pytest.approx(0.01 * limit / TRUTH["mass"])


def test_the_step_is_event_exact(folder, model):
    t = np.arange(3000) * DT
    force = np.sin(2 * np.pi * (8 * t + 2 * t**2))
    core = core_of(model)
    longest = internal_step(model, TRUTH, 9e-3)
    compiled = core.record(np.array(VALUES), np.zeros(2), force, t.size, DT, longest, states=True)
    step, z = load(folder, "step.casadi"), np.zeros(2)
    for i in range(1, t.size):
        z = np.array(step(z, force[i - 1 : i + 1], VALUES)).ravel()
        assert abs(z[0] - compiled[i, 0]) < 1e-6 * 9e-3


def test_the_smooth_law_is_the_exact_one_outside_its_width(folder):
    exact, smooth = load(folder, "casadi"), load(folder, "smooth.casadi")
    for x, v in ((5e-3, 0.3), (-5e-3, 0.3), (2e-3, -0.2)):
        assert np.array(smooth(x=[x, v], u=0.1)["xdot"]) == pytest.approx(np.array(exact(x=[x, v], u=0.1)["xdot"]))
    slope = float(smooth.factory("J", ["x", "u", "p"], ["jac:xdot:x"])(x=[0, 0], u=0)["jac_xdot_x"][1, 0])
    width = 9e-6  # a thousandth of the amplitude
    assert slope == pytest.approx(-(TRUTH["omega0"] ** 2) - TRUTH["preload"] / width, rel=1e-6)


def test_the_smooth_step_follows_the_exact_one(folder):
    exact, smooth = load(folder, "step.casadi"), load(folder, "smooth.step.casadi")
    a = b = np.array([8e-3, 0.0])
    for _ in range(400):
        a = np.array(exact(x=a, u=0.0)["x_next"]).ravel()
        b = np.array(smooth(x=b, u=0.0)["x_next"]).ravel()
        assert abs(a[0] - b[0]) < 1e-3 * 8e-3


def test_names_units_and_errors_stand_beside(folder):
    about = json.loads((folder / "rig.casadi.json").read_text(encoding="utf-8"))
    assert [p["name"] for p in about["p"]] == list(TRUTH)
    assert [p["value"] for p in about["p"]] == VALUES
    assert {p["name"]: p["unit"] for p in about["p"]}["cubic"] == "1/(m2.s2)"
    assert [s["unit"] for s in about["x"]] == ["m", "m/s"]
    (force,) = about["u"]
    assert (force["name"], force["unit"], force["hold"]) == ("F", "N", "smooth")
    assert about["smoothing_width"][0] == {"surface": "x", "width": pytest.approx(9e-6), "unit": "m"}
    assert [(y["name"], y["unit"]) for y in about["y"]][2:] == [("velocity", "m/s"), ("acceleration", "m/s2")]
    assert "t" not in about
    assert set(about["files"]) == {p.name for p in folder.iterdir() if p.suffix == ".casadi"}


def test_without_a_mass_the_input_is_a_force_per_unit_mass(tmp_path):
    values = {name: value for name, value in TRUTH.items() if name != "mass"}
    export(Oscillator.from_values(values), tmp_path / "free.casadi")
    f = casadi.Function.load(str(tmp_path / "free.casadi"))
    assert f.size1_in("p") == 5
    about = json.loads((tmp_path / "free.casadi.json").read_text(encoding="utf-8"))
    assert about["u"][0]["unit"] == "m/s2"


@pytest.mark.parametrize("effect", LIBRARY)
def test_every_law_has_its_functions(effect, with_law):
    """The right-hand side, the output and the smooth law agree where no sign is near its change."""
    model = with_law(effect, dry=0.0, preload=0.0)
    made = functions(Facts(model))
    about = describe(Facts(model), "rig", DT, made)
    eq = equations(model)
    assert [x["name"] for x in about["x"]] == list(eq.state_names)
    assert made.timed == ("t" in about) == effect.startswith("stiffness-drift")
    extra = [0.7] if made.timed else []
    z = np.array([5e-3, 0.3, *(0.4 * SCALES[state.unit] for state in eq.inner)])
    f, smooth, output = (made.by_suffix[name] for name in ("casadi", "smooth.casadi", "output.casadi"))
    p = list(model.values().values())
    expected = np.array(casadi.Function("f", [eq.z, eq.t, eq.u, eq.p], [signed(eq, eq.zdot)])(z, 0.7, 0.5, p)).ravel()
    assert np.array(f(z, 0.5, p, *extra)).ravel() == pytest.approx(expected, rel=1e-9)
    assert np.array(smooth(z, 0.5, p, *extra)).ravel() == pytest.approx(expected, rel=1e-6)
    y = np.array(output(z, 0.5, p, *extra)).ravel()
    assert y[1:] == pytest.approx([z[0], z[1], expected[1]], rel=1e-9)


SCALES = {"X": 5e-3, "X/s": 0.4, "Q": 1e-3, "Y": 5e-3, "rad": 1.0}


@pytest.mark.parametrize("effect", LIBRARY)
def test_the_smooth_step_of_every_law_follows_the_exact_one(effect, with_law):
    model = with_law(effect)
    made = functions(Facts(model)).by_suffix
    step, smooth = made["step.casadi"], made["smooth.step.casadi"]
    eq = equations(model)
    a = b = np.array([6e-3, 0.0, *(6e-3 if leader == 0 else 0.0 for leader in eq.follows[2:])])
    p = list(model.values().values())
    apart = []
    for k in range(150):
        extra = [k * DT] if step.n_in() == 4 else []
        force = 0.5 * np.sin(80 * DT * np.array([k, k + 1]))
        a, b = np.array(step(a, force, p, *extra)).ravel(), np.array(smooth(b, force, p, *extra)).ravel()
        apart.append(abs(a[0] - b[0]))
    assert max(apart) < 5e-3 * 6e-3


def test_a_surface_is_smoothed_in_its_own_size_and_unit(with_law, tmp_path):
    model = with_law("actuator-dead-zone", "hysteresis")
    about = json.loads(Path(export(model, tmp_path / "rig.casadi")[-1]).read_text(encoding="utf-8"))
    width = {row["surface"]: (row["width"], row["unit"]) for row in about["smoothing_width"]}
    limit = model.values()["hysteresis.limit"]
    assert width["hysteresis.deflection"] == (pytest.approx(1e-3 * limit, rel=0.1), "m")
    size, unit = width["(F-actuator-dead-zone.threshold)"]
    assert unit == "N"
    assert size == pytest.approx(1e-3 * 0.27 * (5.0 * 79.6 * 1e-2 + 0.015))  # the force that keeps the motion up


def test_a_law_too_fast_for_the_step_is_refused(with_law):
    with pytest.raises(BadInput, match="choose one below"):
        functions(Facts(with_law("actuator-lag", **{"actuator-lag.time": 1e-8})))
