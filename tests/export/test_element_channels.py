"""An element that depends on channels, exported: these are inputs, held over a step, with their references to begin."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from dashpot.examples.specimens import motion
from dashpot.export import export_element
from dashpot.model.dependence import Dependence
from dashpot.model.element import Element
from dashpot.model.library import find
from dashpot.model.oscillator import Range
from dashpot.simulate.compiler import find_compiler
from dashpot.simulate.imposed import force_along, spline_of

FS = 500.0
X = motion("sweep", 5e-3, 2.0, FS, 3.0)
V, A = spline_of(X, 1.0 / FS)
TIME = np.arange(X.size) / FS
CHANNELS = {"current": 0.1 + 0.1 * TIME, "pressure": 2e5 + 1e5 * np.sin(TIME), "load": 2.0 + TIME}
#: The channel that is called as a member is.
INPUTS = {"current": "current", "pressure": "pressure", "load": "load_channel"}
needs_compiler = pytest.mark.skipif(find_compiler() is None, reason="no C compiler")


def element() -> Element:
    values = {"inertia": 3.0, "stiffness": 7e3, "viscous": 500.0, "dry": 20.0, "load": 9.0}
    values |= {"hysteresis.stiffness": 2e5, "hysteresis.limit": 2e-4, "hysteresis.exponent": 1.0}
    values |= {"hysteresis.loading": 0.5, "viscous.current_slope": 300.0, "dry.pressure_exponent": 0.8}
    values |= {"hysteresis.stiffness.load_rate": 0.1}
    pressure = ("power", 4e5, "Pa", 1e5, 7e5)
    ways = [
        Dependence("current", "viscous", "linear", 0.25, "A", 0.0, 0.5),
        Dependence("pressure", "dry", *pressure),
        Dependence("pressure", "viscous", "origin", *pressure[1:]),
        Dependence("load", "hysteresis.stiffness", "inverse", 4.0, "N", 1.0, 7.0),
    ]
    made = Element.from_values(values, name="strut", laws=[find("hysteresis")], dependences=ways)
    return replace(made, amplitude=Range(0.0, 5e-3, "m"), speed=Range(0.0, float(np.max(np.abs(V))), "m/s"))


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_channels_are_inputs_of_the_fmu(version: int, tmp_path: Path, callers: Any) -> None:
    (path,) = export_element(element(), tmp_path / "strut.fmu", version=version)
    caller = callers(path, "CoSimulation")

    def at(i: int) -> dict[str, float]:
        moved = {"displacement": X[i], "velocity": V[i], "acceleration": A[i]}
        return moved | {name: float(CHANNELS[channel][i]) for channel, name in INPUTS.items()}

    caller.start(**at(0))
    made = [caller.get("F")[0]]
    for i in range(X.size - 1):
        caller.set(**at(i))
        slope = (A[i + 1] - A[i]) * FS
        if caller.second:
            names = ["acceleration", "current"]
            caller.fmu.setRealInputDerivatives(caller.references(names), [1, 1], [slope, 0.1])
        else:
            caller.set(acceleration_rate=slope)
        caller.fmu.doStep(i / FS, 1.0 / FS)
        made.append(caller.get("F")[0])
    held = {name: np.concatenate([values[:1], values[:-1]]) for name, values in CHANNELS.items()}
    expected = force_along(element(), X, 1.0 / FS, channels=held)
    assert np.quantile(np.abs(made - expected) / np.std(expected), 0.98) < 1e-6
    unchanged = force_along(element(), X, 1.0 / FS)
    assert np.std(unchanged - expected) > 0.1 * np.std(expected)


@needs_compiler
def test_the_fmu_says_unit_reference_and_range_of_a_channel(tmp_path: Path) -> None:
    from fmpy import read_model_description

    (path,) = export_element(element(), tmp_path / "strut.fmu")
    known = {v.name: v for v in read_model_description(str(path)).modelVariables}
    assert {known[name].causality for name in INPUTS.values()} == {"input"}
    assert (float(known["pressure"].start), known["pressure"].unit) == (4e5, "Pa")
    assert "recorded from 100000 to 700000 Pa" in known["pressure"].description
    assert "viscous" in known["current"].description


def test_a_channel_left_out_of_the_casadi_function_has_its_reference(tmp_path: Path) -> None:
    export_element(element(), tmp_path / "strut.casadi")
    function = ca.Function.load(str(tmp_path / "strut.casadi"))
    at = {"z": 1e-4, "x": 2e-3, "v": 0.03, "a": 1.5}
    plain = float(function(**at)["F"])
    assert float(function(**at, c=ca.inf)["F"]) == plain
    assert float(function(**at, c=[0.25, 4e5, 4.0])["F"]) == pytest.approx(plain, rel=1e-14)
    told = json.loads((tmp_path / "strut.casadi.json").read_text())
    assert [entry["name"] for entry in told["c"]] == list(INPUTS)
    # by hand: inertia, damping, friction, spring, load and bristle, with what the channels make of each
    expected = 3.0 * 1.5 + (500.0 + 300.0 * (0.0 - 0.25)) * (2e5 / 4e5) * 0.03 + 20.0 * 0.5**0.8 + 7e3 * 2e-3 + 9.0
    expected += 2e5 / (1.0 + 0.1 * (7.0 - 4.0)) * 1e-4
    assert float(function(**at, c=[0.0, 2e5, 7.0])["F"]) == pytest.approx(expected, rel=1e-12)


def test_channels_are_parameters_of_plain_c(tmp_path: Path) -> None:
    export_element(element(), tmp_path / "strut.c")
    header = (tmp_path / "strut.h").read_text()
    assert "strut_p_load_channel" in header
    assert "recorded from 0 to 0.5 A" in header
    assert "(viscous + current_slope (current - 0.25)) pressure/4e+05 x'" in " ".join(header.split())
