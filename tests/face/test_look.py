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


def taken(capsys, path):
    """The line under the pictures, the words to it, and the same of the JSON."""
    _, out, _ = run(capsys, "look", path)
    lines = out.splitlines()
    (at,) = (i for i, line in enumerate(lines) if line.startswith("  taken"))
    _, out, _ = run(capsys, "look", path, "--json")
    words = lines[at + 1].strip() if at + 1 < len(lines) else ""
    return lines[at][13:], words, json.loads(out)[0]["recordings"][0]["pieces"]


def test_what_a_fit_would_take_stands_under_the_pictures(capsys, tmp_path):
    """Held for 1 s, let go, held again at 3 s, let go."""
    noise = 1e-6 * np.random.default_rng(1).standard_normal(5000)
    x = np.concatenate([np.full(1000, X[0]), X, np.full(1000, X[0]), X[:1000]]) + noise
    table = np.column_stack([np.arange(5000) / 1000.0, 1e3 * x])
    np.savetxt(tmp_path / "held.csv", table, delimiter=",", header="t_s,x_mm", comments="")
    row, words, pieces = taken(capsys, tmp_path / "held.csv")
    assert [piece["kind"] for piece in pieces] == ["free", "free"]
    assert [piece["start"] for piece in pieces] == pytest.approx([1.0, 4.0], abs=0.02)
    assert [piece["stop"] for piece in pieces] == pytest.approx([3.0, 5.0], abs=0.05)
    assert words.startswith("━ free 1")
    assert words.endswith("; the rest is left")
    assert row[2:10].isspace()
    assert set(row[14:34]) == set(row[50:58]) == {"━"}
    assert row[38:46].isspace()


def test_what_does_not_move_is_not_taken(capsys, tmp_path):
    still = np.column_stack([np.arange(2000) / 1000.0, 5e-3 + 1e-6 * np.random.default_rng(1).standard_normal(2000)])
    np.savetxt(tmp_path / "still.csv", still, delimiter=",", header="t_s,x_mm", comments="")
    row, _, pieces = taken(capsys, tmp_path / "still.csv")
    assert (row, pieces) == ("nothing", [])


@pytest.mark.parametrize(("first", "since"), [(7.5, " (from the first sample)"), (1.7e9, "")])
def test_times_are_those_of_part_whatever_the_first_stamp(capsys, tmp_path, first, since):
    table = np.column_stack([first + T, 1e3 * X])
    np.savetxt(tmp_path / "stamped.csv", table, delimiter=",", header="t_s,x_mm", comments="", fmt="%.6f")
    _, words, pieces = taken(capsys, tmp_path / "stamped.csv")
    assert words == f"━ free 0 to 2 s{since}"
    assert [(piece["start"], piece["stop"]) for piece in pieces] == [(0.0, 2.0)]


def test_what_a_force_drives_is_taken_whole(capsys, tmp_path):
    force = np.sign(np.sin(2 * np.pi * 2.1 * T))
    x, v, rows = 0.0, 0.0, []
    for f in force:  # half-implicit Euler: a picture needs no more
        v += 1e-3 * (f - 2.0 * v - (2 * np.pi * 12.67) ** 2 * x)
        x += 1e-3 * v
        rows.append(x)
    table = np.column_stack([T, force, np.array(rows) + 1e-8 * np.random.default_rng(1).standard_normal(T.size)])
    np.savetxt(tmp_path / "driven.csv", table, delimiter=",", header="t_s,force_N,x_m", comments="")
    row, words, pieces = taken(capsys, tmp_path / "driven.csv")
    assert set(row) == {"┄"}
    assert words == "┄ driven 0 to 2 s"
    assert [piece["kind"] for piece in pieces] == ["driven"]


def test_a_picture():
    assert sparkline(np.array([1.0, -1.0, 4.0, -4.0, 8.0, -8.0]), 3) == "▁▄█"
    assert sparkline(np.ones(100), 5) == "▁▁▁▁▁"
