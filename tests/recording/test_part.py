from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, read, recordings_of
from dashpot.recording.part import cut_out, parse_part


def recording(n=1001):
    return Recording(name="r", fs=100.0, response=np.arange(n) * 1.0, force=np.ones(n), start=3.0)


@pytest.mark.parametrize(
    ("text", "part"), [("2:5", (2.0, 5.0)), (":5", (0.0, 5.0)), ("2.5:", (2.5, math.inf)), ("1e0:2", (1.0, 2.0))]
)
def test_a_part_is_understood(text, part):
    assert parse_part(text) == part


@pytest.mark.parametrize("text", ["5", "5:2", "a:b", "3:3", "nan:2", "1:2:3", "-5:-1", "-1:0"])
def test_what_is_no_part_is_refused(text):
    with pytest.raises(BadInput, match="FROM:TO"):
        parse_part(text)


def test_the_samples_of_the_part_are_kept_with_their_time():
    part = cut_out(recording(), (2.0, 5.0))
    assert part.response[[0, -1]] == pytest.approx([200, 499])
    assert part.force.size == 300
    assert part.time[0] == pytest.approx(5.0)
    assert "2 to 5 s are used" in part.notes[0]


def test_the_whole_is_left_as_it_is():
    whole = recording()
    assert cut_out(whole, (0.0, math.inf)) is whole


def test_a_part_beyond_the_end_is_refused():
    with pytest.raises(BadInput, match="lasts"):
        cut_out(recording(), (11.0, 12.0))


def test_reading_a_part_of_a_file(tmp_path):
    t = np.arange(4000) * 1e-3
    x = 1e-3 * np.exp(-t) * np.sin(80 * t)
    np.savetxt(tmp_path / "d.csv", np.column_stack([t, x]), delimiter=",", header="time_s,x_m", comments="")
    assert read(tmp_path / "d.csv", part=(1.0, 3.0)).n == 2000


def test_a_gap_outside_of_the_part_is_none_of_its_own(tmp_path):
    time = np.delete(np.arange(1000) / 100.0, range(700, 790))
    x = 1e-3 * np.exp(-0.3 * time) * np.sin(2 * np.pi * 3 * time)
    path = tmp_path / "rec.csv"
    path.write_text("time_s,x_m\n" + "\n".join(f"{t:.2f},{v:.9g}" for t, v in zip(time, x, strict=True)))
    assert read(path).blank == read(path).unknown == ((700, 790),)
    recording = read(path, part=(1.0, 6.5))
    assert (recording.n, recording.start) == (550, pytest.approx(1.0))
    assert recording.response == pytest.approx(x[100:650], abs=1e-11)
    assert any(note.endswith("1 to 6.5 s are used, the rest is left out") for note in recording.notes)
    assert read(path, part=(8.0, math.inf)).n == 200
    with pytest.raises(BadInput, match="lasts 10 s, and the part to use begins at 10 s"):
        read(path, part=(10.0, math.inf))


@pytest.mark.parametrize(
    ("part", "says"),
    [
        ((-5.0, -1.0), "before the first sample"),
        ((2.0, 1.0), "ends before it begins"),
        ((0.1005, 0.1007), "no sample lies between"),
        ((1.0, 2.0, 3.0), "must be such as"),
        ("1:b", "FROM:TO"),
    ],
)
def test_a_part_without_samples_never_stands_for_all_of_them(part, says):
    time = np.arange(1000) / 500.0
    with pytest.raises(BadInput, match=says):
        recordings_of({"time_s": time, "x_m": np.sin(80 * time)}, part=part)


def test_a_part_in_a_gap_of_the_time_stamps_is_said():
    time = np.concatenate([np.arange(500), 1000 + np.arange(500)]) / 500.0
    with pytest.raises(BadInput, match=r"no sample lies between 1.2 and 1.8 s"):
        recordings_of({"time_s": time, "x_m": np.sin(80 * time)}, part=(1.2, 1.8))
