"""Linear models: tangents, trim, and about a motion the closed forms of Krylov and Bogoliubov."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from dashpot.commands.cli import cli
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Range, Response, oscillator_with
from dashpot.model.file import save
from dashpot.model.linear import as_json, linearise

M, W0, C3, P, D1, D0 = (TRUTH[name] for name in ("mass", "omega0", "cubic", "preload", "viscous", "dry"))


@pytest.fixture
def model():
    return Oscillator.from_values(TRUTH, name="stand")


def test_about_a_motion_spring_and_damper_are_the_closed_forms(model):
    amplitude = 5e-4
    linear = linearise(model, amplitude=amplitude)
    k = W0**2 + 0.75 * C3 * amplitude**2 + 4 * P / (math.pi * amplitude)
    d = D1 + 4 * D0 / (math.pi * math.sqrt(k) * amplitude)
    assert pytest.approx(np.array([[0, 1], [-k, -d]]), rel=1e-9) == linear.A
    assert pytest.approx(np.array([[0], [1 / M]]), rel=1e-12) == linear.B
    assert pytest.approx(np.array([[1, 0], [1, 0], [0, 1], [-k, -d]]), rel=1e-9) == linear.C
    assert linear.D.ravel() == pytest.approx([0, 0, 0, 1 / M], rel=1e-12)
    assert linear.omega == pytest.approx(math.sqrt(k), rel=1e-9)
    slow = linearise(model, amplitude=amplitude, frequency=2.0)
    assert -slow.A[1, 1] == pytest.approx(D1 + D0 / (math.pi**2 * amplitude), rel=1e-9)


def test_an_amplitude_that_no_recording_covered_is_told(model):
    covered = replace(model, amplitude=Range(1e-4, 9e-3, "m"))
    assert linearise(covered, amplitude=9e-3).notes == ()
    assert "0.0001 m to 0.009 m" in linearise(covered, amplitude=1e-2).notes[0]


def test_about_a_point_it_is_the_tangent_and_the_force_that_holds_it(model):
    x = -4e-3
    linear = linearise(model, displacement=x)
    held = M * (W0**2 * x + C3 * x**3 - P)
    assert linear.input == pytest.approx(held, rel=1e-12)
    assert linear.A[1] == pytest.approx([-(W0**2) - 3 * C3 * x**2, -D1], rel=1e-12)
    assert linear.output == pytest.approx([x, x, 0, 0], abs=1e-12)
    assert linearise(model, force=held).state[0] == pytest.approx(x, rel=1e-9)
    assert linearise(model, force=0.5 * M * P).state[0] == 0.0  # less than the preload does not leave the seat
    assert "dry and preload" in linearise(model).notes[0]


def test_inner_states_settle_and_the_actuator_stays_in_the_model():
    values = {"actuator-lag.time": 2e-3, "viscoelastic.stiffness": 100.0, "viscoelastic.rate": 50.0}
    model = oscillator_with(TRUTH | values, effects=("actuator-lag", "viscoelastic"))
    point = linearise(model, force=3.0)
    x = point.state[0]
    assert point.state == pytest.approx([x, 0, 3.0, x], rel=1e-9)  # the branch has relaxed, the force has arrived
    assert M * (W0**2 * x + C3 * x**3 + P) == pytest.approx(3.0, rel=1e-9)
    about = linearise(model, amplitude=1e-3)
    assert about.state_names == ("displacement", "velocity", "actuator-lag.force")
    w = about.omega
    assert w is not None
    k = W0**2 + 0.75 * C3 * 1e-6 + 4 * P / (math.pi * 1e-3) + 100 * w**2 / (w**2 + 50**2)
    assert -about.A[1, 0] == pytest.approx(k, rel=1e-6)
    assert about.A[2] == pytest.approx([0, 0, -500.0])
    assert about.notes == ("actuator-lag: by the tangent at rest, whatever the amplitude",)


def test_an_actuator_with_a_dead_zone_must_be_pushed_through_it_and_a_hum_is_no_part_of_the_rig():
    values = {"tonal-disturbance.amplitude": 1.0, "tonal-disturbance.frequency": 314.0}
    values["actuator-dead-zone.threshold"] = 0.3
    model = oscillator_with(TRUTH | values, effects=("actuator-dead-zone", "tonal-disturbance"))
    point = linearise(model, displacement=2e-3)
    assert point.state_names == ("displacement", "velocity")
    assert point.input == pytest.approx(0.3 + M * (W0**2 * 2e-3 + C3 * 8e-9 + P), rel=1e-12)


def test_the_discrete_pair_is_the_closed_form_of_an_undamped_spring():
    values = {"omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
    linear = linearise(Oscillator.from_values(values, response=Response("acceleration", "m/s2")))
    a, b = linear.discrete(0.01)
    c, s = math.cos(0.8), math.sin(0.8)
    assert a == pytest.approx(np.array([[c, s / 80], [-80 * s, c]]), rel=1e-12)
    assert b.ravel() == pytest.approx([(1 - c) / 6400, s / 80], rel=1e-12)
    assert linear.C[0] == pytest.approx([-6400, 0])  # the acceleration is what is recorded
    assert linear.D[0] == pytest.approx([1])
    assert linear.input_unit == "m/s2"


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({"frequency": 5.0}, "without an amplitude"),
        ({"amplitude": 1e-3, "force": 1.0}, "give one of them"),
        ({"force": 1.0, "displacement": 1e-3}, "follow from each other"),
        ({"amplitude": -1e-3}, "above zero"),
        ({"amplitude": 1e-3, "frequency": 0.0}, "0 Hz: give a positive number"),
        ({"displacement": math.nan}, "finite"),
    ],
)
def test_what_is_no_motion_and_no_point_is_refused(model, about, words):
    with pytest.raises(BadInput, match=words):
        linearise(model, **about)


def test_a_spring_that_gives_way_holds_no_force_and_no_motion():
    soft = Oscillator.from_values(TRUTH | {"cubic": -1e8, "dry": 0.0})
    with pytest.raises(BadInput, match="holds no force"):
        linearise(soft, force=1e3)
    with pytest.raises(BadInput, match="no motion of its own"):
        linearise(soft, amplitude=0.1)


def test_the_command_prints_what_python_gives(model, tmp_path):
    save(model, tmp_path / "rig.yaml")
    arguments = ["linearise", str(tmp_path / "rig.yaml"), "--amplitude", "5e-4", "--step", "0.001"]
    found = json.loads(CliRunner().invoke(cli, [*arguments, "--json"]).output)
    linear = linearise(model, amplitude=5e-4)
    assert found["A"] == linear.A.tolist()
    assert found["discrete"]["A"] == linear.discrete(1e-3)[0].tolist()
    assert found["about"]["frequency_hz"] == pytest.approx(linear.omega / (2 * math.pi))
    words = CliRunner().invoke(cli, arguments).output
    assert "about a motion of amplitude 0.0005 m at 12.8573 Hz" in words
    assert "B, 0.001 s, the force held" in words
    assert isinstance(CliRunner().invoke(cli, [*arguments[:-1], "0"]).exception, BadInput)


def test_poles_come_first_with_frequency_and_damping():
    linear = linearise(Oscillator.from_values(TRUTH), amplitude=1e-3)
    pole = linear.poles[1]
    assert pole.imag > 0
    ratio = -pole.real / abs(pole)
    text = repr(linear)
    assert f"{abs(pole) / 2 / math.pi:.6g} Hz, damping ratio {ratio:.4g}" in text
    assert text.index("damping ratio") < text.index("A =")
    assert as_json(linear)["poles"][0]["frequency_hz"] == pytest.approx(abs(pole) / 2 / math.pi)
    slow = linearise(oscillator_with({**TRUTH, "sensor-lag.time": 0.5}, effects=("sensor-lag",)), amplitude=1e-3)
    assert "pole -2 1/s, time constant 0.5 s" in repr(slow)


def test_scipy_and_control_have_the_same_response():
    from scipy.signal import StateSpace

    linear = linearise(Oscillator.from_values(TRUTH), amplitude=1e-3)
    system = linear.to_scipy()
    assert isinstance(system, StateSpace)
    sampled = system.to_discrete(1e-3)
    for theirs, ours in zip((sampled.A, sampled.B), linear.discrete(1e-3), strict=True):
        assert theirs == pytest.approx(ours, rel=1e-9)
    n = linear.A.shape[0]
    wanted = linear.C @ np.linalg.solve(40j * np.eye(n) - linear.A, linear.B) + linear.D
    pytest.importorskip("control", reason="python-control is not installed")
    theirs = linear.to_control()
    assert theirs(40j).ravel() == pytest.approx(wanted.ravel(), rel=1e-9)
    assert (theirs.state_labels, theirs.input_labels) == (list(linear.state_names), ["F"])


def test_without_control_it_is_said(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(BadInput, match=r"pip install control, or take to_scipy\(\)"):
        linearise(Oscillator.from_values(TRUTH), amplitude=1e-3).to_control()


def test_amplitude_frequency_and_force_have_units_of_their_own():
    model = Oscillator.from_values(TRUTH, name="stand")
    assert np.array_equal(
        linearise(model, amplitude="1 mm", frequency="12 Hz").A, linearise(model, amplitude=1e-3, frequency=12.0).A
    )
    assert np.array_equal(linearise(model, force="1000 mN").A, linearise(model, force=1.0).A)
    with pytest.raises(BadInput, match="amplitude is '1 N', and N is no unit of it; give it in m"):
        linearise(model, amplitude="1 N")
