"""The blind test end to end, with a stand-in for the commands that diagnose."""

from __future__ import annotations

import json
import sys

import pytest
from dashpot.examples.concealed import proof

# Knows nothing of the rig: says that nothing is missing, and notes what it was given and what it could see.
STAND_IN = """
import json, os, sys
from pathlib import Path
arguments = sys.argv[1:]
output = Path(arguments[arguments.index("-o") + 1])
seen = {"arguments": arguments, "cwd": os.getcwd(), "pwd": os.environ["PWD"], "old": os.environ.get("OLDPWD")}
seen["files"] = sorted(path.name for path in Path().rglob("*"))
if arguments[0] == "identify":
    output.write_text("format: stand-in")
    print("identified")
    sys.exit(1)
output.mkdir()
rows = [{"file": a, "nrmse_before": 0.5, "nrmse_after": 0.01} for a in arguments if a.startswith("holdout")]
answer = {"verdict": "consistent", "effects": [], "fit": {"holdout": rows}, "seen": seen}
(output / "diagnosis.json").write_text(json.dumps(answer))
"""


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    path = tmp_path / "stand_in.py"
    path.write_text(STAND_IN)
    monkeypatch.setattr(proof, "DASHPOT", (sys.executable, str(path)))
    return path


def test_the_blind_test_from_suite_to_scoreboard(tmp_path, stand_in, capsys):
    folder = tmp_path / "blind"
    command = ["-o", str(folder), "--seed", "3", "--kinds", "none", "sensor-offset", "--short", "2", "--jobs", "1"]
    code = proof.main(command)
    out = capsys.readouterr().out
    board = json.loads((folder / "scoreboard.json").read_text())
    assert f"SHA-256 of the sealed truth: {board['sha256']}" in out
    assert "rig_002: diagnosed" in out
    assert len(board["rigs"]) == 2
    assert code == (0 if all(target["met"] for target in board["targets"]) else 1)
    assert board["sha256"] in (folder / "scoreboard.html").read_text()

    seen = json.loads((folder / "results/rig_001/diagnosis.json").read_text())["seen"]
    recordings = ["sweep_high.csv.gz", "sweep_low.csv.gz", "ringdown.csv.gz"]
    held_out = ["--holdout", "holdout_multisine.csv.gz", "--holdout", "holdout_sweep.csv.gz"]
    assert seen["arguments"] == ["diagnose", "model.yaml", *recordings, *held_out, "-o", "diagnosis"]
    assert str(folder) not in json.dumps(seen)
    assert set(seen["files"]) == {*recordings, *held_out[1::2], "model.yaml", "log.txt"}
    log = (folder / "results/rig_001/log.txt").read_text()
    assert "$ dashpot identify sweep_high.csv.gz sweep_low.csv.gz ringdown.csv.gz -o model.yaml\nidentified\n" in log

    # Started again it diagnoses only what is missing, and makes no suite.
    before = (folder / "suite/truth.sealed").stat().st_mtime_ns
    (folder / "results/rig_002/diagnosis.json").unlink()
    assert proof.main(command) == code
    out = capsys.readouterr().out
    assert "1 of them diagnosed already" in out
    assert "rig_002: diagnosed" in out
    assert "rig_001: diagnosed" not in out
    assert (folder / "suite/truth.sealed").stat().st_mtime_ns == before

    # A rig that fails is counted, and does not stop the others.
    stand_in.write_text("raise SystemExit('no')")
    (folder / "results/rig_002/diagnosis.json").unlink()
    proof.main(command)
    assert "rig_002: no diagnosis, see" in capsys.readouterr().out
    rigs = json.loads((folder / "scoreboard.json").read_text())["rigs"]
    assert [rig["answer"]["problem"] for rig in rigs] == ["", "no diagnosis.json"]

    # Another suite does not go into the same folder, and a truth that was changed is not used.
    assert proof.main([*command, "--scale", "small"]) == 2
    assert "name another folder" in capsys.readouterr().err
    (folder / "suite/truth.sealed").write_bytes(b"forged")
    assert proof.main(command) == 2
    assert "is not the truth that was sealed" in capsys.readouterr().err


@pytest.mark.long
def test_the_blind_test_of_dirty_rigs_goes_on_where_it_stopped(tmp_path, stand_in, capsys):
    folder = tmp_path / "blind"
    command = ["-o", str(folder), "--seed", "6", "--dirty", "2"]
    (folder / "suite" / "parts").mkdir(parents=True)
    note = {"settings": ["--seed", "6", "--scale", "nominal", "--dirty", "2"], "sha256": ""}
    (folder / "suite.json").write_text(json.dumps(note))
    proof.main(command)
    assert "rig_002: diagnosed" in capsys.readouterr().out
    board = json.loads((folder / "scoreboard.json").read_text())
    assert board["dirty"]["figures"]["false"]["of"] == 0
    assert board["dirty"]["figures"]["first"]["of"] == 2
    assert json.loads((folder / "suite.json").read_text())["sha256"] == board["sha256"]
    proof.main(command)
    assert "2 of them diagnosed already" in capsys.readouterr().out
