"""A prescribed motion from the command line and from Python: files, exit codes, pages, refusals."""

from __future__ import annotations

import json
import re
from pathlib import Path

import dashpot
import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.model.element import Element
from dashpot.model.element_file import load_element, save_element
from dashpot.model.library import find

FS = 120.0
MEMBERS = {"stiffness": 9e3, "viscous": 700.0, "dry": 35.0, "load": 120.0}
DRAG = {"coefficient": 1.5e4}


def table(folder: Path, name: str, specimen: Specimen, kind: str, level: float, seed: int) -> Path:
    made = recorded(specimen, motion(kind, 6e-3 * level, 2.0, FS, 10.0), FS, noise=3e-3, motion_noise=2e-5, seed=seed)
    columns = np.column_stack([made.time, made.force, 1e3 * np.asarray(made.response), 0.0 * made.time])
    path = folder / name
    np.savetxt(path, columns, "%.9g", ",", header="time_s,force_N,stroke_mm,other_mm", comments="")
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("prescribed")
    table(made, "plain.csv", Specimen(MEMBERS), "sweep", 1.0, 1)
    for seed, (name, kind, level) in enumerate((("one", "sweep", 1.0), ("two", "sines", 0.7), ("held", "random", 0.8))):
        table(made, f"{name}.csv", Specimen(MEMBERS, "quadratic-drag", DRAG), kind, level, seed)
    return made


def ended(*arguments: object) -> int | str | None:
    try:
        cli.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return stop.code
    return 0


def test_identify_writes_an_element_and_its_page(folder: Path, tmp_path: Path, capsys) -> None:
    made, page = tmp_path / "strut.yaml", tmp_path / "strut.html"
    assert ended("identify", folder / "plain.csv", "--prescribed", "stroke_mm", "-o", made, "--report", page) == 0
    shown = capsys.readouterr().out
    assert "motion in, force out" in shown
    assert re.search(r"viscous +\d+(\.\d+)? +± ", shown)
    element = load_element(made)
    assert element.name == "strut"
    assert element.parameters()["viscous"].value == pytest.approx(700.0, rel=0.02)
    text = page.read_text()
    assert "gives every force to within its noise" in text
    assert "force over displacement, over velocity, and over time" in text


def test_a_force_with_a_gap_is_identified_without_it_and_that_is_said_once(
    folder: Path, tmp_path: Path, capsys
) -> None:
    lines = (folder / "plain.csv").read_text().splitlines()
    for i in range(500, 560):
        stamp, _, *rest = lines[i].split(",")
        lines[i] = ",".join([stamp, "nan", *rest])
    lost, made = tmp_path / "lost.csv", tmp_path / "strut.yaml"
    lost.write_text("\n".join(lines) + "\n")
    ended("identify", lost, "--prescribed", "stroke_mm", "-o", made)
    assert capsys.readouterr().err.count("60 sample(s) are missing") == 1
    for name, value in MEMBERS.items():
        found = load_element(made).parameters()[name]
        assert abs(found.value - value) < 4 * found.std


def test_a_missing_law_is_found_named_and_handed_over(folder: Path, tmp_path: Path, capsys) -> None:
    made, out = tmp_path / "strut.yaml", tmp_path / "diagnosis"
    how = ("--prescribed", "stroke_mm")
    assert ended("identify", folder / "one.csv", folder / "two.csv", *how, "-o", made) == 1
    assert "dashpot diagnose asks which law is missing" in capsys.readouterr().err
    both, held = (folder / "one.csv", folder / "two.csv"), ("--holdout", folder / "held.csv")
    assert ended("diagnose", made, *both, *how, "-o", out, *held) == 0
    shown = capsys.readouterr().out
    assert "quadratic-drag" in shown
    told = json.loads((out / "diagnosis.json").read_text())
    assert told["format"] == "dashpot-diagnosis/1"
    assert told["verdict"] == "missing-physics"
    assert [effect["law"] for effect in told["effects"]] == ["quadratic-drag"]
    assert told["effects"][0]["parameters"]["coefficient"]["unit"] == "N.s2/m2"
    assert [fit["file"] for fit in told["fit"]["holdout"]] == ["held.csv"]
    assert all(fit["nrmse_after"] < 0.5 * fit["nrmse_before"] for fit in told["fit"]["holdout"])
    assert told["parameter_shift"]["viscous"]["std"] > 0
    mended = load_element(out / "model.yaml")
    assert mended.parameters()["quadratic-drag.coefficient"].value == pytest.approx(1.5e4, rel=0.1)
    page = (out / "report.html").read_text()
    assert "Missing physics" in page
    assert "drag" in page
    assert len(page) < 1.5e6
    assert (out / "model.fmu").exists()


def test_show_simulate_and_export_take_an_element(folder: Path, tmp_path: Path, capsys) -> None:
    made, table_made = tmp_path / "strut.yaml", tmp_path / "force.csv"
    how = ("--prescribed", "stroke_mm")
    assert ended("identify", folder / "plain.csv", *how, "-o", made, "-q") == 0
    capsys.readouterr()
    assert ended("show", made, "--json") == 0
    assert json.loads(capsys.readouterr().out)["parameters"]["dry"]["unit"] == "N"
    assert ended("simulate", made, folder / "plain.csv", *how, "-o", table_made) == 0
    assert re.search(r"differs from the recorded one by 0\.\d+ %", capsys.readouterr().err)
    rows = np.loadtxt(table_made, delimiter=",", skiprows=1)
    assert table_made.read_text().startswith("time_s,displacement_m,measured_N,force_N\n")
    assert np.std(rows[100:, 2] - rows[100:, 3]) < 0.02 * np.std(rows[:, 2])
    alone, forces = tmp_path / "alone.csv", tmp_path / "alone.csv.gz"
    alone.write_text("\n".join(line.partition(",")[2] for line in (folder / "plain.csv").read_text().splitlines()))
    assert ended("simulate", made, alone, "--prescribed", "2", "--force", "none", "--fs", FS, "-o", forces) == 0
    assert np.loadtxt(forces, delimiter=",", skiprows=1).shape == (len(rows), 3)
    capsys.readouterr()
    assert ended("simulate", made, folder / "plain.csv", *how, "--unit", "cm", "-o", table_made) == 0
    assert "beyond that it is an extrapolation" in capsys.readouterr().err
    assert ended("export", made, tmp_path / "strut.casadi") == 0
    assert (tmp_path / "strut.smooth.casadi").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--prescribed", "nonsense"), r"no column 'nonsense' \(--prescribed\)"),
        (("--prescribed", "other_mm"), "the motion is 0 mm throughout; .* with --prescribed"),
        (("--prescribed", "stroke_mm", "--response", "other_mm"), "--prescribed and --response were both given"),
        (("--prescribed", "stroke_mm", "--base", "other_mm"), "--prescribed and --base were both given"),
        (("--prescribed", "stroke_mm", "--force", "none"), "without the force"),
        (("--prescribed", "stroke_mm", "--mass", "2"), "--mass is of an oscillator"),
        (("--prescribed", "stroke_mm", "--with", "sensor-lag"), "is no force"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    folder: Path, tmp_path: Path, capsys, arguments: tuple[str, ...], words: str
) -> None:
    assert ended("identify", folder / "plain.csv", *arguments, "-o", tmp_path / "no.yaml") == 2
    assert re.search(words, capsys.readouterr().err)
    assert not (tmp_path / "no.yaml").exists()


def test_commands_of_oscillators_say_that_they_are(folder: Path, tmp_path: Path, capsys) -> None:
    made, how = tmp_path / "strut.yaml", ("--prescribed", "stroke_mm")
    assert ended("identify", folder / "plain.csv", *how, "-o", made, "-q") == 0
    assert ended("hilbert", folder / "plain.csv", *how, "-o", tmp_path / "h") == 2
    assert "its motion was prescribed" in capsys.readouterr().err
    assert ended("linearise", made) == 2
    assert re.search("a force law by itself, .*in Python dashpot.load_element", capsys.readouterr().err)
    assert ended("diagnose", made, folder / "plain.csv", "--response", "stroke_mm", "-o", tmp_path / "d") == 2
    assert "nobody says that its motion was prescribed" in capsys.readouterr().err
    assert ended("export", made, tmp_path / "a.ssp") == 2
    assert "exported as .fmu, .casadi and .c;" in capsys.readouterr().err
    assert ended("export", made, tmp_path / "a.fmu", "--backend", "python") == 2
    assert "--backend python is of an oscillator" in capsys.readouterr().err


def test_a_rig_is_identified_with_a_damper_that_was_measured_by_itself(tmp_path: Path, capsys) -> None:
    t = np.arange(1600) / 200.0
    decay = 0.02 * np.exp(-1.2 * t) * np.cos(2 * np.pi * 4.0 * t)
    rig, damper = tmp_path / "rig.csv", tmp_path / "damper.yaml"
    noisy = decay + 1e-5 * np.random.default_rng(0).standard_normal(t.size)
    np.savetxt(rig, np.column_stack([t, 1e3 * noisy]), "%.9g", ",", header="time_s,x_mm", comments="")
    drag = {"quadratic-drag.coefficient": 1e-3}
    save_element(Element.from_values({"viscous": 20.0} | drag, name="damper", laws=[find("quadratic-drag")]), damper)
    assert ended("identify", rig, "--from", damper, "-o", tmp_path / "m.yaml") == 2
    assert "give it with --mass" in capsys.readouterr().err
    assert ended("identify", rig, "--from", damper, "--mass", "10", "-o", tmp_path / "m.yaml") == 0
    assert "quadratic-drag of damper keeps its values, forces divided by 10 kg" in capsys.readouterr().err
    model = dashpot.load(tmp_path / "m.yaml")
    assert model["quadratic-drag.coefficient"].value == pytest.approx(1e-4)
    assert model["viscous"].value == pytest.approx(2.4, rel=0.01)
    again = dashpot.identify(rig, start=dashpot.load_element(damper), mass=10.0)
    assert again["viscous"].value == pytest.approx(model["viscous"].value)


def test_python_has_the_same(folder: Path, tmp_path: Path) -> None:
    damper = dashpot.identify_element(folder / "one.csv", folder / "two.csv", prescribed="stroke_mm", name="damper")
    assert damper["dry"].unit == "N"
    with pytest.raises(KeyError, match="is no parameter of damper"):
        damper["mass"]
    told = damper.diagnose(folder / "one.csv", folder / "two.csv", holdout=folder / "held.csv", prescribed="stroke_mm")
    assert told.verdict == "missing-physics"
    assert told.effects == ("quadratic-drag",)
    path = told.element.save(tmp_path / "mended.yaml")
    again = dashpot.load_element(path)
    x = motion("sines", 4e-3, 2.0, FS, 5.0)
    assert again.force(x, fs=FS) == pytest.approx(told.element.force(x, fs=FS))
    assert again.export(tmp_path / "m.casadi")[0].name == "m.casadi"
    with pytest.raises(dashpot.BadInput, match="name it with force="):
        again.verify(folder / "one.csv", prescribed="stroke_mm", force="none")
    with pytest.raises(dashpot.BadInput, match="at least four numbers"):
        again.force([1.0, 2.0], fs=FS)
    with pytest.raises(dashpot.BadInput, match="identify_element in Python"):
        dashpot.identify(folder / "one.csv", prescribed="stroke_mm")


def test_look_shows_a_prescribed_motion_and_an_oscillator_is_not_verified_by_one(
    folder: Path, tmp_path: Path, capsys
) -> None:
    assert ended("look", folder / "plain.csv", "--prescribed", "stroke_mm", "--json") == 0
    ((recording,),) = [entry["recordings"] for entry in json.loads(capsys.readouterr().out)]
    assert recording["motion"] == "prescribed"
    assert recording["columns"] == {"time": "time_s", "force": "force_N", "prescribed": "stroke_mm"}
    assert recording["pieces"] == recording["modes"] == []
    assert ended("look", folder / "plain.csv", "--prescribed", "stroke_mm") == 0
    assert "prescribed" in capsys.readouterr().out
    fmu = dashpot.export(
        dashpot.Model.from_values(
            dict.fromkeys(("cubic", "preload", "dry"), 0.0) | {"mass": 1.0, "omega0": 20.0, "viscous": 1.0}
        ),
        tmp_path / "rig.fmu",
    )[0]
    assert ended("verify", fmu, folder / "plain.csv", "--prescribed", "stroke_mm") == 2
    assert "its motion was prescribed" in capsys.readouterr().err


def test_the_fmu_of_an_element_is_verified_along_recorded_motions(folder: Path, tmp_path: Path, capsys) -> None:
    made, fmu, told, how = tmp_path / "strut.yaml", tmp_path / "strut.fmu", tmp_path / "v.json", "--prescribed"
    assert ended("identify", folder / "plain.csv", how, "stroke_mm", "-o", made, "-q") == 0
    assert ended("export", made, fmu, "-q") == 0
    page = ("--report", tmp_path / "v.html")
    assert ended("verify", fmu, folder / "plain.csv", how, "stroke_mm", "--json", told, *page) == 0
    assert "strut.fmu reproduces plain.csv to within" in capsys.readouterr().out
    (one,) = json.loads(told.read_text())["recordings"]
    assert one["pass"] is True
    assert one["nrmse"] < one["nrmse_limit"]
    assert ended("verify", fmu, folder / "one.csv", how, "stroke_mm") == 1
    assert "strut.fmu does not reproduce one.csv" in capsys.readouterr().out
    assert ended("verify", fmu, folder / "plain.csv", "--response", "stroke_mm") == 2
    assert "nobody says that its motion was prescribed" in capsys.readouterr().err
    check = dashpot.load_element(made).verify(folder / "plain.csv", prescribed="stroke_mm")
    assert check.passed


@pytest.fixture(scope="module")
def under_current(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A damper at three currents, by whose force alone these differ."""
    made = tmp_path_factory.mktemp("current")
    for seed, current in enumerate((0.0, 0.5, 1.0)):
        specimen = Specimen(MEMBERS | {"viscous": 700.0 + 600.0 * current})
        table(made, f"at_{current:g}A.csv", specimen, ("sweep", "sines", "random")[seed], 1.0 - 0.1 * seed, seed)
    return made


def test_a_channel_is_asked_about_named_and_carried_on(under_current: Path, tmp_path: Path, capsys) -> None:
    files = [under_current / f"at_{current}A.csv" for current in ("0", "0.5", "1")]
    how = ("--prescribed", "stroke_mm")
    made, out = tmp_path / "damper.yaml", tmp_path / "diagnosis"
    assert ended("look", files[0], *how, "--channel", "current=0A") == 0
    assert "0 to 0 A" in capsys.readouterr().out
    assert ended("identify", *files, *how, "--channel", "current=0A,0.5A,1A", "-o", made, "-q") == 1
    assert "current" not in made.read_text().partition("identified:")[0]  # which has the command line too
    given = ("--channel", "current=0A,0.5A,1A", "--holdout", files[2])
    assert ended("diagnose", made, files[0], files[1], *how, *given, "-o", out) == 0
    shown = capsys.readouterr().out
    assert "Missing: viscous damping grows with the current, in a straight line, from 7" in shown
    assert "(viscous + current_slope (current - 0.5)) x'" in shown
    page = (out / "report.html").read_text()
    assert "Viscous damping grows with the current" in page
    element = load_element(out / "model.yaml")
    assert element.parameters()["viscous.current_slope"].value == pytest.approx(600.0, rel=0.02)
    assert ended("show", out / "model.yaml") == 0
    assert "0 to 1 A (what depends on it is stated at 0.5 A)" in capsys.readouterr().out
    force = tmp_path / "force.csv"
    assert ended("simulate", out / "model.yaml", files[1], *how, "--channel", "current=0.5A", "-o", force) == 0
    assert re.search(r"differs from the recorded one by 0\.\d+ %", capsys.readouterr().err)
    assert ended("simulate", out / "model.yaml", files[1], *how, "--channel", "current=1.5A", "-o", force) == 0
    assert "current is 1.5 A, and the recordings covered 0 to 1 A: beyond that viscous is a guess" in (
        capsys.readouterr().err
    )
    if (out / "model.fmu").exists():
        assert ended("verify", out / "model.fmu", files[1], *how, "--channel", "current=0.5A") == 0
        assert ended("verify", out / "model.fmu", files[1], *how) == 2
        assert "depends on the current, and nobody says what it was" in capsys.readouterr().err


def test_what_is_to_depend_on_a_channel_is_said_by_with(under_current: Path, tmp_path: Path, capsys) -> None:
    made, how = tmp_path / "damper.yaml", ("--prescribed", "stroke_mm")
    given = ("--channel", "current=at_0A.csv:0A,at_1A.csv:1A", "--with", "viscous:current")
    assert ended("identify", under_current / "at_0A.csv", under_current / "at_1A.csv", *how, *given, "-o", made) == 0
    assert "change of viscous with current" in capsys.readouterr().out
    force = dashpot.load_element(made).force(1e-3 * np.sin(np.arange(200) / 20.0), 100.0, current=1.0)
    plain = dashpot.load_element(made).element.at({"current": 1.0})
    assert plain.values()["viscous"] == pytest.approx(1300.0, rel=0.02)
    assert np.std(force) > 0.0
    with pytest.raises(dashpot.BadInput, match="depends on no channel 'pressure'"):
        dashpot.load_element(made).force(np.sin(np.arange(200) / 20.0), 100.0, pressure=1.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--prescribed", "stroke_mm", "--channel", "current=1A"), "the channel current never changes"),
        (("--prescribed", "stroke_mm", "--channel", "current=1A,2A,3A"), "has 3 values, and 2 recordings were given"),
        (("--prescribed", "stroke_mm", "--channel", "current=0A,1kg"), "a current is measured in A"),
        (("--prescribed", "stroke_mm", "--channel", "oil"), "has no column 'oil'"),
        (("--response", "stroke_mm", "--channel", "current=0A,1A"), "is asked of a prescribed motion alone"),
    ],
)
def test_a_channel_that_tells_nothing_is_refused(
    under_current: Path, tmp_path: Path, capsys, arguments: tuple[str, ...], words: str
) -> None:
    made = tmp_path / "damper.yaml"
    assert ended("identify", under_current / "at_0A.csv", under_current / "at_1A.csv", *arguments, "-o", made) == 2
    assert words in capsys.readouterr().err
    assert not made.exists()
