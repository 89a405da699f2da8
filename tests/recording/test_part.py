from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, read
from dashpot.recording.part import cut_out, parse_part


def recording(n=1001):
    return Recording(name="r", fs=100.0, response=np.arange(n) * 1.0, force=np.ones(n), start=3.0)


@pytest.mark.parametrize(
    ("text", "part"), [("2:5", (2.0, 5.0)), (":5", (0.0, 5.0)), ("2.5:", (2.5, math.inf)), ("1e0:2", (1.0, 2.0))]
)
def test_a_part_is_understood(text, part):
    assert parse_part(text) == part


@pytest.mark.parametrize("text", ["5", "5:2", "a:b", "3:3", "nan:2", "1:2:3"])
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
