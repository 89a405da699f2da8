"""An element as an FMU and as CasADi functions, against the engine."""

from __future__ import annotations

import ctypes
import json
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import motion
from dashpot.export import element_files, export_element
from dashpot.model.element import Element
from dashpot.model.element_file import loads
from dashpot.model.equations import equations
from dashpot.model.library import find
from dashpot.model.oscillator import Provenance, Range
from dashpot.simulate.compiler import find_compiler
from dashpot.simulate.imposed import force_along, spline_of

FS = 500.0
X = motion("sweep", 5e-3, 2.0, FS, 4.0)
V, A = spline_of(X, 1.0 / FS)
OWN = {
    "hysteresis": {"stiffness": 2e5, "limit": 2e-4, "exponent": 1.0, "loading": 0.5},
    "nonlinear-maxwell": {"stiffness": 2e5, "limit": 3e-4, "speed": 0.02, "exponent": 2.5},
    "two-sided-stop": {"stiffness": 3e5, "position": 3e-3, "damping": 20.0, "offset": 0.0},
}

INNER = {"hysteresis": ("deflection",), "nonlinear-maxwell": ("deflection",)}
CO_SIMULATION, DOCUMENTATION = "CoSimulation", "documentation/index.html"
INPUTS, OUTPUTS = ("displacement", "velocity", "acceleration"), ("F", "energy", "dissipated_power")
needs_compiler = pytest.mark.skipif(find_compiler() is None, reason="no C compiler")


def element(law: str = "") -> Element:
    own = {f"{law}.{name}": value for name, value in OWN.get(law, {}).items()}
    values = {"inertia": 3.0, "stiffness": 7e3, "viscous": 500.0, "dry": 20.0, "load": 9.0}
    made = Element.from_values(values | own, name="strut", laws=[find(law)] if law else [])
    return replace(made, amplitude=Range(0.0, 5e-3, "m"), speed=Range(0.0, float(np.max(np.abs(V))), "m/s"))


def run(caller: Any) -> np.ndarray:
    """(n, 3) force, energy and dissipated power of an FMU, its inputs set before each step, with their slopes."""
    caller.start(**dict(zip(INPUTS, (X[0], V[0], A[0]), strict=True)))
    made = [caller.get(*OUTPUTS)]
    for i in range(X.size - 1):
        slope = (A[i + 1] - A[i]) * FS
        caller.set(**dict(zip(INPUTS, (X[i], V[i], A[i]), strict=True)))
        if caller.second:
            caller.fmu.setRealInputDerivatives(caller.references(["acceleration"]), [1], [slope])
        else:
            caller.set(acceleration_rate=slope)
        caller.fmu.doStep(i / FS, 1.0 / FS)
        made.append(caller.get(*OUTPUTS))
    return np.array(made)


def same_force(law: str, force: np.ndarray) -> None:
    """Within 1e-6 of the engine; at a turn a sample is on one side or the other."""
    expected = force_along(element(law), X, 1.0 / FS)
    assert np.quantile(np.abs(force - expected) / np.std(expected), 0.98) < 1e-6


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_says_what_its_fit_leaves_and_where_the_motion_goes_beyond(
    version: int, tmp_path: Path, callers: Any
) -> None:
    left = {"file": "strut.csv", "nrmse": 0.071, "over_noise": 14.0}
    lacking = replace(element(), origin=1e-3, identified=Provenance(recordings=(left,)))
    (path,) = export_element(lacking, tmp_path / "strut.fmu", version=version)
    said = "up to 14 times the noise and 7.1 {} of the force"
    text, page = (zipfile.ZipFile(path).read(name).decode() for name in ("modelDescription.xml", DOCUMENTATION))
    assert said.format("%") in text
    assert said.format("%") in page
    assert "displacement -0.004 to 0.006 m" in page
    caller = callers(path, CO_SIMULATION).start(displacement=1e-3)
    flags = []
    for i, (x, v) in enumerate([(1e-3, 0.0), (5.9e-3, 0.0), (6.2e-3, 0.0), (0.0, -5.0), (-5e-3, 0.0), (1e-3, 0.0)]):
        caller.set(displacement=x, velocity=v)
        flags += caller.get("outside_range")
        caller.fmu.doStep(i * 1e-4, 1e-4)
    assert flags == [0.0, 0.0, 1.0, -1.0, -1.0, 0.0]
    fit, *beyond = caller.texts
    assert said.format("per cent") in fit
    fastest = f"{np.max(np.abs(V)):.4g}"
    assert [line[line.index("the ") :] for line in beyond] == [
        "the displacement has been 0.0062 m, above the range -0.004 to 0.006 m that the model was identified in",
        f"the velocity has been -5 m/s, below the range -{fastest} to {fastest} m/s that the model was identified in",
        "the displacement has been -0.005 m, below the range -0.004 to 0.006 m that the model was identified in",
    ]


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("law", ["", *OWN])
def test_the_fmu_gives_the_force_of_the_engine(law: str, version: int, tmp_path: Path, callers: Any) -> None:
    (path,) = export_element(element(law), tmp_path / "strut.fmu", version=version)
    made = run(callers(path, CO_SIMULATION))
    same_force(law, made[:, 0])
    power = np.gradient(made[:, 1], 1.0 / FS) + made[:, 2]
    smooth = np.abs(V) > 0.05 * np.max(np.abs(V))
    taken = made[:, 0] * V
    assert np.median(np.abs(power - taken)[smooth]) < 0.02 * np.std(taken)


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("law", ["", *OWN])
def test_an_importer_that_integrates_comes_to_the_same(law: str, version: int, tmp_path: Path, callers: Any) -> None:
    from integrating import integrate_along
    from scipy.interpolate import CubicSpline

    (path,) = export_element(element(law), tmp_path / "strut.fmu", version=version)
    caller, spline = callers(path), CubicSpline(np.arange(X.size) / FS, X)
    assert caller.known.states == tuple(f"{law}.{name}" for name in INNER.get(law, ()))
    assert caller.known.indicators == len(equations(element(law)).kinds)
    if version == 2:
        caller.fmu.setupExperiment(startTime=0.0)
    references = [caller.references(names) for names in (INPUTS, OUTPUTS)]
    made = integrate_along(caller.model(), *references, lambda t: [spline(t, n) for n in range(3)], 1.0 / FS, 700, 2)
    expected = run(callers(path, CO_SIMULATION))[:700]
    off = np.abs(made - expected) / np.std(expected, axis=0)
    assert np.quantile(off[:, 0], 0.98) < 1e-6
    assert np.quantile(off[:, 1:], 0.98) < 1e-5


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_fmpy_by_itself_runs_both_interfaces(version: int, tmp_path: Path) -> None:
    """FMPy's inputs run in straight lines, and so does the displacement between its samples."""
    import fmpy

    (path,) = export_element(element("hysteresis"), tmp_path / "strut.fmu", version=version)
    given = np.array(
        list(zip(np.arange(X.size) / FS, X, V, A, strict=True)), dtype=[(n, float) for n in ("time", *INPUTS)]
    )
    expected, time = force_along(element("hysteresis"), X, 1.0 / FS)[:500], np.arange(500) / FS
    for interface, close in ((CO_SIMULATION, 1e-3), ("ModelExchange", 1e-2)):
        how = {"fmi_type": interface, "stop_time": 1.0, "output_interval": 1.0 / FS, "output": ["F"]}
        rows = fmpy.simulate_fmu(str(path), input=given, **how)
        off = np.abs(np.interp(time, rows["time"], rows["F"]) - expected) / np.std(expected)
        assert np.quantile(off, 0.9) < close


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_a_specimen_that_stands_still_is_moved_away_at_a_speed(version: int, tmp_path: Path, callers: Any) -> None:
    (path,) = export_element(element(), tmp_path / "strut.fmu", version=version)
    caller = callers(path)
    caller.initialise(displacement=1e-3, velocity=0.0, acceleration=0.0)
    caller.fmu.exitInitializationMode()
    caller.settle()
    caller.fmu.enterContinuousTimeMode()
    standing = caller.get("F")[0]
    assert standing == pytest.approx(7e3 * 1e-3 + 9.0)
    caller.set(velocity=-0.02)
    assert min(caller.indicators()) <= 0.0
    assert caller.event() is False
    assert min(caller.indicators()) > 0.0
    assert caller.get("F")[0] == pytest.approx(standing - 0.02 * 500.0 - 20.0)


def built(law: str, folder: Path) -> ctypes.CDLL:
    export_element(element(law), folder / "strut.c")
    flags = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off"]
    command = [str(find_compiler()), *flags, "-shared", "-fPIC", "strut.c", "-o", "strut.so", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(folder / "strut.so"))


@needs_compiler
@pytest.mark.parametrize("law", ["", *OWN])
def test_the_plain_c_gives_the_force_of_the_engine(law: str, tmp_path: Path) -> None:
    strut, room = built(law, tmp_path), (ctypes.c_double * 400)()
    state = [X[0], V[0], *(0.0 for _ in INNER.get(law, ()))]
    strut.strut_start(room, None, (ctypes.c_double * len(state))(*state), ctypes.c_double(0.0))
    out, made = (ctypes.c_double * 4)(), []
    for i in range(X.size):
        strut.strut_move(room, ctypes.c_double(X[i]), ctypes.c_double(V[i]))
        strut.strut_outputs(room, ctypes.c_double(A[i]), out)
        made.append(list(out))
        if i + 1 < X.size:
            now, then, dt = (ctypes.c_double(value) for value in (A[i], A[i + 1], 1.0 / FS))
            assert strut.strut_step(room, now, then, dt) == 0
    same_force(law, np.array(made)[:, 0])
    np.testing.assert_allclose(np.array(made)[:, 1:], np.array([X, V, A]).T, atol=1e-12)
    assert strut.strut_step(room, ctypes.c_double(0.0), ctypes.c_double(0.0), ctypes.c_double(-1.0)) == 3


def test_the_header_of_the_plain_c_says_how_it_is_used(tmp_path: Path) -> None:
    written = export_element(element("hysteresis"), tmp_path / "strut.c")
    assert [path.name for path in written] == ["strut.c", "strut.h"]
    header = written[1].read_text()
    for words in ("one force law", "strut_move(&", "strut_y_F", "strut_z_hysteresis_", "acceleration_next"):
        assert words in header
    assert "force_next" not in header


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_is_valid_holds_its_file_and_is_the_same_each_time(version: int, tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    (one,), (other,) = (
        export_element(element("hysteresis"), tmp_path / name, version=version) for name in ("one.fmu", "other.fmu")
    )
    assert validate_fmu(str(one)) == []
    assert one.read_bytes() == other.read_bytes()
    with zipfile.ZipFile(one) as archive:
        assert loads(archive.read("resources/element.yaml").decode()) == element("hysteresis")
        page = archive.read("documentation/index.html").decode()
        description = archive.read("modelDescription.xml").decode()
    assert "motion in, force out" in page
    assert "<ModelExchange" in description


@pytest.mark.parametrize("law", ["", *OWN])
def test_the_casadi_function_is_the_same_force(law: str, tmp_path: Path) -> None:
    import casadi as ca

    written = export_element(element(law), tmp_path / "strut.casadi")
    assert [path.name for path in written] == ["strut.casadi", "strut.smooth.casadi", "strut.casadi.json"]
    exact, smooth = (ca.Function.load(str(path)) for path in written[:2])
    known = json.loads(written[2].read_text())
    inner, force = np.zeros(exact.size1_in(0)), force_along(element(law), X, 1.0 / FS)
    made, soft, parts = [], [], 40
    for i in range(1000):
        f, _ = exact(inner, X[i], V[i], A[i], ca.inf)
        made.append(float(f))
        soft.append(float(smooth(inner, X[i], V[i], A[i], ca.inf)[0]))
        for k in range(parts if inner.size else 0):
            part = (k + 0.5) / parts
            x, v = X[i] + part * (X[i + 1] - X[i]), V[i] + part * (V[i + 1] - V[i])
            inner = inner + np.array(exact(inner, x, v, A[i], ca.inf)[1]).ravel() / FS / parts
    off = np.abs(np.array(made) - force[:1000]) / np.std(force)
    assert np.quantile(off, 0.97) < (2e-2 if inner.size else 1e-9)
    assert np.quantile(np.abs(np.array(soft) - made) / np.std(force), 0.9) < 1e-6
    assert [entry["name"] for entry in known["z"]] == ([] if law in ("", "two-sided-stop") else [known["z"][0]["name"]])
    assert len(known["parameters"]) == exact.size1_in(4)


def test_what_an_element_cannot_be_made_into_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"exported as \.fmu, \.casadi and \.c;"):
        element_files(tmp_path / "strut.ssp")
    (tmp_path / "strut.casadi.json").write_text("{}")
    with pytest.raises(BadInput, match="json"):
        element_files(tmp_path / "strut.casadi")
