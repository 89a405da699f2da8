"""The model as plain Python: CasADi's numbers for every law, of lists and arrays of whichever package; the C's too."""

from __future__ import annotations

import ast
import ctypes
import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from dashpot.export import export
from dashpot.export.facts import Facts
from dashpot.export.plain_c import export_plain_c
from dashpot.export.program import program
from dashpot.export.python_source import python_source
from dashpot.model.laws import LIBRARY
from dashpot.simulate.compiler import find_compiler
from written import expected, of_model, points, same

BY_PACKAGE = Path(__file__).parent / "reading" / "by_package.py"
CALLS = {"exact": "xdot", "smooth": "xdot_smooth", "output": "output"}


def loaded(model) -> ModuleType:
    text = python_source(program(Facts(model)), "rig")
    module = ModuleType("rig")
    exec(compile(text, "rig.py", "exec"), module.__dict__)
    return module


@pytest.mark.parametrize("effect", LIBRARY)
def test_every_law_has_the_numbers_of_casadi(with_law, effect):
    model = with_law(effect)
    rig, (of, p) = loaded(model), of_model(model)
    given = points(model)
    states, forces, times = np.array([z for z, _, _ in given]).T, *np.array([(u, t) for _, u, t in given]).T
    for name, wanted in expected(of, given, p).items():
        call = getattr(rig, CALLS[name])
        same(call(states, forces, None, times).T, wanted)  # all at once
        same([call(z, u, None, t) for z, u, t in given], wanted)  # one by one
        same([call(list(map(float, z)), u, None, t) for z, u, t in given], wanted)  # numbers alone


@pytest.mark.parametrize("part_of_library", range(4))
def test_every_law_has_the_numbers_of_the_c(with_law, tmp_path, part_of_library):
    compiler = find_compiler()
    if compiler is None:
        pytest.skip("there is no C compiler")
    models = {f"rig{i}": with_law(effect) for i, effect in enumerate(list(LIBRARY)[part_of_library::4])}
    for name, model in models.items():
        export_plain_c(replace(model, name=name), tmp_path / f"{name}.c")
    build = [compiler, "-O1", "-std=c99", "-shared", "-fPIC", *(f"{name}.c" for name in models), "-o", "all.so", "-lm"]
    subprocess.run(build, cwd=tmp_path, check=True)
    c = ctypes.CDLL(str(tmp_path / "all.so"))
    for name, model in models.items():
        rig, follows = loaded(model), of_model(model)[0].follows
        start_at, step, outputs = (getattr(c, f"{name}_{call}") for call in ("start", "step", "outputs"))
        room, out, rows, wanted = (ctypes.c_double * 400)(), (ctypes.c_double * 4)(), [], []
        for z, u, t in points(model):
            start = [value - (z[follows[i]] if follows[i] is not None else 0.0) for i, value in enumerate(z)]
            start_at(room, None, (ctypes.c_double * z.size)(*start), ctypes.c_double(t))
            # a step of no length lets the engine see the force before it is asked for its outputs
            step(room, ctypes.c_double(u), ctypes.c_double(u), ctypes.c_double(0.0))
            outputs(room, ctypes.c_double(u), out)
            rows.append(rig.output(z, u, None, t))
            wanted.append(list(out))
        same(rows, np.array(wanted))


@pytest.mark.parametrize("package", ["array_api_strict", "jax.numpy", "torch"])
@pytest.mark.parametrize(
    "effect", ["quadratic-drag", "one-sided-stop", "hysteresis", "actuator-saturation", "stribeck"]
)
def test_arrays_of_other_packages(with_law, tmp_path, package, effect):
    if find_spec(package.partition(".")[0]) is None:
        pytest.skip(f"{package} is not installed")
    model = with_law(effect)
    of, p = of_model(model)
    export(model, tmp_path / "rig.py")
    given = points(model)
    at = [2e-3, 0.1, *[0.0] * (len(of.states) - 2)]
    asked = {
        "states": np.array([z for z, _, _ in given]).T.tolist(),
        "forces": [u for _, u, _ in given],
        "parameters": {"dry": model.dry.value},
        "time": 0.3,
        "at": at,
    }
    script = [sys.executable, str(BY_PACKAGE), package, str(tmp_path)]
    run = subprocess.run(script, input=json.dumps(asked), capture_output=True, text=True, check=True)
    found = json.loads(run.stdout)
    for name, wanted in expected(of, [(z, u, 0.3) for z, u, _ in given], p).items():
        same(np.array(found[CALLS[name]]).T, wanted)
    if package == "jax.numpy":
        rig = loaded(model)
        assert found["compiled"] == pytest.approx(rig.xdot(at, 0.5), rel=1e-12)
        assert found["derivatives"]["dry"] == pytest.approx(
            (rig.xdot(at, 0.5)[1] - rig.xdot(at, 0.5, {"dry": 0.0})[1]) / model.dry.value
        )
        step = 1e-7
        ahead, behind = (rig.xdot_smooth([at[0] + way, *at[1:]], 0.5) for way in (step, -step))
        slope = (np.array(ahead) - np.array(behind)) / 2 / step
        assert np.array(found["derivatives"]["state"])[:, 0] == pytest.approx(slope, rel=1e-4, abs=1e-4)


def test_parameters_go_by_name_and_may_be_arrays(models):
    rig = loaded(models["drag"]())
    x, drags = np.array([1e-3, 0.2]), np.array([0.0, 3.0, 6.0])
    together = rig.xdot(x[:, None], 0.1, {"quadratic-drag.coefficient": drags})
    assert together.shape == (2, 3)
    for i, drag in enumerate(drags):
        assert together[:, i] == pytest.approx(rig.xdot(x, 0.1, {"quadratic-drag.coefficient": drag}), rel=1e-15)
    assert together[1, 1] == pytest.approx(rig.xdot(x, 0.1)[1], rel=1e-15)
    assert np.diff(together[1]) == pytest.approx([-3 * 0.2**2] * 2, rel=1e-9)


def test_friction_holds_the_mass_and_lets_it_go(models):
    model = models["base"]()
    rig, most = loaded(model), model.values()["mass"] * (model.dry.value + model.preload.value)
    assert rig.xdot([0.0, 0.0], 0.99 * most) == [0.0, 0.0]
    assert rig.xdot([0.0, 0.0], 1.01 * most)[1] == pytest.approx(0.01 * most / model.values()["mass"])
    assert rig.output([0.0, 0.0], 0.99 * most)[3] == pytest.approx(0.0, abs=1e-15)


def test_what_is_wrong_is_said(models):
    rig = loaded(models["base"]())
    with pytest.raises(KeyError, match="no parameter 'drye'; there are mass, omega0"):
        rig.xdot([0.0, 0.0], 0.0, {"drye": 1.0})
    with pytest.raises(ValueError, match="x has 3 states; give 2: displacement, velocity"):
        rig.xdot([0.0, 0.0, 0.0])
    with pytest.raises(TypeError, match="a str is no array"):
        rig.xdot(["a", "b"])


def test_it_needs_nothing_but_the_standard_library_and_is_the_same_every_time(models, with_law, tmp_path):
    model = with_law("hysteresis", "attached-resonator")
    (path,) = export(model, tmp_path / "rig.py")
    text = path.read_text(encoding="ascii")
    assert text == python_source(program(Facts(model)), "rig")
    tree = ast.parse(text)
    assert {a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names} == {"math", "sys"}
    said = ast.get_docstring(tree)
    assert said is not None
    assert "Inner states" in said
    code = "import rig; x = rig.initial(1e-3); print(len(x), rig.xdot(x)[0], *sorted(rig.STATES))"
    run = [sys.executable, "-S", "-I", "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {code}"]
    said = subprocess.run(run, capture_output=True, text=True, check=True).stdout.split()
    assert said[:2] == ["5", "0.0"]


@pytest.mark.parametrize("name", ['"""; import os', "a\\", "Prüfstand №5\n", "{{ 7*7 }}", "'''"])
def test_names_of_any_kind_stay_words(models, name):
    rig = loaded(replace(models["base"](), name=name))
    assert rig.xdot([1e-3, 0.0])[0] == 0.0


def test_the_block_of_its_page_runs(tmp_path):
    page = (Path(__file__).resolve().parents[2] / "docs/programs.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    run = subprocess.run([sys.executable, "-P", "-c", block], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert len(run.stdout.splitlines()) == 3


def test_a_solver_takes_it(models, tmp_path: Path):
    """Free vibration by scipy with the smooth signs, against the engine."""
    from dashpot.simulate.core import core_of
    from scipy.integrate import solve_ivp

    model = models["base"]()
    rig, facts = loaded(model), Facts(model)
    run = solve_ivp(lambda t, x: rig.xdot_smooth(x), (0.0, 0.4), rig.initial(5e-3), rtol=1e-9, atol=1e-12)
    p = np.array(list(facts.values.values()))
    exact = core_of(model).record(p, np.array([5e-3, 0.0]), None, 401, 1e-3, facts.max_step)[-1]
    assert run.y[0, -1] == pytest.approx(exact, abs=2e-3 * 5e-3)
