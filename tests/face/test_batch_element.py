"""Entries of a fleet whose motion was prescribed: identified, diagnosed, on the overview."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.errors import BadInput
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.fleet.manifest import read_manifest
from dashpot.model.element_file import load_element

FS = 120.0
MEMBERS = {"stiffness": 9e3, "viscous": 700.0, "dry": 35.0}


def table(
    folder: Path, name: str, law: str, numbers: dict[str, float], kind: str = "sweep", level: float = 1.0
) -> None:
    specimen = Specimen(MEMBERS, law, numbers)
    made = recorded(specimen, motion(kind, 6e-3 * level, 2.0, FS, 8.0), FS, noise=3e-3, motion_noise=2e-5, seed=1)
    columns = np.column_stack([made.time, made.force, 1e3 * np.asarray(made.response)])
    np.savetxt(folder / name, columns, "%.9g", ",", header="time_s,force_N,stroke_mm", comments="")


def ended(*arguments: object) -> int | str | None:
    try:
        cli.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return stop.code
    return 0


def test_dampers_stand_beside_each_other_with_what_they_lack(tmp_path: Path, capsys) -> None:
    table(tmp_path, "plain.csv", "", {})
    table(tmp_path, "drag.csv", "quadratic-drag", {"coefficient": 1.5e4})
    table(tmp_path, "drag_slow.csv", "quadratic-drag", {"coefficient": 1.5e4}, "sines", 0.7)
    (tmp_path / "fleet.yaml").write_text(
        "format: dashpot-fleet/1\ndefaults: {prescribed: stroke_mm}\nrigs:\n"
        "  - {name: plain, recordings: plain.csv}\n"
        "  - {name: drag, recordings: [drag.csv, drag_slow.csv]}\n"
    )
    out = tmp_path / "out"
    assert ended("batch", tmp_path / "fleet.yaml", "-o", out, "-q") == 0
    with (out / "fleet.csv").open(newline="") as content:
        rows = {row["name"]: row for row in csv.DictReader(content)}
    assert rows["plain"]["result"] == "good"
    assert rows["plain"]["viscous.unit"] == "N.s/m"
    assert float(rows["plain"]["viscous"]) == pytest.approx(700.0, rel=0.02)
    assert rows["drag"]["result"] == "mended"
    assert rows["drag"]["effects"] == "quadratic-drag"
    assert "plain" in (out / "index.html").read_text()
    (kept,) = (out / "results").glob("drag-*")
    assert load_element(kept / "diagnosis" / "model.yaml").terms[0].effect == "quadratic-drag"
    assert (kept / "diagnosis" / "report.html").exists()
    assert (kept / "report.html").exists()
    capsys.readouterr()
    assert ended("watch", out) == 1
    assert "quadratic-drag appears at drag" in capsys.readouterr().out


def test_options_of_an_oscillator_are_refused_in_the_manifest(tmp_path: Path) -> None:
    table(tmp_path, "plain.csv", "", {})
    path = tmp_path / "fleet.yaml"
    path.write_text(
        "format: dashpot-fleet/1\nrigs:\n  - {name: a, recordings: plain.csv, prescribed: stroke_mm, mass: 2.0}\n"
    )
    with pytest.raises(BadInput, match="'mass' is of an oscillator, and 'prescribed' of a force law by itself"):
        read_manifest(path)


def test_a_manifest_says_under_which_current_each_file_was_recorded(tmp_path: Path) -> None:
    for name, viscous in (("off.csv", 400.0), ("half.csv", 700.0), ("full.csv", 1000.0)):
        specimen = Specimen(MEMBERS | {"viscous": viscous}, "", {})
        made = recorded(specimen, motion("sweep", 6e-3, 2.0, FS, 8.0), FS, noise=3e-3, motion_noise=2e-5, seed=2)
        columns = np.column_stack([made.time, made.force, 1e3 * np.asarray(made.response)])
        np.savetxt(tmp_path / name, columns, "%.9g", ",", header="time_s,force_N,stroke_mm", comments="")
    (tmp_path / "fleet.yaml").write_text(
        "format: dashpot-fleet/1\nrigs:\n  - name: damper\n    recordings: [off.csv, full.csv]\n"
        "    holdout: half.csv\n    prescribed: stroke_mm\n    diagnose: always\n"
        "    channels: {current: [0A, 1A, 0.5A]}\n"
    )
    out = tmp_path / "out"
    assert ended("batch", tmp_path / "fleet.yaml", "-o", out, "-q") == 0
    (kept,) = (out / "results").glob("damper-*")
    (found,) = load_element(kept / "diagnosis" / "model.yaml").dependences
    assert (found.channel, found.of) == ("current", "viscous")
    strengths = [load_element(kept / "diagnosis" / "model.yaml").at({"current": c}) for c in (0.0, 1.0)]
    assert [one.values()["viscous"] for one in strengths] == pytest.approx([400.0, 1000.0], rel=0.02)


def test_channels_without_a_prescribed_motion_are_refused_in_the_manifest(tmp_path: Path) -> None:
    table(tmp_path, "plain.csv", "", {})
    path = tmp_path / "fleet.yaml"
    path.write_text("format: dashpot-fleet/1\nrigs:\n  - {name: a, recordings: plain.csv, channels: {current: 0.5A}}\n")
    with pytest.raises(BadInput, match="'channels' go with 'prescribed'"):
        read_manifest(path)
