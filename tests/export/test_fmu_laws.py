"""FMUs of models with any law: valid, the right dependencies, start values by name, a state that can be kept."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from dashpot.export.description import describe_fmu
from dashpot.export.facts import Facts
from dashpot.export.fmu import export_fmu
from dashpot.model.laws import LIBRARY
from fmpy import read_model_description
from fmpy.validation import validate_fmu

DT = 1e-3


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("effect", LIBRARY)
def test_validator_finds_no_problem(effect, version, law_fmu):
    assert validate_fmu(str(law_fmu(version, effect))) == []


def test_start_values_of_inner_states_are_named_and_explained(with_law):
    description = describe_fmu(Facts(with_law("actuator-backlash", "viscoelastic", "tonal-disturbance")))
    starts = {v.name: (v.unit, v.start, v.description) for v in description.variables if v.role == "initial"}
    assert starts == {
        "x0": ("m", 0.0, "displacement at the start"),
        "v0": ("m/s", 0.0, "velocity at the start"),
        "actuator-backlash.displacement0": (
            "m",
            0.0,
            "actuator-backlash: start value of its displacement, beyond x0",
        ),
        "actuator-backlash.velocity0": ("m/s", 0.0, "actuator-backlash: start value of its velocity, beyond v0"),
        "viscoelastic.damper0": ("m", 0.0, "viscoelastic: start value of its damper, beyond x0"),
        "tonal-disturbance.phase0": (
            "rad",
            0.0,
            "tonal-disturbance: start value of its phase, another in each run",
        ),
    }
    assert description.follows == (None, None, 0, 1, 0, None)


@pytest.fixture
def structure(with_law, tmp_path) -> Callable[..., tuple[dict[str, list[str]], dict[str, list[str]]]]:
    """What outputs depend on, and what they depend on at the start, in an FMU as an importer reads it."""

    def read(*effects, quantity="displacement"):
        path = export_fmu(with_law(*effects, quantity=quantity), Path(tmp_path) / "rig.fmu")
        description = read_model_description(str(path))
        later = {u.variable.name: [v.name for v in u.dependencies] for u in description.outputs}
        return later, {u.variable.name: [v.name for v in u.dependencies] for u in description.initialUnknowns}

    return read


def test_an_actuator_with_a_state_keeps_the_force_from_the_acceleration(structure):
    later, first = structure("actuator-lag")
    assert later["acceleration"] == ["displacement", "velocity", "actuator-lag.force"]
    assert "actuator-lag.force0" in first["acceleration"]
    later, first = structure("actuator-dead-zone")
    assert later["acceleration"] == ["F", "displacement", "velocity"]
    assert "actuator-dead-zone.threshold" in first["acceleration"]


def test_a_sensor_with_a_state_is_what_it_was(structure):
    later, first = structure("sensor-lag")
    assert later["x"] == ["sensor-lag.signal"]
    assert first["x"] == ["x0", "sensor-lag.signal0"]
    later, first = structure("sensor-nonlinearity", quantity="acceleration")
    assert later["x"] == ["F", "displacement", "velocity"]
    assert {"sensor-nonlinearity.cubic", "F", "x0", "v0", "mass"} <= set(first["x"])
    later, first = structure("sensor-offset")
    assert first["x"] == ["sensor-offset.offset", "x0"]
    assert first["displacement"] == ["x0"]


def test_what_rides_along_depends_on_where_the_mass_starts(structure):
    _, first = structure("viscoelastic")
    assert {"x0", "viscoelastic.damper0", "viscoelastic.stiffness"} <= set(first["acceleration"])


@pytest.mark.parametrize("backend", ["native", "python"])
def test_a_kept_state_holds_the_memory(with_law, tmp_path, backend, opened_fmu):
    path = export_fmu(with_law("hysteresis", "actuator-lag"), tmp_path / "rig.fmu", backend=backend)
    references, starts, fmu = opened_fmu(path)

    def on(steps):
        samples = []
        for k in steps:
            fmu.setReal([references["F"]], [float(np.sin(80 * k * DT))])
            fmu.doStep(k * DT, DT)
            samples += fmu.getReal([references["acceleration"]])
        return samples

    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.setReal([references[name] for name in starts], [2e-3, 0.1, 0.2, 5e-4])
    fmu.exitInitializationMode()
    on(range(40))
    kept = fmu.getFMUstate()
    expected = on(range(40, 80))
    fmu.setFMUstate(kept)
    assert on(range(40, 80)) == expected
    fmu.freeFMUstate(kept)
    fmu.terminate()
