"""Values of a recording in words: in the unit as recorded, to the digits that are known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.offset import FoundOffset
from dashpot.identify.signals.said import said
from dashpot.recording import Recording

X = np.arange(9.0)


def recorded(unit, si="m"):
    return Recording("run", 100.0, X, force=X, unit=si, recorded_unit=unit, recorded_force_unit="kN")


@pytest.mark.parametrize(
    ("recording", "value", "std", "words"),
    [
        (recorded("mm"), 3.646e-4, None, "0.365 mm"),
        (recorded("mm"), 3.646e-4, 1.5e-8, "0.365 mm"),
        (recorded("mm"), 3.646e-4, 1.5e-5, "0.365 ± 0.015 mm"),
        (recorded("um"), 3.646e-4, None, "365 um"),
        (recorded("in"), 0.0254, None, "1 in"),
        (recorded("m"), 3.646e-4, 1.5e-8, "0.365 mm"),
        (recorded("deg", "rad"), np.pi, None, "180 deg"),
        (recorded("", "rad"), 0.5, None, "0.5 rad"),
        (recorded("", "V"), -2e-3, None, "-2 mV"),
    ],
)
def test_a_value_of_the_response(recording, value, std, words):
    assert said(recording, value, std) == words


def test_a_force_and_a_rate():
    assert said(recorded("mm"), 1500.0, force=True) == "1.5 kN"
    assert said(recorded("mm"), 2e-3, per="/s") == "2 mm/s"


def test_what_a_sensor_shows_at_zero_is_told_so():
    offset = FoundOffset(0, "response", 3.646e-4, 1.5e-8)
    assert offset.sentence(recorded("mm")) == "run: the sensor shows 0.365 mm at zero; it was taken off"
    assert "0.020 ± 0.010 kN" in FoundOffset(0, "force", 20.0, 10.0).sentence(recorded("mm"))
