"""A model as a joint of MuJoCo and URDF and as damping of a HydroDyn platform: numbers, and what is left out."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from click.testing import CliRunner
from dashpot.commands.cli import cli
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.export import export, files
from dashpot.export.joint import joint_of, left_out
from dashpot.model import Oscillator, Range, Response, oscillator_with
from dashpot.model.file import save
from dashpot.simulate.core import core_of, internal_step

MASS = TRUTH["mass"]
DRAG = {"quadratic-drag.coefficient": 6.0}


def model(*effects, response=("displacement", "m"), force="N", **changed):
    values = dict(TRUTH) | changed
    return oscillator_with(values, name="rig", effects=effects, response=Response(*response), force_unit=force)


def roll(**changed):
    return model("quadratic-drag", response=("displacement", "rad"), force="N.m", **DRAG, **changed)


def test_the_terms_are_forces_of_the_machine():
    joint = joint_of(model("quadratic-drag", **DRAG))
    assert joint.inertia == MASS
    assert joint.stiffness == pytest.approx(MASS * TRUTH["omega0"] ** 2)
    assert joint.cubic == pytest.approx(MASS * 4.6e5)
    assert joint.preload == pytest.approx(0.02)
    assert joint.damping == pytest.approx(MASS * 5.0)
    assert joint.friction == pytest.approx(MASS * 0.015)
    assert joint.quadratic == pytest.approx(MASS * 6.0)
    assert not joint.rotates
    assert joint_of(roll()).rotates


def test_a_model_without_a_mass_or_in_volts_is_refused():
    with pytest.raises(BadInput, match="mass is not known"):
        joint_of(model(mass=None))
    with pytest.raises(BadInput, match="displacement is in V"):
        joint_of(model(response=("displacement", "V")))
    with pytest.raises(BadInput, match=r"force in N, and a joint takes m and N, or rad and N\.m"):
        joint_of(model(response=("displacement", "rad")))


def test_every_term_is_in_the_file_or_named(tmp_path):
    """Each term alone, in each program: written as a number, or said to be left out, with its size and unit."""
    said = {}
    for suffix in (".mjcf", ".urdf", ".hydrodyn"):
        notes = []
        rig = model(
            "quadratic-drag",
            "stribeck",
            **DRAG,
            **dict.fromkeys(("stribeck.excess", "stribeck.speed"), 0.01),
            **{"stribeck.exponent": 2.0},
        )
        (path,) = export(
            rig, tmp_path / f"rig{suffix}", dof="heave" if suffix == ".hydrodyn" else None, progress=notes.append
        )
        said[suffix] = "\n".join(notes)
        text = path.read_text("utf-8")
        assert text.count("LEFT OUT") == len(notes)
        assert all(note.partition(": ")[2] in text for note in notes)
        for name in ("damping", "quadratic", "friction", "cubic", "preload", "stiffness"):
            value = getattr(joint_of(rig), name)
            written = any(shown in text for shown in (repr(value), f"{value:.8g}"))
            assert written or "no place for" in said[suffix], name
    assert "preload of 0.02 N" in said[".mjcf"]
    assert "cubic" not in said[".mjcf"]
    assert "cubic spring of 1.24·10⁵ N/m³" in said[".urdf"]
    assert "dry friction of 0.00405 N" in said[".hydrodyn"]
    assert all("(stribeck)" in words for words in said.values())


def test_what_is_left_out_of_a_spring_is_told_beside_the_linear_one():
    rig = model()
    rig = Oscillator(**{**rig.__dict__, "amplitude": Range(1e-4, 9e-3, "m")})
    (cubic, preload) = left_out(joint_of(rig), {"inertia", "stiffness", "damping", "friction"}, "X")
    assert cubic.endswith(
        f"{100 * 4.6e5 * 9e-3**2 / TRUTH['omega0'] ** 2:.2g} % of the linear spring's force at the "
        "largest amplitude identified, 0.009 m"
    )
    share = 100 * TRUTH["preload"] / (TRUTH["omega0"] ** 2 * 9e-3)
    assert f"preload of 0.02 N, {share:.2g} % of the linear spring's force" in preload


def test_hydrodyn_gets_six_rows_each_and_the_number_in_its_place(tmp_path):
    (path,) = export(roll(), tmp_path / "rig.hydrodyn", dof="roll")
    lines = path.read_text("utf-8").partition("-----\n")[2].splitlines()
    rows = [[float(word) for word in line.split("Add")[0].split()] for line in lines]
    f0, matrices = np.array(rows[:6]), np.array(rows[6:]).reshape(3, 6, 6)
    linear, drag = np.zeros((6, 6)), np.zeros((6, 6))
    linear[3, 3], drag[3, 3] = MASS * 5.0, MASS * 6.0
    assert np.all(f0 == 0)
    np.testing.assert_allclose(matrices, [np.zeros((6, 6)), linear, drag], rtol=1e-7)
    assert [re.search(r"Add\w+", lines[i])[0] for i in (0, 6, 12, 18)] == ["AddF0", "AddCLin", "AddBLin", "AddBQuad"]


@pytest.mark.parametrize(("dof", "words"), [(None, "--dof roll, pitch or yaw"), ("heave", "the model is no heave")])
def test_hydrodyn_is_told_which_motion(tmp_path, dof, words):
    with pytest.raises(BadInput, match=words):
        export(roll(), tmp_path / "rig.hydrodyn", dof=dof)


def test_a_file_of_the_users_own_is_not_written_over(tmp_path):
    (tmp_path / "robot.urdf").write_text("<robot/>")
    with pytest.raises(BadInput, match="was not made by dashpot"):
        export(model(), tmp_path / "robot.urdf")
    export(model(), tmp_path / "mine.xml", form="urdf")
    assert files(tmp_path / "mine.xml", "urdf") == (tmp_path / "mine.xml",)
    export(model(), tmp_path / "mine.xml", form="mujoco")


def test_the_command_says_what_is_left_out(tmp_path):
    save(model(), tmp_path / "rig.yaml")
    line = ["export", str(tmp_path / "rig.yaml"), str(tmp_path / "rig.xml"), "--as", "urdf"]
    ended = CliRunner().invoke(cli, line)
    assert ended.exit_code == 0
    assert "URDF has no place for the linear spring of 1.71·10³ N/m" in ended.stderr
    robot = ElementTree.parse(tmp_path / "rig.xml").getroot()
    dynamics = robot.find("joint/dynamics")
    assert dynamics is not None
    assert float(dynamics.attrib["damping"]) == pytest.approx(MASS * 5.0)
    assert float(dynamics.attrib["friction"]) == pytest.approx(MASS * 0.015)


# MuJoCo itself -------------------------------------------------------------------------------------------------------


def decay(rig, seconds, begin, dt=5e-4):
    core, values = core_of(rig), rig.values()
    n = round(seconds / dt) + 1
    numbers = np.array([values[name] for name in core.parameter_names])
    return core.record(numbers, np.array([begin, 0.0]), None, n, dt, internal_step(rig, values, abs(begin)))


def in_mujoco(mujoco, path, seconds, begin, dt=5e-4, fine=10):
    machine = mujoco.MjModel.from_xml_path(str(path))
    machine.opt.timestep = dt / fine
    machine.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(machine)
    data.qpos[0] = begin
    response = [begin]
    for _ in range(round(seconds / dt)):
        for _ in range(fine):
            mujoco.mj_step(machine, data)
        response.append(float(data.qpos[0]))
    return np.array(response)


@pytest.mark.parametrize("rotates", [False, True])
def test_mujoco_decays_as_the_model_does(tmp_path, rotates):
    """All terms that MuJoCo has, smooth ones: the same decay to 1e-5 of its start."""
    mujoco = pytest.importorskip("mujoco", reason="pip install mujoco, 3.7 or newer")
    if not hasattr(mujoco.MjModel, "jnt_stiffnesspoly"):
        pytest.skip("this MuJoCo is older than 3.7 and has no polynomial springs")
    effects = ("quadratic-drag", "cubic-damping", "quadratic-stiffness")
    more = {**DRAG, "cubic-damping.coefficient": 3.0, "quadratic-stiffness.coefficient": 5e4}
    unit, force = ("rad", "N.m") if rotates else ("m", "N")
    rig = model(*effects, response=("displacement", unit), force=force, dry=0.0, preload=0.0, **more)
    (path,) = export(rig, tmp_path / "rig.mjcf")
    ours, theirs = decay(rig, 1.5, 8e-3), in_mujoco(mujoco, path, 1.5, 8e-3)
    assert np.max(np.abs(theirs - ours)) < 1e-5 * 8e-3


@pytest.mark.parametrize("rotates", [False, True])
def test_mujoco_knows_friction_softly(tmp_path, rotates):
    """Dry friction is a soft constraint there: as near as that lets it be, 1 % of the start, while the rig moves."""
    mujoco = pytest.importorskip("mujoco", reason="pip install mujoco, 3.7 or newer")
    if not hasattr(mujoco.MjModel, "jnt_stiffnesspoly"):
        pytest.skip("this MuJoCo is older than 3.7 and has no polynomial springs")
    unit, force = ("rad", "N.m") if rotates else ("m", "N")
    rig = model(response=("displacement", unit), force=force, preload=0.0, dry=0.15)
    (path,) = export(rig, tmp_path / "rig.mjcf")
    ours, theirs = decay(rig, 0.5, 8e-3), in_mujoco(mujoco, path, 0.5, 8e-3)
    frictionless = decay(model(preload=0.0, dry=0.0), 0.5, 8e-3)
    assert np.max(np.abs(theirs - ours)) < 0.01 * 8e-3 < np.max(np.abs(frictionless - ours))


def test_a_constant_force_is_a_shifted_spring_where_that_is_linear(tmp_path):
    mujoco = pytest.importorskip("mujoco", reason="pip install mujoco")
    rig = model("constant-force", cubic=0.0, preload=0.0, dry=0.0, **{"constant-force.load": 2.0})
    notes = []
    (path,) = export(rig, tmp_path / "rig.mjcf", progress=notes.append)
    assert notes == []
    rest = in_mujoco(mujoco, path, 4.0, 0.0, dt=2e-3, fine=2)[-1]
    assert rest == pytest.approx(2.0 / TRUTH["omega0"] ** 2, rel=1e-3)
    bent = model("constant-force", preload=0.0, dry=0.0, **{"constant-force.load": 2.0})
    export(bent, tmp_path / "bent.mjcf", progress=notes.append)
    assert "the constant force of 0.54 N" in notes[0]


def test_mujoco_reads_the_urdf(tmp_path):
    mujoco = pytest.importorskip("mujoco", reason="pip install mujoco")
    for rig, place in ((model(), "rig.urdf"), (roll(), "roll.urdf")):
        (path,) = export(rig, tmp_path / place)
        machine = mujoco.MjModel.from_xml_path(str(path))
        assert machine.dof_damping[0] == pytest.approx(MASS * 5.0)
        assert machine.dof_frictionloss[0] == pytest.approx(MASS * 0.015)
        data = mujoco.MjData(machine)
        mujoco.mj_forward(machine, data)
        data.qfrc_applied[0] = 1.0
        mujoco.mj_forward(machine, data)
        assert data.qacc[0] == pytest.approx((1.0 - MASS * 0.015) / MASS, rel=0.01)
