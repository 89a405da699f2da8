"""What a recorded volt stands for."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import from_data
from dashpot.recording.calibration import parse_calibration

G = 9.80665
VOLTS = np.cos(np.arange(400) / 9.0)


@pytest.mark.parametrize(
    ("column", "key", "text", "factor", "unit"),
    [
        ("ai1_V", "response", "22.4 mm/V", 22.4e-3, "m"),
        ("ai1_mV", "response", "22.4 mm/V", 22.4e-6, "m"),
        ("ai1_V", "ai?", "10 mV/g", 100 * G, "m/s2"),
        ("ai1", "ai1", "100 mV/(m/s2)", 0.01, "m/s2"),
        ("ai1", "response", "2 m/s2/V", 2.0, "m/s2"),
        ("ai1", "response", "-2.5 mm", -2.5e-3, "m"),
        ("x_mm", "response", "3", 3e-3, "m"),
    ],
)
def test_factors(column, key, text, factor, unit):
    recording = from_data({"fs": 1000.0, column: VOLTS}, response=column, calibration={key: text}, checked=False)
    np.testing.assert_allclose(recording.response, factor * VOLTS, rtol=1e-12)
    assert recording.unit == unit


def test_the_force_has_its_own():
    data = {"fs": 1000.0, "shaker_V": VOLTS, "disp_V": VOLTS}
    factors = {"force": "5 N/V", "*disp*": "2 mm/V"}
    recording = from_data(data, force="*SHAK*", response="d?sp*", calibration=factors, checked=False)
    assert recording.force is not None
    np.testing.assert_allclose(recording.force, 5 * VOLTS, rtol=1e-15)
    np.testing.assert_allclose(recording.response, 2e-3 * VOLTS, rtol=1e-15)


@pytest.mark.parametrize("text", ["", "N/V", "0 N/V", "inf", "5 N/m", "5 mV/V", "nan N", "3 furlong"])
def test_what_is_no_calibration(text):
    with pytest.raises(BadInput, match=r"^rig: "):
        parse_calibration(text, "rig")


def test_contradictions_are_said():
    data = {"fs": 1000.0, "x_mm": VOLTS}
    with pytest.raises(BadInput, match=r"calibration is for V, the file has mm; leave --calibration out"):
        from_data(data, calibration={"response": "5 mm/V"}, checked=False)
    with pytest.raises(BadInput, match=r"--unit mm and --calibration both say the unit of the response"):
        from_data(data, unit="mm", calibration={"response": "5 mm"}, checked=False)
