"""A dashpot.yaml beside recordings says how they are read; what is given counts instead; every problem has its line."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.errors import BadInput
from dashpot.face.look import look
from dashpot.recording import read, read_records, recordings_of
from hypothesis import strategies as st

N, FS = 1500, 500.0
T = np.arange(N) / FS
X = 4e-3 * np.exp(-2 * T) * np.cos(75 * T) + 1e-8 * np.random.default_rng(0).standard_normal(N)
F = np.sin(2 * np.pi * (4 + 3 * T) * T)
SAID = """format: dashpot-data/1
name: swing
columns: {time: clock, force: "*shaker*", response: 3}
units: {response: mm, time: ms}
calibration: {force: 22.4 N/V}
parts: {"*.csv": "0.5:"}
files:
  decay*: {columns: {force: none}}
"""


@pytest.fixture
def folder(tmp_path):
    """Two recordings whose columns say little, and what writes the file beside them."""
    rows = "\n".join(f"{1e3 * t:.0f},{f:.9g},{1e3 * x:.9g}" for t, f, x in zip(T, F, X, strict=True))
    for name in ("sweep.csv", "decay-1.csv"):
        (tmp_path / name).write_text(f"clock,shaker out,laser\n{rows}\n")

    def write(text):
        (tmp_path / "dashpot.yaml").write_text(text)
        return tmp_path

    return write


def test_it_is_read_by_every_way_to_read(folder):
    path = folder(SAID) / "sweep.csv"
    for recording in (read(path), *read_records(path), *recordings_of(path), *recordings_of([str(path)])):
        np.testing.assert_allclose(recording.response, X[250:], rtol=0, atol=1e-11)
        np.testing.assert_allclose(recording.force, 22.4 * F[250:], rtol=0, atol=1e-6)
        assert (recording.fs, recording.rig) == (pytest.approx(FS), "swing")
        assert any(f"read as {path.parent.name}/dashpot.yaml says: time clock" in note for note in recording.notes)
    (entry,) = (seen.entry for seen in look(path, {}))
    assert entry["recordings"][0]["columns"] == {"time": "clock", "force": "shaker out", "response": "laser"}
    assert entry["recordings"][0]["samples"] == N - 250


def test_files_of_a_pattern_have_their_own(folder):
    recording = read(folder(SAID) / "decay-1.csv")
    assert recording.force is None
    np.testing.assert_allclose(recording.response, X[250:], rtol=0, atol=1e-11)


def test_what_is_given_counts(folder):
    path = folder(SAID) / "sweep.csv"
    assert read(path, part=(0.0, 2.0)).n == 1000
    np.testing.assert_allclose(read(path, unit="um").response, 1e-3 * X[250:], rtol=0, atol=1e-14)
    given = {"force": "2 N/V", "time": "1 ms"}
    np.testing.assert_allclose(read(path, calibration=given).force, 2 * F[250:], rtol=0, atol=1e-7)
    assert read(path, force="none").force is None
    np.testing.assert_allclose(read(path, response="laser", force_unit="kN").force, 1e3 * F[250:], rtol=0, atol=1e-4)


def test_a_rival_that_is_given_leaves_out_what_stands_there(folder):
    path = folder("format: dashpot-data/1\ncolumns: {time: 1, base: 2, response: 3}\nunits: {time: ms, base: m}\n")
    swept = path / "sweep.csv"
    assert read(swept, unit="mm", checked=False).base == "whole"
    forced = read(swept, unit="mm", force="shaker out", force_unit="N", checked=False)
    assert forced.base == ""
    np.testing.assert_allclose(forced.force, F, rtol=0, atol=1e-8)


@pytest.mark.long
def test_a_prescribed_motion_is_identified_as_such(folder, capsys):
    said = "format: dashpot-data/1\nname: seal\ncolumns: {time: 1, force: 2, prescribed: 3}\n"
    path = folder(said + "units: {time: ms, prescribed: mm, force: N}\n")
    swept = 4e-3 * np.sin(2 * np.pi * (1 + 2 * T) * T)
    moved = np.gradient(swept, T, edge_order=2)
    force = 300.0 * swept + 12.0 * moved
    rows = "\n".join(f"{1e3 * t:.0f},{f:.9g},{1e3 * x:.12g}" for t, f, x in zip(T, force, swept, strict=True))
    (path / "sweep.csv").write_text(f"clock,cell,stroke\n{rows}\n")
    with pytest.raises(SystemExit) as ended:
        main(["identify", str(path / "sweep.csv"), "-o", str(path / "out.yaml"), "--json"])
    assert ended.value.code in (0, 1)
    told = json.loads(capsys.readouterr().out)
    assert told["name"] == "seal"
    assert told["parameters"]["stiffness"]["value"] == pytest.approx(300.0, rel=1e-2)


def test_what_is_wrong_with_a_recording_says_that_it_was_read(folder):
    path = folder("format: dashpot-data/1\ncolumns: {response: lasr}\n") / "sweep.csv"
    with pytest.raises(BadInput, match=r"no column 'lasr'.*did you mean 'laser'\? \(read as .*dashpot\.yaml says: re"):
        read(path)


def test_every_problem_is_said_at_once_with_its_line(folder):
    text = """format: dashpot-data/1
name: 7
colums: {response: 3}
columns: {frce: 2, response: [3]}
units: {response: furlong, force: 3}
calibration: {force: loud}
part: 2-30
amplitude: 5mm..1mm
fs: fast
hold: firm
relative: perhaps
channels: {current: true}
parts: {a.csv: 7}
files: {"b*": {parts: {}, quantity: position}, c: 1}
"""
    path = folder(text)
    with pytest.raises(BadInput) as caught:
        read(path / "sweep.csv")
    lines = str(caught.value).splitlines()
    where = [line.removeprefix(f"{path / 'dashpot.yaml'}: ").split(": ")[:2] for line in lines]
    assert where == [
        ["line 2", "$.name"],
        ["line 3", "$.colums"],
        ["line 4", "$.columns.frce"],
        ["line 4", "$.columns.response"],
        ["line 5", "$.units.response"],
        ["line 5", "$.units.force"],
        ["line 6", "$.calibration.force"],
        ["line 7", "$.part"],
        ["line 8", "$.amplitude"],
        ["line 9", "$.fs"],
        ["line 10", "$.hold"],
        ["line 11", "$.relative"],
        ["line 12", "$.channels.current"],
        ["line 13", "$.parts['a.csv']"],
        ["line 14", "$.files['b*'].parts"],
        ["line 14", "$.files['b*'].quantity"],
        ["line 14", "$.files.c"],
    ]
    assert "did you mean columns?" in lines[1]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("format: dashpot-model/1\n", "says format 'dashpot-model/1'; a file of that name says how the recordings"),
        ("", r"has no format; .* begins with 'format: dashpot-data/1': write that, or name it otherwise"),
        ("a: [", "cannot be read as YAML"),
        ("a: !x 1", "tags"),
    ],
)
def test_another_file_of_that_name_is_refused(folder, text, says):
    with pytest.raises(BadInput, match=says):
        read(folder(text) / "sweep.csv")


def test_a_folder_of_that_name_is_one_sentence(folder):
    path = folder("")
    (path / "dashpot.yaml").unlink()
    (path / "dashpot.yaml").mkdir()
    with pytest.raises(BadInput, match=r"dashpot\.yaml: cannot be read .*; check it, or name it otherwise"):
        read(path / "sweep.csv")


KEYS = ["columns", "units", "calibration", "force", "response", "parts", "files", "fs", "name", "channels", "*"]
WORDS = st.sampled_from(KEYS)
LEAVES = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), WORDS)


def test_any_settings_are_a_recording_or_a_sentence(every, unless_refused, folder):
    def holds(settings):
        path = folder(json.dumps({"format": "dashpot-data/1"} | settings))
        unless_refused(read, path / "decay-1.csv", time="clock", calibration={"time": "1 ms"}, unit="mm")

    nested = st.recursive(LEAVES, lambda inner: st.dictionaries(WORDS, inner, max_size=3) | st.lists(inner, max_size=2))
    every(st.dictionaries(WORDS, nested, max_size=4), holds, 50)
