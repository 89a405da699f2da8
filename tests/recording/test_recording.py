"""The Recording itself: what it accepts, what it derives, and the exchange with SEP 5."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, from_sep5

RESPONSE = np.sin(np.arange(100.0))


def test_arrays_are_copied_and_read_only():
    values = RESPONSE.copy()
    recording = Recording("r", 10.0, values, force=values)
    values[0] = 99.0
    assert recording.response[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        recording.response[0] = 1.0


def test_derived_values_and_slice():
    recording = Recording("r", 10.0, RESPONSE, force=2 * RESPONSE, start=5.0)
    assert (recording.n, recording.dt, recording.duration) == (100, 0.1, 10.0)
    part = recording.slice(20, 50)
    np.testing.assert_allclose(part.time, recording.time[20:50])
    np.testing.assert_array_equal(part.force, 2 * RESPONSE[20:50])
    assert recording.slice(-10, None).start == pytest.approx(14.0)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"fs": 0.0}, "sampling rate"),
        ({"fs": float("nan")}, "sampling rate"),
        ({"start": float("inf")}, "time stamp"),
        ({"quantity": "jerk"}, "displacement, velocity, acceleration"),
        ({"hold": "first"}, "zero, linear, smooth"),
        ({"response": np.zeros((10, 2))}, "one column"),
        ({"response": np.zeros(1)}, "at least 2"),
        ({"response": np.array(["a", "b"])}, "not an array of numbers"),
        ({"force": np.zeros(99)}, "99 samples and the response 100"),
    ],
)
def test_what_is_no_recording_is_refused(changed, words):
    with pytest.raises(BadInput, match=words):
        Recording(**{"name": "r", "fs": 10.0, "response": RESPONSE, **changed})


def test_sep5_round_trip():
    recording = Recording("r", 10.0, RESPONSE, force=2 * RESPONSE, quantity="velocity", unit="m/s", start=1.0)
    again = from_sep5(*recording.to_sep5())
    np.testing.assert_array_equal(again.response, recording.response)
    np.testing.assert_array_equal(again.force, recording.force)
    assert (again.fs, again.start, again.quantity, again.unit) == (pytest.approx(10.0), 1.0, "velocity", "m/s")


def test_sep5_of_others_is_converted_to_si():
    recording = from_sep5({"data": [1.0, 2.0, 3.0], "fs": 50, "name": "laser", "unit_str": "mm"})
    np.testing.assert_allclose(recording.response, [1e-3, 2e-3, 3e-3])
    assert (recording.name, recording.unit, recording.fs, recording.force) == ("laser", "m", 50.0, None)


@pytest.mark.parametrize(
    ("series", "words"),
    [
        ({"fs": 1.0}, "no 'data'"),
        ({"data": [1.0, 2.0]}, "--fs"),
        ({"data": [1.0, 2.0], "fs": 1.0, "unit_str": "milimeter"}, "did you mean"),
        ({"data": [1.0, 2.0], "fs": 1.0, "unit_str": "N"}, "measures force"),
    ],
)
def test_bad_sep5_is_refused(series, words):
    with pytest.raises(BadInput, match=words):
        from_sep5(series)


def test_import_is_light():
    code = "import sys, dashpot.recording; print([m for m in ('scipy', 'matplotlib', 'casadi') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"
