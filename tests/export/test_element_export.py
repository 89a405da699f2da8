"""An element as an FMU and as CasADi functions, against the engine."""

from __future__ import annotations

import json
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import motion
from dashpot.export import element_files, export_element
from dashpot.model.element import Element
from dashpot.model.element_file import loads
from dashpot.model.library import find
from dashpot.model.oscillator import Range
from dashpot.simulate.imposed import force_along, spline_of

FS = 500.0
X = motion("sweep", 5e-3, 2.0, FS, 4.0)
V, A = spline_of(X, 1.0 / FS)
OWN = {
    "hysteresis": {"stiffness": 2e5, "limit": 2e-4, "exponent": 1.0, "loading": 0.5},
    "nonlinear-maxwell": {"stiffness": 2e5, "limit": 3e-4, "speed": 0.02, "exponent": 2.5},
    "two-sided-stop": {"stiffness": 3e5, "position": 3e-3, "damping": 20.0, "offset": 0.0},
}


def element(law: str = "") -> Element:
    own = {f"{law}.{name}": value for name, value in OWN.get(law, {}).items()}
    values = {"inertia": 3.0, "stiffness": 7e3, "viscous": 500.0, "dry": 20.0, "load": 9.0}
    made = Element.from_values(values | own, name="strut", laws=[find(law)] if law else [])
    return replace(made, amplitude=Range(0.0, 5e-3, "m"), speed=Range(0.0, float(np.max(np.abs(V))), "m/s"))


def run(path: Path, folder: Path) -> np.ndarray:
    """(n, 3) force, energy and dissipated power of an FMU, its inputs set before each step, with their slopes."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    description = fmpy.read_model_description(str(path))
    unpacked = fmpy.extract(str(path), unzipdir=str(folder))
    place = {variable.name: variable.valueReference for variable in description.modelVariables}
    inputs = [place[name] for name in ("displacement", "velocity", "acceleration")]
    outputs = [place[name] for name in ("F", "energy", "dissipated_power")]
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="one",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.setReal(inputs, [X[0], V[0], A[0]])
    slave.exitInitializationMode()
    made = [slave.getReal(outputs)]
    for i in range(X.size - 1):
        slave.setReal(inputs, [X[i], V[i], A[i]])
        slave.setRealInputDerivatives([inputs[2]], [1], [(A[i + 1] - A[i]) * FS])
        slave.doStep(currentCommunicationPoint=i / FS, communicationStepSize=1.0 / FS)
        made.append(slave.getReal(outputs))
    slave.terminate()
    slave.freeInstance()
    return np.array(made)


@pytest.mark.parametrize("law", ["", *OWN])
def test_the_fmu_gives_the_force_of_the_engine(law: str, tmp_path: Path) -> None:
    if shutil.which("gcc") is None and shutil.which("cc") is None:
        pytest.skip("no C compiler")
    (path,) = export_element(element(law), tmp_path / "strut.fmu")
    made = run(path, tmp_path / "unpacked")
    force = force_along(element(law), X, 1.0 / FS)
    off = np.abs(made[:, 0] - force) / np.std(force)
    assert np.quantile(off, 0.98) < 1e-6  # at a turn a sample is on one side or the other
    power = np.gradient(made[:, 1], 1.0 / FS) + made[:, 2]
    smooth = np.abs(V) > 0.05 * np.max(np.abs(V))
    assert np.median(np.abs(power - force * V)[smooth]) < 0.02 * np.std(force * V)


def test_the_fmu_is_valid_holds_its_file_and_is_the_same_each_time(tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    (one,), (other,) = (export_element(element("hysteresis"), tmp_path / name) for name in ("one.fmu", "other.fmu"))
    assert validate_fmu(str(one)) == []
    assert one.read_bytes() == other.read_bytes()
    with zipfile.ZipFile(one) as archive:
        assert loads(archive.read("resources/element.yaml").decode()) == element("hysteresis")
        page = archive.read("documentation/index.html").decode()
        description = archive.read("modelDescription.xml").decode()
    assert "motion in, force out" in page
    assert "<ModelExchange" not in description
    assert 'numberOfEventIndicators="0"' in description


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
    with pytest.raises(BadInput, match=r"exported as \.fmu and \.casadi"):
        element_files(tmp_path / "strut.ssp")
    (tmp_path / "strut.casadi.json").write_text("{}")
    with pytest.raises(BadInput, match="json"):
        element_files(tmp_path / "strut.casadi")
