"""The force of an element along a motion: what is said beyond what was covered, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import dashpot
import numpy as np
import pytest
from dashpot.face.element import ForceElement
from dashpot.face.element_force import along_recording
from dashpot.model import Range
from dashpot.model.element import Element

FS = 200.0
TIME = np.arange(400) / FS
DAMPER = replace(
    Element.from_values({"viscous": 700.0, "stiffness": 9e3}, name="damper"),
    amplitude=Range(0.0, 6e-3, "m"),
    speed=Range(0.0, 0.1, "m/s"),
)


def recording(motion: np.ndarray, force: np.ndarray | None = None) -> dashpot.Recording:
    columns = {"time_s": TIME, "stroke_m": motion} | ({} if force is None else {"force_N": force})
    (read,) = dashpot.read(columns, prescribed="stroke_m")
    return read


def stroke(amplitude: float) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * 2.0 * TIME)


def test_a_motion_alone_has_a_force() -> None:
    x = stroke(5e-3)
    found = along_recording(DAMPER, [recording(x)])
    exact = 9e3 * x + 700.0 * 5e-3 * 4 * np.pi * np.cos(4 * np.pi * TIME)
    assert list(found.columns) == ["time_s", "displacement_m", "force_N"]
    assert found.columns["force_N"][20:-20] == pytest.approx(exact[20:-20], rel=1e-3, abs=0.05)
    assert found.left is None
    assert found.notes == ()


def test_a_recorded_force_is_compared_where_it_changes() -> None:
    x = stroke(5e-3)
    still = along_recording(DAMPER, [recording(x, np.zeros(x.size))])
    assert still.left is None
    assert "measured_N" in still.columns
    exact = 9e3 * x + 700.0 * np.gradient(x, TIME)
    noise = 0.1 * np.random.default_rng(0).standard_normal(x.size)
    assert along_recording(DAMPER, [recording(x, exact + noise)]).left == pytest.approx(0.0, abs=0.01)


def test_a_motion_beyond_what_was_covered_is_said() -> None:
    far, fast = along_recording(DAMPER, [recording(stroke(2e-2))]).notes
    assert "the motion goes to 0.02 m, and damper was identified up to 0.006 m" in far
    assert "the speed goes to 0.251 m/s, and damper was identified up to 0.1 m/s" in fast
    damper = ForceElement(DAMPER)
    with pytest.warns(UserWarning, match="up to 0.1 m/s: beyond that it is an extrapolation"):
        assert damper.force(2 * stroke(5e-3), FS).shape == TIME.shape
    assert damper.force(stroke(5e-3), "200 Hz") == pytest.approx(damper.force(stroke(5e-3), FS))


def test_it_is_said_in_the_unit_as_recorded() -> None:
    recorded = replace(DAMPER.identified, recordings=({"file": "a.csv", "unit": "mm"},))
    far, _ = along_recording(replace(DAMPER, identified=recorded), [recording(stroke(2e-2))]).notes
    assert "the motion goes to 20 mm, and damper was identified up to 6 mm" in far


@pytest.mark.parametrize(
    ("motion", "fs", "words"),
    [
        (stroke(1e-3), "1 furlong", "such as '1 kHz'"),
        (stroke(1e-3), 0.0, "fs is 0"),
        ([0.0, 1.0, np.nan, 0.0, 1.0], 1.0, "1 value.s. that are not a number, the first at place 2"),
        ([0.0, 1.0], 1.0, "at least four numbers"),
    ],
)
def test_what_is_no_motion_is_refused(motion: np.ndarray, fs: float, words: str) -> None:
    with pytest.raises(dashpot.BadInput, match=words):
        ForceElement(DAMPER).force(motion, fs)


def test_another_unit_is_refused() -> None:
    (turned,) = dashpot.read({"time_s": TIME, "angle_rad": stroke(0.1)}, prescribed="angle_rad")
    with pytest.raises(dashpot.BadInput, match="the motion is in rad, and damper has it in m"):
        along_recording(DAMPER, [turned])
