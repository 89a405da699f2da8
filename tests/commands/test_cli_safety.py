"""What a command must never do: overwrite its input, leave litter, take the working folder away, or run for ever."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.model import Oscillator, Response
from dashpot.model.file import load, save
from dashpot.recording import Recording
from dashpot.recording.checks import check
from scipy.interpolate import CubicSpline

FS, N = 500.0, 4000


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """A sweep, a model and its FMU, to copy from."""
    folder = tmp_path_factory.mktemp("made")
    pieces = chirp(1.0, 8.0, 10.0 * FS / N, np.arange(N) / FS, 1 / FS)
    x = integrate_pieces(TRUTH, pieces, 1 / FS, 0.0, 0.0)[0][:N] + 1e-6 * np.random.default_rng(4).standard_normal(N)
    columns = np.column_stack([np.arange(N) / FS, pieces[:N, 0], x])
    np.savetxt(folder / "sweep.csv", columns, "%.9g", ",", header="time_s,force_N,displacement_m", comments="")
    oscillator = Oscillator.from_values(TRUTH, name="rig")
    save(oscillator, folder / "rig.yaml")
    export_fmu(oscillator, folder / "rig.fmu")
    return folder


@pytest.fixture
def here(made, tmp_path, monkeypatch):
    """The working folder, with copies."""
    for file in made.iterdir():
        shutil.copy(file, tmp_path / file.name)
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    (tmp_path / "circle.c").symlink_to("circle.c")
    text = (tmp_path / "rig.yaml").read_text(encoding="utf-8")
    for name, old, new in (("stiff", "460000.0", "1.0e+30"), ("large", "79.60795784196536", "1.0e+200")):
        (tmp_path / f"{name}.yaml").write_text(text.replace(old, new), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


def refused(capsys, folder, *arguments):
    """The one line that a refusal puts on stderr; everything in the folder is as it was."""
    before = contents(folder)
    with pytest.raises(SystemExit) as stop:
        cli.main(list(arguments))
    out, err = capsys.readouterr()
    assert stop.value.code == 2, err
    assert all(line.startswith("[ERROR] fmi2") for line in out.splitlines())  # an FMU's own words, which FMPy prints
    assert contents(folder) == before
    assert Path.cwd() == folder
    lines = [line for line in err.splitlines() if not line.startswith("note: ")]
    assert lines[0].startswith("dashpot: ")
    assert len(lines) == 1
    assert "Traceback" not in err
    return lines[0]


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("identify sweep.csv -o sweep.csv", "is an input"),
        ("identify sweep.csv -o ./sub/../sweep.csv", "is an input"),
        ("identify sweep.csv -o new/a.yaml --report new/a.yaml", "written twice"),
        ("identify sweep.csv sweep.csv -o new/a.yaml", "given twice"),
        ("identify sweep.csv -o file/a.yaml", "cannot be written"),
        ("identify missing.csv -o new/deep/a.yaml", "does not exist"),
        (f"identify sweep.csv -o {'x' * 300}.yaml", "too long"),
        ("identify sweep.csv -o new/a.yaml --fs abc", "not a valid float; see dashpot identify -h"),
        ("identify sweep.csv", "Missing option '-o'"),
        ("simulate rig.yaml sweep.csv -o sweep.csv", "is an input"),
        ("simulate rig.yaml sweep.csv -o rig.yaml", "end the name in .csv"),
        ("export rig.yaml new/a.fmu new/a.xyz", "cannot tell what to make"),
        ("export rig.yaml new/a.fmu new/a.fmu", "written twice"),
        ("export rig.yaml new/a.casadi --step 1e9", "does not suit an oscillation of 0.0789 s"),
        ("export rig.yaml new/a.casadi --step 1e-300", "does not suit an oscillation of 0.0789 s"),
        ("export rig.yaml new/a.fmu --fmi 7", "see dashpot export -h"),
        ("verify rig.fmu sweep.csv --json rig.fmu", "is an input"),
        ("verify rig.fmu sweep.csv --json sweep.csv", "is an input"),
        ("verify file sweep.csv", "not a readable FMU"),
        ("verify rig.yaml sweep.csv", "is no FMU; make one of a model file with: dashpot export"),
        ("demo -o file", "cannot be written"),
        ("diagnoze rig.yaml", "No such command"),
        ("export rig.yaml circle.c", "is a link that leads to itself"),
        ("look sweep.csv --max-size nan", "nan is not in the range"),
        ("verify rig.fmu sweep.csv --time-limit nan", "nan is not in the range"),
        ("batch fleet.yaml -o new --time-limit nan", "nan is not in the range"),
        ("identify sweep.csv -o new/a.yaml --mass inf", "parameter 'mass' is inf; it must be a finite"),
        ("identify sweep.csv -o new/a.yaml --mass nan", "parameter 'mass' is nan; it must be a finite"),
        ("identify sweep.csv -o new/a.yaml --fix dry=nan", "parameter 'dry' is nan; it must be a finite number"),
        ("identify sweep.csv -o new/a.yaml --fix omega0=-5", "parameter 'omega0' must be greater than 0, not -5"),
        ("identify sweep.csv -o new/a.yaml --fix dry=1 --fix dry=2", "'dry' is fixed twice; give it one value"),
        ("simulate stiff.yaml sweep.csv -o new/a.csv", "more than 1e+08 for 8 s; check units and parameters"),
        ("show large.yaml", "$.omega0.value: must be at most 1e+100, but is 1e+200"),
    ],
)
def test_nothing_is_written_or_lost(capsys, here, command, says):
    assert says in refused(capsys, here, *command.split())


def test_a_link_to_the_input_is_the_input(capsys, here):
    (here / "link.csv").symlink_to(here / "sweep.csv")
    assert "is an input" in refused(capsys, here, "identify", "sweep.csv", "-o", "link.csv")


def changed(source, target, edit):
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            data = edit(name, old.read(name))
            if data is not None:
                new.writestr(name, data)


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda name, data: None if name.startswith("binaries") else data, "does not load on this machine"),
        (lambda name, data: b"junk" if name.startswith("binaries") else data, "does not load on this machine"),
        (lambda name, data: None if name.endswith(".xml") else data, "not a readable FMU"),
        (lambda name, data: b"<a>" if name.endswith(".xml") else data, "not a readable FMU"),
        (lambda name, data: data.replace(b'guid="{', b'guid="{0'), "does not load on this machine"),
        (lambda name, data: data.replace(b'name="F"', b'name="G"'), "needs an input named F"),
        (lambda name, data: data.replace(b'fmiVersion="2.0"', b'fmiVersion="1.0"'), "this one is of FMI 1.0"),
    ],
)
def test_a_broken_fmu_leaves_the_working_folder_as_it_was(capsys, here, edit, says):
    """FMPy changes to the folder of the library that it loads, which is removed when that fails."""
    changed(here / "rig.fmu", here / "broken.fmu", edit)
    assert says in refused(capsys, here, "verify", "broken.fmu", "sweep.csv")


def test_a_truncated_fmu(capsys, here):
    (here / "broken.fmu").write_bytes((here / "rig.fmu").read_bytes()[:9000])
    assert "not a readable FMU" in refused(capsys, here, "verify", "broken.fmu", "sweep.csv")


def test_a_recording_of_another_unit_is_not_compared(capsys, here):
    text = (here / "sweep.csv").read_text(encoding="utf-8")
    (here / "volts.csv").write_text(text.replace("displacement_m", "lvdt_V", 1), encoding="utf-8")
    line = refused(capsys, here, "verify", "rig.fmu", "volts.csv")
    assert "records displacement in V" in line
    assert "gives x in m" in line


def test_a_force_moves_no_model_without_a_mass(capsys, here):
    """It would be taken for one per unit mass."""
    values = {name: value for name, value in TRUTH.items() if name != "mass"}
    save(Oscillator.from_values(values, name="light"), here / "light.yaml")
    export_fmu(load(here / "light.yaml"), here / "light.fmu")
    assert "has no mass to tell" in refused(capsys, here, "simulate", "light.yaml", "sweep.csv", "-o", "a.csv")
    line = refused(capsys, here, "verify", "light.fmu", "sweep.csv")
    assert "is in N" in line
    assert "in m/s2: the mass was not identified" in line
    t = np.arange(N) / FS
    decay = integrate_pieces(TRUTH, np.zeros((N, 2)), 1 / FS, 8e-3, 0.0)[0][:N]
    random = np.random.default_rng(5)
    columns = np.column_stack([t, 1e-3 * random.standard_normal(N), decay + 1e-6 * random.standard_normal(N)])
    np.savetxt("decay.csv", columns, "%.9g", ",", header="time_s,force_N,displacement_m", comments="")
    cli.main(["simulate", "light.yaml", "decay.csv", "-o", "free.csv"])
    shown = np.loadtxt("free.csv", delimiter=",", skiprows=1)
    assert np.std(shown[:, -1] - decay) < 1e-2 * np.std(decay)


def test_a_force_of_the_wrong_sign_is_refused(capsys, here):
    t, force, x = np.loadtxt("sweep.csv", delimiter=",", skiprows=1).T
    np.savetxt("turned.csv", np.column_stack([t, -force, x]), "%.9g", ",", header="time_s,force_N,x_m", comments="")
    assert "the force takes work out" in refused(capsys, here, "identify", "turned.csv", "-o", "new/a.yaml")


def test_an_acceleration_taken_for_a_displacement_is_found_out(made):
    _, force, x = np.loadtxt(made / "sweep.csv", delimiter=",", skiprows=1).T
    acceleration = np.gradient(np.gradient(x, 1 / FS), 1 / FS)
    recording = Recording(name="a", fs=FS, response=acceleration, force=force, quantity="displacement", unit="V")
    assert any("takes work out" in problem.sentence for problem in check(recording))


def test_a_free_decay_under_a_noisy_force_channel_has_no_sign(made):
    random = np.random.default_rng(9)
    decay = integrate_pieces(TRUTH, np.zeros((2000, 2)), 1 / FS, 8e-3, 0.0)[0][:2000]
    for _ in range(20):
        noise = 1e-3 * random.standard_normal(2000)
        recording = Recording(name="a", fs=FS, response=decay, force=noise)
        assert not [p for p in check(recording) if "takes work out" in p.sentence]


def test_the_step_may_be_half_a_cycle(here):
    oscillator = Oscillator.from_values(TRUTH, name="v", response=Response("velocity", "m/s"))
    save(oscillator, here / "v.yaml")
    cli.main(["export", "v.yaml", "new/v.casadi", "--step", "0.039"])
    assert (here / "new" / "v.step.casadi").is_file()


def test_two_sensors_of_one_file_fit_one_model(capsys, here):
    t, force, x = np.loadtxt("sweep.csv", delimiter=",", skiprows=1).T
    # a central difference would lose a thousandth of the speed, and the recordings contradict each other
    columns = np.column_stack([t, force, x, CubicSpline(t, x).derivative()(t)])
    np.savetxt("both.csv", columns, "%.9g", ",", header="time_s,force_N,x_m,speed_m_s", comments="")
    both = ["--response", "x_m", "--response", "speed_m_s"]
    cli.main(["identify", "both.csv", "-o", "two.yaml", *both])
    assert [e["file"] for e in load("two.yaml").identified.recordings] == ["both.csv (x_m)", "both.csv (speed_m_s)"]
    capsys.readouterr()
    assert "2 responses" in refused(capsys, here, "identify", "both.csv", "-o", "n.yaml", *both, "--unit", "m")
    assert "one response" in refused(capsys, here, "simulate", "two.yaml", "both.csv", "-o", "o.csv", *both)
