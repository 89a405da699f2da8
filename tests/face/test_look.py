"""dashpot look: what would be read, and nothing else."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.face.look import sparkline

T = np.arange(2000) / 1000.0
X = 5e-3 * np.exp(-2.5 * T) * np.cos(2 * np.pi * 12.67 * T)


def run(capsys, *arguments):
    try:
        main([str(argument) for argument in arguments])
        code = 0
    except SystemExit as ended:
        code = ended.code or 0
    out, err = capsys.readouterr()
    return code, out, err


@pytest.fixture
def runs(tmp_path):
    path = tmp_path / "runs.npz"
    np.savez(path, **{"fs": 1000.0, "a/x_mm": 1e3 * X, "b/x_mm": 2e3 * X})
    return path


def test_all_records_are_shown(capsys, runs):
    code, out, err = run(capsys, "look", runs)
    assert (code, err) == (0, "")
    assert out.count("motion     decay") == 2
    assert "runs.npz#b\n  channels   1 x_mm\n  read as    response = x_mm; displacement\n" in out
    assert "1000 Hz, 2000 samples, 2 s" in out
    assert list(runs.parent.iterdir()) == [runs]


def test_json(capsys, runs):
    code, out, _ = run(capsys, "look", f"{runs}#b", "--json")
    (entry,) = json.loads(out)
    (recording,) = entry["recordings"]
    assert (code, entry["record"], recording["columns"]["response"]) == (0, "runs.npz#b", "x_mm")
    assert recording["signals"][0]["max"] == 2 * X.max()


def test_what_is_refused_is_said_beside_the_others(capsys, runs):
    code, out, err = run(capsys, "look", runs.parent / "absent.csv", runs, "--response", "y")
    assert code == 2
    assert out.count("refused    runs.npz#") == 2
    assert err.count("\n") == 1
    assert "absent.csv does not exist" in err


def test_a_picture():
    assert sparkline(np.array([1.0, -1.0, 4.0, -4.0, 8.0, -8.0]), 3) == "▁▄█"
    assert sparkline(np.ones(100), 5) == "▁▁▁▁▁"
