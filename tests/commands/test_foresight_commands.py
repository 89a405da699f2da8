"""``check``, ``plan`` and ``prove-on`` as they are typed: what they print, and with which exit code they end."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.model import Oscillator
from dashpot.model.file import dumps


@pytest.fixture
def ended(capsys):
    """``ended("check", "a.csv")``: exit code, stdout, stderr."""

    def run(*arguments):
        code = 0
        try:
            cli.main([str(argument) for argument in arguments])
        except SystemExit as stop:
            code = stop.code if isinstance(stop.code, int) else 1
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def folder(tmp_path):
    """A release with noise of 20 µm, and a model."""
    release = recording_of(TRUTH, begin=(5e-3, 0.0), seconds=4.0, noise=2e-5)
    time = np.arange(release.n) / release.fs
    table = np.column_stack([time, 1e3 * release.response])
    np.savetxt(tmp_path / "release.csv", table, "%.9g", ",", header="time_s,x_mm", comments="")
    rig = Oscillator.from_values({**TRUTH, "mass": None}, name="rig")
    (tmp_path / "rig.yaml").write_text(dumps(rig), encoding="utf-8")
    return tmp_path


def test_a_check_is_a_table_or_json(ended, folder):
    code, out, _ = ended("check", folder / "release.csv")
    assert code == 0
    assert "noise 20 µm" in out or "noise 21 µm" in out or "noise 19 µm" in out
    assert "omega0" in out
    code, out, _ = ended("check", folder / "release.csv", "--mass", "0.27", "--json", "-q")
    data = json.loads(out)
    assert code == 0
    assert data["parameters"]["mass"]["state"] == "given"
    assert data["machine"]["stiffness"]["value"] == pytest.approx(0.27 * TRUTH["omega0"] ** 2, rel=0.02)


def test_a_check_of_no_motion_is_refused(ended, tmp_path):
    still = np.column_stack([np.arange(400) / 100.0, np.ones(400)])
    np.savetxt(tmp_path / "still.csv", still, "%.9g", ",", header="time_s,x_mm", comments="")
    code, _, err = ended("check", tmp_path / "still.csv")
    assert code == 2
    assert "throughout" in err


def test_a_plan_that_tells_ends_well(ended, folder):
    how = ("--noise", "20um", "--most-amplitude", "5mm", "--tries", 0, "--test", "decay")
    code, out, _ = ended("plan", folder / "rig.yaml", "--want", "viscous 1%", *how)
    assert code == 0
    assert out.startswith("Release it from ")
    assert "Expected of viscous" in out
    code, out, _ = ended("plan", folder / "rig.yaml", "--want", "viscous 1%", *how, "--json", "-q")
    assert json.loads(out)["tells"] is True


def test_a_plan_that_does_not_is_bad_news(ended, folder):
    how = ("--like", folder / "release.csv", "--most-amplitude", "0.1mm", "--most-seconds", 10, "--tries", 0)
    code, out, _ = ended("plan", folder / "rig.yaml", "--want", "cubic 0.1%", *how)
    assert code == 1
    assert "No test within the limits tells what is wanted" in out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--want", "cubi 1%", "--noise", "1um", "--most-amplitude", "5mm"), "did you mean cubic"),
        (("--want", "cubic 1%", "--most-amplitude", "5mm"), "how much noise the sensor has is not known"),
        (("--want", "cubic 1%", "--noise", "1um"), "how far it may move is not known"),
        (("--want", "cubic 1%", "--noise", "1N", "--most-amplitude", "5mm"), "N is no unit of it"),
    ],
)
def test_what_a_plan_needs_is_asked_for(ended, folder, arguments, says):
    code, _, err = ended("plan", folder / "rig.yaml", *arguments)
    assert code == 2
    assert says in err


def test_a_release_has_no_force_to_write(ended, folder):
    how = ("--noise", "20um", "--most-amplitude", "5mm", "--tries", 0, "-o", folder / "force.csv")
    code, _, err = ended("plan", folder / "rig.yaml", "--want", "viscous 1%", *how)
    assert code == 2
    assert "plays no force" in err
    assert not (folder / "force.csv").exists()


def test_a_proof_on_a_rig_says_who_simulated(ended, folder):
    how = ("--noise", "20um", "--most-amplitude", "5mm", "--runs", 2)
    code, out, _ = ended("prove-on", folder / "rig.yaml", *how)
    assert code == 0
    assert "shares no code with the engine" in out
    assert out.rstrip().endswith("The errors hold.")
    code, _, err = ended("prove-on", folder / "rig.yaml", *how, "--hide", "quadratic-drag")
    assert code == 2
    assert "no law 'quadratic-drag' in it to hide" in err
