"""Lengths of a model in the unit of its recordings, for a person; the file stays in SI."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.model import Oscillator, Parameter, Provenance, Range, Response, oscillator_with
from dashpot.model.as_recorded import as_recorded, parameter_as_recorded, recorded_length, recorded_response
from dashpot.model.file import dumps, loads
from dashpot.model.physical import machine_words
from dashpot.model.quantity import in_base_units
from dashpot.model.show import as_json, describe
from dashpot.recording.units import find_unit

STOP = {"one-sided-stop.stiffness": 9e4, "one-sided-stop.position": 1.2e-3, "one-sided-stop.damping": 0.0}
BASE = {"mass": 0.5, "omega0": 80.0, "cubic": -4e4, "preload": 0.0, "viscous": 5.0, "dry": 0.3}


def model(*units: str, **how: object) -> Oscillator:
    made = oscillator_with(BASE | STOP, ["one-sided-stop"], **how)
    recordings = tuple({"file": f"{i}.csv", **({"unit": unit} if unit else {})} for i, unit in enumerate(units))
    unit = made.response.displacement_unit
    return replace(made, amplitude=Range(2e-4, 9e-3, unit), identified=Provenance(recordings=recordings))


@pytest.mark.parametrize(
    ("units", "length"),
    [(("mm",), "mm"), (("mm", "mm"), "mm"), (("mm", "um"), "m"), (("mm", ""), "m"), (("g",), "m"), ((), "m")],
)
def test_the_unit_is_that_of_all_recordings(units, length):
    assert recorded_length(model(*units)) == length


def test_a_length_follows_from_a_recorded_velocity_and_an_angle_from_degrees():
    assert recorded_length(model("mm/s", response=Response("velocity", "m/s"))) == "mm"
    turned = model("deg", response=Response("displacement", "rad"), force_unit="N.m")
    assert as_recorded(turned, np.pi, "rad") == (pytest.approx(180.0), "deg")
    assert as_recorded(turned, 0.5, "N.m") == (0.5, "N.m")


def test_lengths_speeds_and_accelerations_are_converted_with_their_errors():
    rig = model("mm")
    assert as_recorded(rig, 0.3, "m/s2") == (pytest.approx(300.0), "mm/s2")
    shown = parameter_as_recorded(rig, Parameter(1.2e-3, 1e-5, "m"))
    assert (shown.value, shown.std, shown.unit) == (pytest.approx(1.2), pytest.approx(0.01), "mm")
    assert as_recorded(rig, 9e4, "1/s2") == (9e4, "1/s2")


@pytest.mark.parametrize("unit", ["g", "mg"])
def test_what_an_accelerometer_says_is_in_g_as_it_was_recorded(unit):
    rig = model(unit, unit, response=Response("acceleration", "m/s2"))
    shown = find_unit(unit)
    assert shown is not None
    assert recorded_response(rig) == unit
    assert as_recorded(rig, 3.0, "m/s2") == (pytest.approx(3.0 / shown.factor), unit)
    assert as_recorded(rig, 3.0, "m") == (3.0, "m")
    assert f"acceleration in m/s2, recorded in {unit}" in describe(rig)
    first, *others = rig.identified.recordings
    zero = replace(rig, identified=replace(rig.identified, recordings=({**first, "zero": -2 * shown.factor}, *others)))
    assert f"at zero its sensor shows -2 {unit}" in describe(zero)


@pytest.mark.parametrize(
    ("units", "response", "said"),
    [
        (("mm/s2",), Response("acceleration", "m/s2"), "mm/s2"),
        (("g", "m/s2"), Response("acceleration", "m/s2"), "m/s2"),
        (("deg/s",), Response("velocity", "rad/s"), "deg/s"),
        (("g",), Response("displacement", "m"), "m"),
        ((), Response("displacement", "m"), "m"),
    ],
)
def test_the_response_has_the_unit_of_all_recordings(units, response, said):
    assert recorded_response(model(*units, response=response)) == said


def test_what_is_shown_is_in_millimetres_and_the_file_in_metres():
    rig = model("mm")
    said = describe(rig)
    assert "amplitude  0.2 to 9 mm" in said
    assert "displacement in m, recorded in mm" in said
    (line,) = [line for line in said.splitlines() if line.strip().startswith("one-sided-stop.position")]
    assert line.split()[1:3] == ["0.0012", "m"]
    assert line.endswith(", 1.2 mm")
    assert "at 4.6 mm, amid the recorded amplitudes" in machine_words(rig)["frequency_amid"]
    assert as_json(rig)["valid"]["amplitude"]["unit"] == "m"
    text = dumps(rig)
    assert "unit: mm" in text
    assert loads(text) == rig
    assert "amplitude: {min: 0.0002, max: 0.009, unit: m}" in text


@pytest.mark.parametrize("unit", ["mm", "um", "cm", "nm", "in", "ft", "mil", "deg", "mrad"])
def test_units_of_recordings_are_of_one_size_everywhere(unit):
    known = find_unit(unit)
    assert known is not None
    assert in_base_units(unit, "a unit") == (pytest.approx(known.factor), {known.si: 1})
