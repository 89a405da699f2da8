"""The commands as they are typed: what they make, what they say, and what they leave behind when the input is bad."""

from __future__ import annotations

import gzip
import json
import os
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.model.file import dumps, load

FS = 500.0
NASTY = '"; system("touch owned"); //<evil attr=\'1\'>%s%n${x}{{7*7}}../..'


def run(capsys, *arguments):
    """Exit code, stdout, stderr of one command."""
    code = 0
    try:
        cli.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else 1
    out, err = capsys.readouterr()
    return code, out, err


def write(path, columns, header, delimiter=","):
    np.savetxt(path, np.column_stack(columns), "%.9g", delimiter, header=header, comments="")
    return path


@pytest.fixture(scope="session")
def signals():
    """A sweep and a decay of the reference rig, 12 s and 4 s, by the integrator that shares no code with dashpot."""
    random = np.random.default_rng(11)
    n, m = round(12 * FS), round(4 * FS)
    pieces = chirp(1.0, 8.0, 10.0 / 12, np.arange(n) / FS, 1 / FS)
    sweep = integrate_pieces(TRUTH, pieces, 1 / FS, 0.0, 0.0)[0][:n]
    decay = integrate_pieces(TRUTH, np.zeros((m, 2)), 1 / FS, 8e-3, 0.0)[0][:m]
    t = np.arange(n) / FS
    noise = 1e-6 * random.standard_normal(n + m)
    return {"t": t, "force": pieces[:n, 0], "sweep": sweep + noise[:n], "decay": decay + noise[n:]}


@pytest.fixture
def sweep(tmp_path, signals):
    return write(
        tmp_path / "sweep.csv", [signals["t"], signals["force"], signals["sweep"]], "time_s,force_N,displacement_m"
    )


@pytest.fixture
def decay(tmp_path, signals):
    m = signals["decay"].size
    return write(tmp_path / "decay.csv", [signals["t"][:m], 1e3 * signals["decay"]], "time_s,x_mm")


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "rig.yaml"
    path.write_text(dumps(Oscillator.from_values(TRUTH, name="rig")), encoding="utf-8")
    return path


# What works -----------------------------------------------------------------------------------------------------------


def test_every_command_of_the_design_has_its_help(capsys):
    code, out, _ = run(capsys, "--help")
    assert code == 0
    for command in ("demo", "identify", "show", "simulate", "export", "verify"):
        assert f"\n  {command} " in out
        assert run(capsys, command, "-h")[0] == 0
    for option in ("--time", "--force", "--response", "--quantity", "--unit", "--fs", "--part"):
        assert option in run(capsys, "identify", "-h")[1]


def test_from_recordings_to_a_proven_fmu(capsys, tmp_path, sweep, decay):
    made = tmp_path / "new folder" / "model.yaml"
    pages = ("--report", tmp_path / "r.html", "--figures", "png,svg")
    code, out, err = run(capsys, "identify", sweep, decay, "-o", made, "--name", "stand", *pages)
    assert code == 0, err
    drawn = sorted((tmp_path / "new folder" / "model-figures").iterdir())
    assert {"backbone.png", "stiffness.png", "recording-2.png", "backbone.svg"} <= {path.name for path in drawn}
    begins = {".png": b"\x89PNG", ".svg": b"<?xml"}
    assert all(path.read_bytes().startswith(begins[path.suffix]) and str(path) in err for path in drawn)
    assert "mass" in out
    assert "±" in out
    identified = load(made)
    assert identified.identified.command.startswith("dashpot identify ")
    assert identified.identified.command.endswith("--figures png,svg")
    for name, part in (("mass", 0.005), ("omega0", 0.005), ("viscous", 0.005), ("cubic", 0.03), ("preload", 0.05)):
        parameter = identified.parameters()[name]
        assert abs(parameter.value / TRUTH[name] - 1) < part
        assert abs(parameter.value - TRUTH[name]) < 4 * parameter.std
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")

    code, out, err = run(capsys, "export", made, tmp_path / "rig.fmu", tmp_path / "rig.casadi")
    assert code == 0, err
    files = ("--json", tmp_path / "v.json", "--report", tmp_path / "v.html")
    code, out, err = run(capsys, "verify", tmp_path / "rig.fmu", sweep, decay, *files)
    assert code == 0, out + err
    assert "The model reproduces all 2 recordings" in (tmp_path / "v.html").read_text(encoding="utf-8")
    result = json.loads((tmp_path / "v.json").read_text())
    assert list(result) == ["fmu", "recordings", "pass"]
    assert set(result["recordings"][0]) >= {"file", "nrmse", "noise_floor", "backbone_max_error_hz", "besides", "pass"}
    assert result["pass"] is True


def test_a_wrong_model_fails_the_proof_with_exit_code_1(capsys, tmp_path, sweep):
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(dumps(Oscillator.from_values(TRUTH | {"mass": 0.275})), encoding="utf-8")
    assert run(capsys, "export", wrong, tmp_path / "wrong.fmu")[0] == 0
    code, _, err = run(capsys, "verify", tmp_path / "wrong.fmu", sweep, "--figures", "svg")
    assert code == 2
    assert "name one with --report OUT.html or --json OUT.json" in err
    code, out, _ = run(
        capsys, "verify", tmp_path / "wrong.fmu", sweep, "--json", tmp_path / "v.json", "--figures", "svg"
    )
    assert code == 1
    assert (tmp_path / "v-figures" / "backbones-1.svg").read_bytes().startswith(b"<?xml")
    assert "does not reproduce sweep.csv; sweep.csv: an NRMSE of " in out


def test_plain_c_and_a_system_with_its_uncertainty(capsys, tmp_path, model, decay):
    code, _, err = run(capsys, "export", model, tmp_path / "rig.c", tmp_path / "rig.ssp")
    assert code == 0, err
    assert {"rig.c", "rig.h", "rig.ssp"} < {path.name for path in tmp_path.iterdir()}
    assert "note: rig: the model holds no covariance" in err
    assert run(capsys, "identify", decay, "-o", tmp_path / "m.yaml")[0] == 0
    code, _, err = run(capsys, "export", tmp_path / "m.yaml", tmp_path / "m.ssp", "--draws", 3, "--seed", 5)
    assert code == 0, err
    assert "note" not in err
    with zipfile.ZipFile(tmp_path / "m.ssp") as archive:
        assert "draw_3.ssd" not in archive.namelist()
        assert "draw_03.ssd" in archive.namelist()
    refused(capsys, tmp_path, "export", model, tmp_path / "b.ssp", "--draws", "3", says="holds no covariance")


def test_simulating_the_recorded_force(capsys, tmp_path, model, sweep, signals):
    code, _, err = run(capsys, "simulate", model, sweep, "-o", tmp_path / "out.csv.gz")
    assert code == 0, err
    with gzip.open(tmp_path / "out.csv.gz", "rt") as file:
        header = file.readline().strip()
        table = np.loadtxt(file, delimiter=",")
    assert header == "time_s,force_N,displacement_m,simulated_displacement_m"
    assert np.std(table[:, 3] - signals["sweep"]) < 1.2e-6


def test_show_prints_for_people_and_for_programs(capsys, model):
    code, out, _ = run(capsys, "show", model)
    assert code == 0
    assert "omega0" in out
    code, out, _ = run(capsys, "show", model, "--json")
    assert json.loads(out)


def test_identify_prints_json_alone_on_stdout(capsys, tmp_path, decay):
    code, out, _ = run(capsys, "identify", decay, "-o", tmp_path / "m.yaml", "--json")
    assert code == 0
    assert json.loads(out)
    assert load(tmp_path / "m.yaml").mass is None


def test_semicolons_decimal_commas_and_columns_by_number(capsys, tmp_path, signals):
    m = signals["decay"].size
    rows = [f"{t:.4f};{1e3 * x:.6f}".replace(".", ",") for t, x in zip(signals["t"][:m], signals["decay"], strict=True)]
    path = tmp_path / "european.csv"
    path.write_text("Zeit [s];Weg [mm]\n" + "\n".join(rows), encoding="utf-8")
    code, _, err = run(capsys, "identify", path, "-o", tmp_path / "m.yaml", "--time", "1", "--response", "2")
    assert code == 0, err
    assert load(tmp_path / "m.yaml").omega0.value == pytest.approx(TRUTH["omega0"], rel=1e-3)


def test_a_model_without_mass_is_exported_and_verified_on_its_decay(capsys, tmp_path, decay):
    assert run(capsys, "identify", decay, "-o", tmp_path / "m.yaml")[0] == 0
    assert run(capsys, "export", tmp_path / "m.yaml", tmp_path / "m.fmu", tmp_path / "m.casadi")[0] == 0
    code, out, err = run(capsys, "verify", tmp_path / "m.fmu", decay)
    assert code == 0, out + err


# What is bad: exit code 2, one sentence, nothing left behind ----------------------------------------------------------


def refused(capsys, folder, *arguments, says):
    before = sorted(folder.rglob("*"))
    code, out, err = run(capsys, *arguments)
    assert code == 2, (code, out, err)
    assert "Traceback" not in err
    assert says in err, err
    assert sorted(folder.rglob("*")) == before, "something was left behind"
    return err


def bad_files(folder, signals):
    t, force, x = signals["t"], signals["force"], signals["sweep"]
    good = np.column_stack([t, force, x])
    header = "time_s,force_N,displacement_m"

    def table(name, rows, head=header):
        return write(folder / name, rows.T, head)

    clipped = good.copy()
    clipped[:, 2] = np.clip(clipped[:, 2], -4e-3, 4e-3)
    jitter = good.copy()
    jitter[:, 0] += np.random.default_rng(0).uniform(-0.45, 0.45, len(t)) / FS
    steady = np.column_stack([t, np.sin(80 * t) * 1e-3])
    unrelated = good.copy()
    unrelated[:, 1] = np.random.default_rng(1).standard_normal(len(t))
    (folder / "empty.csv").write_bytes(b"")
    (folder / "binary.csv").write_bytes(bytes(range(256)) * 50)
    (folder / "broken.csv.gz").write_bytes(gzip.compress(b"time_s,x_m\n0,1\n")[:-9])
    (folder / "text.csv").write_text("time_s,x_m\n0,1\n0.1,abc\n0.2,3\n" * 3)
    (folder / "ragged.csv").write_text("time_s,x_m\n0,1\n0.1,2,3\n0.2,3\n")
    (folder / "other.xyz").write_text("x")
    return {
        folder / "missing.csv": "does not exist",
        folder: "folder",
        folder / "empty.csv": "empty",
        folder / "binary.csv": "binary",
        folder / "broken.csv.gz": "broken.csv.gz",
        folder / "text.csv": "line 3",
        folder / "ragged.csv": "line 3",
        folder / "other.xyz": ".xyz",
        table("clipped.csv", clipped): "clipped",
        table("jitter.csv", jitter): "jitter.csv",
        table("short.csv", good[:10]): "samples",
        table("steady.csv", steady, "time_s,x_m"): "decay",
        table("units.csv", good * [1, 1, 1e3], header): "unit",
        table("unrelated.csv", unrelated): "force",
    }


def test_every_bad_recording_is_refused_in_one_sentence(capsys, tmp_path, signals):
    for path, says in bad_files(tmp_path, signals).items():
        err = refused(capsys, tmp_path, "identify", path, "-o", tmp_path / "m.yaml", says=says)
        assert err.count("dashpot: ") == 1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--fs", "-5"], "fs"),
        (["--force", "nothing_N"], "nothing_N"),
        (["--unit", "furlong"], "furlong"),
        (["--quantity", "colour"], "colour"),
        (["--part", "9"], "FROM:TO"),
        (["--part", "50:60"], "lasts"),
    ],
)
def test_bad_options_are_refused(capsys, tmp_path, sweep, options, says):
    refused(capsys, tmp_path, "identify", sweep, "-o", tmp_path / "m.yaml", *options, says=says)


def test_output_that_cannot_be_written_is_said_before_the_work(capsys, tmp_path, sweep):
    (tmp_path / "taken").mkdir()
    refused(capsys, tmp_path, "identify", sweep, "-o", tmp_path / "taken", says="is a folder")
    refused(capsys, tmp_path, "identify", sweep, "-o", sweep / "m.yaml", says="cannot be written")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "m.yaml"),
        ("a: [1, 2", "m.yaml"),
        ("format: dashpot-model/9\n", "dashpot-model/1"),
        ("format: dashpot-model/1\nmass: !!python/object/apply:os.system ['touch owned']\n", "tag"),
        ("format: dashpot-model/1\nname: x\nomega0: {value: .nan, unit: rad/s}\n", "omega0"),
    ],
)
def test_bad_model_files_are_refused(capsys, tmp_path, text, says):
    path = tmp_path / "m.yaml"
    path.write_text(text, encoding="utf-8")
    refused(capsys, tmp_path, "show", path, says=says)
    refused(capsys, tmp_path, "export", path, tmp_path / "m.fmu", says=says)
    assert not Path("owned").exists()


def test_an_unknown_suffix_is_refused(capsys, tmp_path, model):
    refused(capsys, tmp_path, "export", model, tmp_path / "rig.exe", says=".ssp, .mjcf, .urdf and .hydrodyn")


def test_what_is_no_fmu_is_refused(capsys, tmp_path, sweep, model):
    (tmp_path / "text.fmu").write_text("no zip")
    with zipfile.ZipFile(tmp_path / "hollow.fmu", "w") as archive:
        archive.writestr("readme", "nothing")
    run(capsys, "export", model, tmp_path / "whole.fmu")
    content = (tmp_path / "whole.fmu").read_bytes()
    (tmp_path / "half.fmu").write_bytes(content[: len(content) // 2])
    for name in ("missing", "text", "hollow", "half"):
        refused(
            capsys,
            tmp_path,
            "verify",
            tmp_path / f"{name}.fmu",
            sweep,
            "--json",
            tmp_path / "v.json",
            says=f"{name}.fmu",
        )


def test_simulate_writes_what_the_recording_shows_of_the_motion(capsys, tmp_path, model, signals):
    t, force, x = (signals[name] for name in ("t", "force", "sweep"))
    speed = np.gradient(x, t)
    path = write(tmp_path / "v.csv", [t, force, speed], "time_s,force_N,velocity_m_s")
    assert run(capsys, "simulate", model, path, "-o", tmp_path / "o.csv")[0] == 0
    made = np.genfromtxt(tmp_path / "o.csv", delimiter=",", names=True)
    assert np.std(made["simulated_velocity_m_s"] - speed) < 0.05 * np.std(speed)
    angle = write(tmp_path / "w.csv", [t, force, speed], "time_s,force_N,velocity_rad_s")
    refused(capsys, tmp_path, "simulate", model, angle, "-o", tmp_path / "o2.csv", says="velocity in rad/s")


def test_a_nasty_name_is_harmless_everywhere(capsys, tmp_path, decay, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, err = run(capsys, "identify", decay, "-o", "m.yaml", "--name", NASTY, "--report", "r.html")
    assert code == 0, err
    assert load("m.yaml").name == NASTY
    assert "<evil" not in Path("r.html").read_text(encoding="utf-8")
    for backend in ("native", "python"):
        assert run(capsys, "export", "m.yaml", f"{backend}.fmu", "--backend", backend)[0] == 0
        with zipfile.ZipFile(f"{backend}.fmu") as archive:
            for entry in archive.namelist():
                assert re.fullmatch(r"[\w./-]+", entry)
                assert ".." not in entry
                if entry.endswith((".c", ".h", ".py", ".xml", ".html")):
                    text = archive.read(entry).decode()
                    assert "<evil" not in text
                    if not entry.endswith((".xml", ".html")):
                        assert 'system("touch' not in text
        assert run(capsys, "verify", f"{backend}.fmu", decay)[0] == 0
    assert run(capsys, "export", "m.yaml", "m.casadi", "m.c", "m.ssp")[0] == 0
    assert not Path("owned").exists()


def test_the_list_of_commands_is_not_cut(capsys):
    _, out, _ = run(capsys, "-h")
    assert "..." not in out.partition("Commands:")[2]
    assert "exit code 1 where they differ." in " ".join(out.split())


@pytest.mark.parametrize("name", ["rig.fmu", "rig.casadi", "rig.csv", "rig.html"])
def test_identify_writes_a_model_file_and_nothing_else(capsys, tmp_path, decay, name):
    code, _, err = run(capsys, "identify", decay, "-o", tmp_path / name)
    assert code == 2
    assert "identify writes a model file; name it .yaml" in err
    assert not (tmp_path / name).exists()


def test_no_arguments_show_what_there_is(capsys):
    code, out, err = run(capsys)
    assert code in (0, 2)
    assert "identify" in out + err


def test_running_as_a_module(tmp_path):
    import subprocess
    import sys

    run = subprocess.run([sys.executable, "-m", "dashpot", "--version"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0
    assert run.stdout.startswith("dashpot, version ")


@pytest.mark.skipif(os.name == "nt", reason="a pipe that closes early ends differently on Windows")
def test_a_reader_that_leaves_early_is_no_error(model):
    import subprocess
    import sys

    program = f"{sys.executable} -m dashpot show {model} | head -1"
    run = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.strip()
    assert "Traceback" not in run.stderr


def test_export_says_what_the_fmu_runs_on(capsys, tmp_path, model):
    from dashpot.export.platforms import own_platform

    code, out, err = run(capsys, "export", model, tmp_path / "rig.fmu", "--platform", own_platform().fmi3)
    assert (code, out) == (0, "")
    assert err.splitlines()[0].startswith(f"the FMU runs on {own_platform().words}")
    refused(capsys, tmp_path, "export", model, tmp_path / "m.fmu", "--platform", "win46", says="did you mean win64?")


def test_export_without_a_compiler_is_in_python_and_says_so(capsys, tmp_path, model, no_compiler):
    refused(
        capsys, tmp_path, "export", model, tmp_path / "m.fmu", "--backend", "native", says="no C compiler was found"
    )
    refused(capsys, tmp_path, "export", model, tmp_path / "m.fmu", "--platform", "all", says="no C compiler was found")
    code, out, err = run(capsys, "export", model, tmp_path / "rig.fmu")
    assert (code, out) == (0, "")
    assert "it needs Python with the package casadi" in err
    assert (tmp_path / "rig.fmu").exists()
