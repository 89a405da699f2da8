"""The whole story on the built-in rig: what `make demo` makes, and that its figures are right."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from dashpot.examples.truth import TRUTH
from dashpot.face import demo
from dashpot.model.file import load

ROOT = Path(__file__).resolve().parents[2]


def test_the_target_calls_the_command():
    recipe = re.search(r"^demo:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)
    assert recipe
    assert "dashpot demo -o demo" in recipe.group(1)


@pytest.mark.long
def test_the_demo_proves_its_model_on_the_recording_that_was_held_out(tmp_path):
    said: list[str] = []
    assert demo.run(tmp_path / "demo", said.append)  # the FMU reproduces all recordings, the multisine among them
    files = {path.name for path in (tmp_path / "demo").iterdir()}
    assert {"model.yaml", "rig.fmu", "rig.casadi", "rig.step.casadi", "report.html"} <= files
    # the figures that the README promises of this rig, with room for a factor of three
    limits = {"mass": 6e-5, "omega0": 6e-5, "viscous": 6e-5, "cubic": 3e-3, "preload": 6e-4, "dry": 6e-4}
    for name, parameter in load(tmp_path / "demo" / "model.yaml").parameters().items():
        assert parameter.value == pytest.approx(TRUTH[name], rel=limits[name]), name
        assert abs(parameter.value - TRUTH[name]) < 4 * parameter.std, name
    page = (tmp_path / "demo" / "report.html").read_text("utf-8")
    assert "multisine.csv.gz" in page
    assert "Fig. 4" in page
    assert any("held" in line for line in said)
