"""Times of day, with dates of any order: seconds that go on over midnight; what is none is left to be refused."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.formats.clock import seconds_of


@pytest.mark.parametrize(
    ("cell", "seconds"),
    [
        ("11:02:42", 39762.0),
        ("2021-05-07 11:02:42.10", 39762.1),
        ("2021-05-07T11:02:42.125Z", 39762.125),
        ("5/7/2021  11:02:42.732267", 39762.732267),
        ("07.05.2021 11:02:42,5", 39762.5),
        ("02:00:01.5 PM", 50401.5),
        ("12:00:01 am", 1.0),
        ("2021-05-07 11:02:42+02:00", 39762.0),
    ],
)
def test_a_time_of_day(cell, seconds):
    found = seconds_of([cell])
    assert found is not None
    assert found[0] == pytest.approx(seconds, abs=1e-9)


@pytest.mark.parametrize("cell", ["11:02", "25:00:00", "11:62:00", "2021-05-07", "1.5", "a 11:02:42", ""])
def test_what_is_none(cell):
    assert seconds_of(["11:02:42", cell]) is None


def test_midnight_is_passed():
    found = seconds_of(["23:59:59.9", "00:00:00.0", "00:00:00.1"])
    assert found is not None
    assert np.diff(found) == pytest.approx([0.1, 0.1], abs=1e-9)


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_a_file_with_dates_is_read(tmp_path, delimiter):
    t = np.arange(600) / 50.0
    x = 3.0 * np.exp(-0.2 * t) * np.cos(2 * np.pi * 2.0 * t)
    rows = [f"2021-05-07 11:02:{42 + s:06.3f}{delimiter}{v:.6f}" for s, v in zip(t, x, strict=True)]
    path = tmp_path / "rec.csv"
    path.write_text("\n".join([f"time{delimiter}x_mm", *rows]))
    recording = read(path)
    assert recording.fs == pytest.approx(50)
    assert recording.response == pytest.approx(1e-3 * x, abs=1e-9)


def test_a_cell_that_is_no_time_is_named(tmp_path):
    path = tmp_path / "rec.csv"
    path.write_text("time,x_mm\n11:02:42.1,1\n11:02:42.2,2\nnoon,3\n")
    with pytest.raises(BadInput, match="line 4, column 'time' holds 'noon', which is not a number"):
        read(path)
