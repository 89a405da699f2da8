"""The model as plain C: it compiles without a warning, repeats the compiled core, and clashes with nothing."""

from __future__ import annotations

import ctypes
import itertools
import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export.facts import Facts
from dashpot.export.plain_c import export_plain_c, own, plain_c, prefix_of, symbols
from dashpot.export.smoothing import amplitude_of
from dashpot.model import Oscillator, Parameter, Provenance, Range
from dashpot.model.laws import LIBRARY
from dashpot.simulate.compiler import find_compiler
from dashpot.simulate.core import core_of, internal_step

DT, N, START = 1e-3, 400, 0.4
STRICT = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off"]
TIME = np.arange(N) * DT
CHIRP = np.sin(2 * np.pi * (8 * TIME + 8 * TIME**2))
EVERYTHING = ("clearance", "hysteresis", "actuator-lag", "actuator-dead-zone", "sensor-lag", "stiffness-drift")
NASTY = [
    '"; system("touch owned"); //',
    '*/ #error "no" /*',
    "??/\n#error trigraph",
    "a\\\n#error continued",
    "x\x00y\u202e\u2028\ud800",
    "Prüfstand №5, 2²",
    "/* * / */*/",
    "%s%n {{ 7*7 }} @STRUCT@",
    "int",
    "dp",
    "DP_law",
    "9",
    "",
    "x" * 500,
]


def compiler() -> str:
    path = find_compiler()
    assert path is not None
    return path


def build(folder: Path, *more: str) -> None:
    sources = sorted(path.name for path in folder.glob("*.c"))
    run = subprocess.run(
        [compiler(), "-O1", "-std=c99", *STRICT, *sources, *more, "-lm"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


class Plain:
    """One model of a compiled library, driven from Python."""

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        self.call = lambda function: getattr(library, f"{name}_{function}")
        self.room = (ctypes.c_double * 400)()

    def start(self, state=None, t: float = 0.0, parameters=None) -> Plain:
        def array(values):
            return None if values is None else (ctypes.c_double * len(values))(*values)

        self.call("start")(self.room, array(parameters), array(state), ctypes.c_double(t))
        return self

    def step(self, now: float, then: float, dt: float = DT) -> int:
        return self.call("step")(self.room, ctypes.c_double(now), ctypes.c_double(then), ctypes.c_double(dt))

    def outputs(self, force: float) -> list[float]:
        out = (ctypes.c_double * 4)()
        self.call("outputs")(self.room, ctypes.c_double(force), out)
        return list(out)

    def record(self, force: np.ndarray) -> np.ndarray:
        """(n,) responses."""
        responses = [self.outputs(force[0])[0]]
        for now, then in itertools.pairwise(force):
            assert self.step(now, then) == 0
            responses.append(self.outputs(then)[0])
        return np.array(responses)


def core_response(model: Oscillator, initial, force: np.ndarray) -> np.ndarray:
    step = internal_step(model, model.values(), amplitude_of(model))
    values = np.array(list(model.values().values()))
    return core_of(model).record(values, np.array(initial, float), force, force.size, DT, step, start=START)


@pytest.fixture(scope="module")
def program(with_law: Callable[..., Oscillator], tmp_path_factory: pytest.TempPathFactory):
    """``program(effects)``: one with these laws in it, each as a model of its own; see ``built``."""
    return cache(lambda effects: built(effects, with_law, tmp_path_factory.mktemp("plain")))


@pytest.fixture(scope="module")
def made(program, kinds: tuple[str, ...]):
    """The program with a law of each kind."""
    return program(kinds)


def built(effects: tuple[str, ...], with_law: Callable[..., Oscillator], folder: Path):
    """One program with laws in it, each as a model of its own, all laws with a path of their own in one, and
    velocity and acceleration as the response."""
    models = {effect.replace("-", "_").replace("/", "_"): with_law(effect) for effect in effects}
    models["base"] = with_law()
    models["everything"] = with_law(*EVERYTHING)
    models["velocity"] = with_law("sensor-lag", quantity="velocity")
    models["acceleration"] = with_law("sensor-lag", quantity="acceleration", dry=3.0)
    for name, model in models.items():
        export_plain_c(replace(model, name=name), folder / f"{name}.c")
    build(folder, "-shared", "-fPIC", "-o", "all.so")
    library = ctypes.CDLL(str(folder / "all.so"))
    return models, lambda name: Plain(library, name)


@pytest.mark.parametrize("whole", [False, pytest.param(True, marks=pytest.mark.long)], ids=["kinds", "library"])
def test_every_law_repeats_the_core(program, kinds, offsets, whole):
    models, plain = program(tuple(LIBRARY) if whole else kinds)
    for name, model in models.items():
        inner = offsets(model)
        for initial, force in (([0.0, 0.0, *inner], CHIRP), ([6e-3, 0.1, *inner], 0.0 * CHIRP)):
            expected = core_response(model, initial, force)
            response = plain(name).start(initial, START).record(force)
            assert np.max(np.abs(expected)) > 0, name
            assert np.max(np.abs(response - expected)) <= 2e-15 * np.max(np.abs(expected)), name


def test_null_stands_for_the_identified_values_and_a_start_at_rest(made):
    models, plain = made
    values = list(models["everything"].values().values())
    states = [0.0] * len(core_of(models["everything"]).equations.state_names)
    spelt_out = plain("everything").start(states, START, values).record(CHIRP[:50])
    assert np.array_equal(plain("everything").start(None, START).record(CHIRP[:50]), spelt_out)


def test_a_changed_parameter_and_state_count_at_once(made):
    models, plain = made
    heavier = models["base"].values() | {"mass": 0.5}
    expected = plain("base").start([1e-3, 0.2], 0.0, list(heavier.values())).record(CHIRP[:50])
    rig = plain("base").start([5e-3, -0.1])
    rig.step(0.0, 0.0)
    rig.call("set_parameter")(rig.room, 0, ctypes.c_double(0.5))
    rig.call("set_parameter")(rig.room, 6, ctypes.c_double(9.9))  # there is none
    rig.call("set_parameter")(rig.room, -1, ctypes.c_double(9.9))
    rig.call("set_state")(rig.room, (ctypes.c_double * 2)(1e-3, 0.2))
    assert np.array_equal(rig.record(CHIRP[:50]), expected)


def test_looking_at_outputs_changes_nothing_and_a_copy_is_a_stored_state(made):
    _, plain = made
    rig = plain("everything").start([2e-3, 0.1, 1e-5, 0.1, 1e-5])
    before = bytes(rig.room)
    first = rig.outputs(0.3)
    assert bytes(rig.room) == before
    assert np.all(np.isfinite(first))
    for k in range(30):
        assert rig.step(CHIRP[k], CHIRP[k + 1]) == 0
    kept, expected = bytes(rig.room), rig.record(CHIRP[30:60])
    ctypes.memmove(rig.room, kept, len(kept))
    assert np.array_equal(rig.record(CHIRP[30:60]), expected)


def test_a_step_that_cannot_be_done_changes_nothing(made):
    _, plain = made
    rig = plain("base").start([1e-3, 0.0])
    before = bytes(rig.room)
    nan, inf = float("nan"), float("inf")
    for arguments, status in (
        ((0.0, 0.0, -1e-3), 3),
        ((0.0, 0.0, nan), 3),
        ((0.0, 0.0, inf), 3),
        ((0.0, 0.0, 1e6), 3),
        ((nan, 0.0), 2),
        ((0.0, inf), 2),
        ((1e308, -1e308), 2),
    ):
        assert rig.step(*arguments) == status
        assert bytes(rig.room) == before
    assert rig.step(0.0, 0.0, 0.0) == 0
    rig.start([nan, 0.0])
    assert rig.step(0.0, 0.0) == 2
    gives_way = {"mass": 0.27, "omega0": 79.6, "cubic": -4.6e8, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
    rig.start([1e-2, 0.0], 0.0, list(gives_way.values()))
    assert 2 in [rig.step(0.0, 0.0) for _ in range(2000)]


def test_two_models_in_one_program_and_nothing_from_outside(models, with_law, tmp_path):
    """As a user writes it: two models, one C program, every level of optimisation, no symbol but the models' own."""
    export_plain_c(models["base"](), tmp_path / "stand.c")
    export_plain_c(replace(with_law("hysteresis", "tonal-disturbance"), name="joint"), tmp_path / "joint.c")
    (tmp_path / "main.c").write_text(
        """#include <stdio.h>
#include "stand.h"
#include "joint.h"
int main(void) {
    stand_model one;
    joint_model two;
    double a[stand_n_outputs], b[joint_n_outputs], p[joint_n_parameters];
    int k;
    for (k = 0; k < joint_n_parameters; ++k) p[k] = joint_identified[k];
    p[joint_p_hysteresis_stiffness] *= 2.0;
    stand_start(&one, 0, 0, 0.0);
    joint_start(&two, p, 0, 0.0);
    for (k = 0; k < 100; ++k) {
        if (stand_step(&one, 0.01 * k, 0.01 * (k + 1), 1e-3) != stand_ok) return 1;
        if (joint_step(&two, 0.01 * k, 0.01 * (k + 1), 1e-3) != joint_ok) return 1;
    }
    stand_outputs(&one, 1.0, a);
    joint_outputs(&two, 1.0, b);
    printf("%.17g %.17g\\n", a[stand_y_x], b[joint_y_displacement]);
    return !(one.z[stand_z_velocity] == a[stand_y_velocity]);
}
"""
    )
    printed = set()
    for level in ("-O0", "-O2", "-O3", "-Os"):
        build(tmp_path, level, "-o", "program")
        run = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
        printed.add(run.stdout)
    assert len(printed) == 1
    assert all(abs(float(number)) > 0 for number in printed.pop().split())
    build_object = [compiler(), "-O1", "-std=c99", "-c", "stand.c", "-o", "stand.o"]
    subprocess.run(build_object, cwd=tmp_path, check=True)
    listed = subprocess.run(["nm", "-g", "stand.o"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in listed.splitlines()]
    made = {row[-1].lstrip("_") for row in rows if row[-2] != "U"}
    functions = ("start", "step", "outputs", "set_parameter", "set_state")
    assert made == {f"stand_{name}" for name in (*functions, "identified")}
    outside = {row[-1].lstrip("_") for row in rows if row[-2] == "U"}
    assert outside <= {
        "memcpy",
        "memset",
        "sqrt",
        "fmin",
        "fmax",
        "copysign",
        "ceil",
        "fabs",
        "pow",
        "stack_chk_fail",
    }
    written = [row for row in rows if row[-2] in "BbDdC"]
    assert written == []  # nothing that could change


def test_it_is_c_plus_plus_too(with_law, tmp_path):
    export_plain_c(replace(with_law(*EVERYTHING), name="rig"), tmp_path / "rig.c")
    for standard in ("-std=c++98", "-std=c++17"):
        command = [compiler(), "-x", "c++", standard, "-fsyntax-only", *STRICT, "rig.c"]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        if "cc1plus" in run.stderr:
            pytest.skip("this compiler has no C++")
        assert run.returncode == 0, run.stderr


def test_no_text_of_a_model_reaches_the_program(models, tmp_path):
    for i, name in enumerate(NASTY):
        model = replace(
            models["base"](),
            name=name,
            identified=Provenance(recordings=({"file": name, "kind": name},), method=name, software=name),
        )
        source, header = export_plain_c(model, tmp_path / f"nasty_{i}.c")
        for path in (source, header):
            text = path.read_text(encoding="ascii")
            assert "??" not in text
            assert "system(" not in re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    build(tmp_path, "-fsyntax-only", "-Wtrigraphs", "-Wcomment")


def test_numbers_units_and_validity_stand_in_the_header(models):
    odd = 0.1 + 0.2
    model = replace(
        models["volts"]().with_parameters({"dry": Parameter(odd, 2e-3, "V/s2"), "viscous": Parameter(1e-300, None)}),
        amplitude=Range(2e-4, 9e-3, "V"),
        frequency=Range(5.0, 20.0, "Hz"),
        identified=Provenance(recordings=({"file": "sweep.csv"},), method="maximum-likelihood", software="dashpot 0"),
    )
    source, header = plain_c(Facts(model), "rig.h")
    assert f"    {odd!r},\n" in source
    assert "    1e-300,\n" in source
    words = " ".join(header.replace("*", " ").split())
    assert "volts_p_dry, / 0.3000 +/- 0.0020 V/s2: dry friction force per unit mass; times the mass 0.08100 " in words
    assert "amplitude 0.0002 to 0.009 V and frequency 5 to 20 Hz" in words
    assert "Identified from sweep.csv by maximum-likelihood dashpot 0." in words
    assert "omega0^2 x + cubic x^3" in words
    assert "input F in N" in words
    dragged = " ".join(plain_c(Facts(models["drag"]()), "rig.h")[1].split())
    assert re.search(
        r"p_quadratic_drag_coefficient, /\* \S+ 1/m: [a-z ]+ per unit mass; times the mass \S+ N.s2/m2 ", dragged
    )
    free = plain_c(Facts(models["massless"]()), "rig.h")[1]
    assert "massless_p_mass" not in free
    assert "times the mass" not in free
    assert "input is a force per unit mass" in " ".join(free.replace("*", " ").split())


def test_same_model_same_text_and_both_files_or_none(models, tmp_path):
    first = [path.read_bytes() for path in export_plain_c(models["drag"](), tmp_path / "a" / "rig.c")]
    assert first == [path.read_bytes() for path in export_plain_c(models["drag"](), tmp_path / "b" / "rig.c")]
    assert b"int main" not in first[0]
    for name in ('ri"g.c', "ri\\g.c", "ri??!g.c", "ri\ng.c"):
        with pytest.raises(BadInput, match="cannot stand in an #include"):
            export_plain_c(models["base"](), tmp_path / "c" / name)
    broken = models["base"]().with_parameters({"dry": Parameter(float("nan"), None, "m/s2")})
    with pytest.raises(BadInput, match="is nan"):
        export_plain_c(broken, tmp_path / "c" / "rig.c")
    assert not (tmp_path / "c").exists()
    (tmp_path / "d" / "rig.h").mkdir(parents=True)
    with pytest.raises(BadInput, match="is a folder"):
        export_plain_c(models["base"](), tmp_path / "d" / "rig.c")
    assert [path.name for path in (tmp_path / "d").iterdir()] == ["rig.h"]


def test_names_stay_apart():
    assert symbols(["a-b.c", "a.b-c", "a b c", "x"]) == ["a_b_c", "a_b_c__2", "a_b_c__3", "x"]
    assert prefix_of("stand") == "stand"
    assert prefix_of("dp") == "model_dp"
    assert prefix_of("DP_law") == "model_DP_law"
    assert own("void f(void);\nint g(void) { return 1; }\n    int h;\nstatic int k(void);\ntypedef int l;\n") == (
        "static void f(void);\nstatic int g(void) { return 1; }\n    int h;\nstatic int k(void);\ntypedef int l;\n"
    )
