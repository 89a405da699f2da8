"""A recording keeps the units of its file beside those of SI."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, from_sep5, read
from dashpot.recording.as_recorded import of_force, of_length, of_response, scale_of_unit
from dashpot.recording.fact import changed


def test_the_units_of_a_file_are_kept(tmp_path):
    t = np.arange(400) / 200.0
    rows = np.column_stack([t, np.sin(9 * t), 8.0 * np.sin(9 * t - 1)])
    path = tmp_path / "run.csv"
    np.savetxt(path, rows, delimiter=",", header="time_s,force_kN,x_mm", comments="")
    recording = read(path)
    assert (recording.unit, recording.recorded_unit) == ("m", "mm")
    assert of_response(recording) == (pytest.approx(1000.0), "mm")
    assert of_force(recording) == (pytest.approx(1e-3), "kN")
    assert of_response(changed(recording, response=2.0 * recording.response))[1] == "mm"
    assert of_response(recording.slice(0, 100))[1] == "mm"


def test_of_another_quantity_the_unit_is_that_of_si():
    """An acceleration in g, integrated, is no length in g."""
    seen = Recording("run", 100.0, np.arange(9.0), quantity="acceleration", unit="m/s2", recorded_unit="g")
    assert of_response(seen) == (pytest.approx(1 / 9.80665), "g")
    assert of_response(changed(seen, quantity="displacement", unit="m")) == (1.0, "m")


def test_where_nothing_else_was_recorded_the_unit_is_its_own():
    assert of_response(Recording("run", 100.0, np.arange(9.0))) == (1.0, "m")
    assert scale_of_unit("V", "") == scale_of_unit("V", "furlong") == (1.0, "V")
    series = {"name": "x", "data": np.arange(9.0), "fs": 100.0, "unit_str": "mm"}
    assert of_response(from_sep5(series))[1] == "mm"


def test_what_is_wrong_is_said_in_the_unit_of_the_file(tmp_path):
    t = np.arange(4000) / 200.0
    force = np.random.default_rng(3).normal(size=t.size)
    moved = np.clip(8.0 * np.exp(-0.02 * t) * np.sin(9 * t), -5.0, 5.0)
    path = tmp_path / "run.csv"
    np.savetxt(path, np.column_stack([t, force, moved]), delimiter=",", header="time_s,force_kN,x_mm", comments="")
    with pytest.raises(BadInput, match=r"it stays exactly at -?5 mm and -?5 mm on"):
        read(path)


@pytest.mark.parametrize(
    ("units", "own", "said"),
    [
        (("mm", "mm"), "m", "mm"),
        (("mm/s",), "m", "mm"),
        (("mm", "um"), "m", "m"),
        (("g",), "m", "m"),
        (("deg",), "rad", "deg"),
    ],
)
def test_a_length_is_in_the_unit_that_all_recordings_had(units, own, said):
    made = [Recording(f"{i}", 100.0, np.arange(9.0), recorded_unit=unit) for i, unit in enumerate(units)]
    factor, unit = of_length(made, own)
    assert unit == said
    assert factor == pytest.approx({"mm": 1e3, "m": 1.0, "deg": 180 / np.pi}[said])
