"""The model as a MATLAB function: read as its assignments and run under GNU Octave, CasADi's numbers for every law."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export import export
from dashpot.export.facts import Facts
from dashpot.export.matlab import matlab_function
from dashpot.export.program import program
from dashpot.model.laws import LIBRARY
from written import expected, of_model, points, same

#: Operators of MATLAB and what Python has for them.
SPELT = ((".*", "*"), ("./", "/"), (".^", "**"), ("~=", "!="), ("...", ""), ("not(", "not_("), ("and(", "and_("))
CALLS = {
    "abs": abs, "sign": lambda a: (a > 0) - (a < 0), "max": max, "min": min, "double": float, "Inf": math.inf,
    "sqrt": math.sqrt, "exp": math.exp, "sin": math.sin, "cos": math.cos, "tanh": math.tanh,
    "not_": lambda a: not a, "and_": lambda a, b: a and b, "or_": lambda a, b: a or b,
    "choose": lambda c, a, b: a if c else b,
}  # fmt: skip
FUNCTIONS = {"exact": "exact_rates", "smooth": "smooth_rates", "output": "outputs"}


def part(text: str, name: str) -> str:
    """The lines of one function of a file, from its head to its end."""
    found = re.search(rf"^function \w+ = {name}\(.*?\)\n(.*?)^end$", text, re.MULTILINE | re.DOTALL)
    assert found
    return found[1]


def evaluated(text: str, name: str, z, u: float, t: float, q: dict[str, float]) -> list[float]:
    """What a function of the file gives, its assignments read as Python."""
    known = {**CALLS, "F": u, "t": t, "zero": 0.0}
    body, (result,) = part(text, name).split("    r = [")[0], re.findall(r"r = \[(.*?)\];", part(text, name), re.DOTALL)
    for line in body.strip().splitlines():
        target, value = re.fullmatch(r" *(\w+) = (.*);", line).groups()
        if place := re.fullmatch(r"zero \+ x\((\d+), :\)", value):
            known[target] = float(z[int(place[1]) - 1])
        elif field := re.fullmatch(r"q\.(\w+)", value):
            known[target] = q[field[1]]
        else:
            known[target] = eval(in_python(value), known)
    return [eval(in_python(row), known) for row in result.split(";") if row.strip(" .\n")]


def in_python(text: str) -> str:
    for theirs, ours in (*SPELT, ("or(", "or_(")):
        text = text.replace(theirs, ours)
    return text.strip()


@pytest.mark.parametrize("part_of_library", range(6))
def test_every_law_has_the_numbers_of_casadi(with_law, part_of_library):
    for effect in list(LIBRARY)[part_of_library::6]:
        model = with_law(effect)
        of, p = of_model(model)
        text = matlab_function(of, "rig")
        stated = {k: float(v) for k, v in re.findall(r"q\.(\w+) = (\S+);", part(text, "identified"))}
        assert list(stated.values()) == p
        given = points(model)
        for name, wanted in expected(of, given, p).items():
            same([evaluated(text, FUNCTIONS[name], z, u, t, stated) for z, u, t in given], wanted)


@pytest.fixture(scope="module")
def octave() -> str:
    found = shutil.which("octave-cli")
    if found is None:
        pytest.skip("GNU Octave is not installed")
    return found


def said(octave: str, folder: Path, code: str) -> list[str]:
    """What a program prints, line by line."""
    run = subprocess.run(
        [octave, "--no-gui", "--quiet", "--norc"], input=code, cwd=folder, capture_output=True, text=True, check=True
    )
    # what Octave says of its own end where there is no terminal
    assert [line for line in run.stderr.splitlines() if "while preparing to exit" not in line] == []
    return run.stdout.splitlines()


def matrix(values: np.ndarray) -> str:
    return "[" + "; ".join(" ".join(repr(float(v)) for v in row) for row in np.atleast_2d(values)) + "]"


@pytest.mark.parametrize("part_of_library", range(4))
def test_octave_gives_casadi_s_numbers_for_every_law(with_law, octave, tmp_path, part_of_library):
    code, wanted = "", []
    for i, effect in enumerate(list(LIBRARY)[part_of_library::4]):
        model = with_law(effect)
        of, p = of_model(model)
        export(model, tmp_path / f"rig{i}.m")
        given = points(model)
        z, u, t = np.array([z for z, _, _ in given]).T, *np.array([(u, t) for _, u, t in given]).T
        code += f"z = {matrix(z)}; u = {matrix(u)}; t = {matrix(t)};\n"
        code += f"[s, y] = rig{i}(t, z, u); e = rig{i}(t, z, u, [], true);\n"
        code += "printf('%.17g ', e, s, y); printf('\\n');\n"
        wanted.append(expected(of, given, p))
    for line, functions in zip(said(octave, tmp_path, code), wanted, strict=True):
        numbers = np.array(line.split(), float)
        for name in ("exact", "smooth", "output"):
            here, numbers = np.split(numbers, [functions[name].size])
            same(here.reshape(functions[name].shape), functions[name])


def test_octave_s_ode45_runs_it(models, octave, tmp_path):
    """A free decay of the stand, against the engine; a force as a function; parameters by name; refusals in words."""
    from dashpot.simulate.core import core_of

    model = models["base"]()
    export(model, tmp_path / "rig.m")
    facts = Facts(model)
    p = np.array(list(facts.values.values()))
    exact = core_of(model).record(p, np.array([5e-3, 0.0]), None, 201, 1e-3, facts.max_step)[-1]
    code = """
    [t, x] = ode45(@(t, x) rig(t, x), [0 0.2], rig('start', 5e-3, 0), odeset('RelTol', 1e-8, 'AbsTol', 1e-11));
    printf('%.17g\\n', x(end, 1));
    a = rig(0, [1e-3; 0.1], @(t) 0.5 + t, struct('viscous', 0)); printf('%.17g\\n', a(2));
    b = rig(0, [1e-3; 0.1], 0.5); printf('%.17g\\n', a(2) - b(2) - 0.1 * rig('parameters').viscous);
    try, rig(0, [1; 2], 0, struct('drye', 1)), catch e, disp(e.message), end
    try, rig(0, [1; 2; 3]), catch e, disp(e.message), end
    """
    end, _, difference, unknown, rows = said(octave, tmp_path, code)
    assert float(end) == pytest.approx(exact, abs=2e-3 * 5e-3)
    assert float(difference) == pytest.approx(0.0, abs=1e-12)
    assert unknown == "rig: no parameter drye; there are mass, omega0, cubic, preload, viscous, dry"
    assert rows == "rig: x has 3 rows; give 2 states"


def test_a_name_that_is_no_function_s_is_refused(models, tmp_path):
    for name in ("rig-2.m", "2rig.m", "end.m", ".m"):
        with pytest.raises(BadInput, match=r"MATLAB takes the name|cannot tell what to make"):
            export(models["base"](), tmp_path / name)
        assert not (tmp_path / name).exists()


@pytest.mark.parametrize("name", ["%{\n", "'; system('x'); '", "...", "a\\n%s"])
def test_names_of_any_kind_stay_comments(models, name):
    text = matlab_function(program(Facts(replace(models["base"](), name=name))), "rig")
    code = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("%")]
    plain = matlab_function(program(Facts(replace(models["base"](), name="x"))), "rig")
    assert code == [line for line in plain.splitlines() if line.strip() and not line.lstrip().startswith("%")]
    assert not re.search(r"^%[{}]", text, re.MULTILINE)
