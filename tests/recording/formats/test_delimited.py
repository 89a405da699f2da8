"""Text files as loggers and spreadsheets write them."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.formats.delimited import read_delimited, seconds_of

ROWS = np.array([[0.0, 1.5], [0.1, -2.5e-3], [0.2, 3.0]])


@pytest.mark.parametrize(
    ("text", "names", "units"),
    [
        ("t,x\n0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("t", "x"), ("", "")),
        ("t,x\r\n0,1.5\r\n0.1,-2.5e-3\r\n0.2,3\r\n", ("t", "x"), ("", "")),
        ("\ufefft,x\n0,1.5\n0.1,-2.5e-3\n0.2,3", ("t", "x"), ("", "")),
        ("t;x\n0;1,5\n0,1;-2,5e-3\n0,2;3\n", ("t", "x"), ("", "")),
        ("t;x\n0;1.5\n0.1;-2.5e-3\n0.2;3\n", ("t", "x"), ("", "")),
        ("t\tx\n0\t1,5\n0,1\t-2,5e-3\n0,2\t3,0\n", ("t", "x"), ("", "")),
        ("t  x\n0  1.5\n 0.1 -2.5e-3\n0.2 3\n", ("t", "x"), ("", "")),
        ("t x\n0,0 1,5\n0,1 -2,5e-3\n0,2 3\n", ("t", "x"), ("", "")),
        ("t [s]  x [m]\n0 1.5\n0.1 -2.5e-3\n0.2 3\n", ("t[s]", "x[m]"), ("", "")),
        ('"t [s]", "x, raw [m]"\n0, 1.5\n0.1, -2.5e-3\n0.2, 3\n', ("t [s]", "x, raw [m]"), ("", "")),
        ('"t\n[s]","x\r\n[mm]"\n0,1.5\n0.1,-2.5e-3\n0.2,3\n', ("t [s]", "x [mm]"), ("", "")),
        ('t,x 5" [mm]\n0,1.5\n0.1,-2.5e-3\n0.2,3\n', ("t", 'x 5" [mm]'), ("", "")),
        ("t,x\ns,mm\n0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("t", "x"), ("s", "mm")),
        ("t,x\n[s],[mm]\n0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("t", "x"), ("s", "mm")),
        ("# logger 7\n% rig\nt,x\n0,1.5\n\n# pause\n0.1,-2.5e-3\n0.2,3\n\n", ("t", "x"), ("", "")),
        ("# t, x\n0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("t", "x"), ("", "")),
        ("# made on a Monday by me\n0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("", ""), ("", "")),
        ("0,1.5\n0.1,-2.5e-3\n0.2,3\n", ("", ""), ("", "")),
        ("t,x,\n0,1.5,\n0.1,-2.5e-3,\n0.2,3,\n", ("t", "x"), ("", "")),
    ],
)
def test_dialects(text, names, units):
    for content in (text.encode(), gzip.compress(text.encode())):
        table = read_delimited("rig.csv", content)
        assert (table.names, table.units) == (names, units)
        np.testing.assert_allclose(table.numbers([0, 1]), ROWS)
        np.testing.assert_allclose(table.numbers([1]), ROWS[:, 1:])


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_encodings(encoding):
    table = read_delimited("rig.csv", "t [s],x [µm]\n0,1.5\n0.1,-2.5e-3\n0.2,3\n".encode(encoding))
    assert table.names == ("t [s]", "x [µm]")
    np.testing.assert_allclose(table.numbers([0, 1]), ROWS)


def test_words_in_a_column_nobody_asks_for_do_no_harm():
    table = read_delimited("rig.csv", b"t,label,x\n0,up,1.5\n0.1,down,-2.5e-3\n0.2,,3\n")
    np.testing.assert_allclose(table.numbers([0, 2]), ROWS)


def test_many_rows():
    rows = np.random.default_rng(0).standard_normal((250_000, 3))
    text = "t,F,x\n" + "\n".join(f"{a:.6e},{b:.6e},{c:.6e}" for a, b, c in rows)
    np.testing.assert_allclose(read_delimited("rig.csv", text.encode()).numbers([0, 1, 2]), rows, rtol=1e-6)


GOOD = gzip.compress(b"t,x\n" + b"0.123,4.567\n" * 1000, mtime=0)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("rig.csv", b"", "is empty"),
        ("rig.csv.gz", b"", "is empty"),
        ("rig.csv", b" \n\n", "is empty"),
        ("rig.csv.gz", gzip.compress(b"", mtime=0), "is empty"),
        ("rig.csv", b"# nothing\n", "no rows of numbers"),
        ("rig.csv", b"t,x\n", "no rows of numbers below"),
        ("rig.csv", b"t,x\ns,mm\n", "no rows of numbers below"),
        ("rig.csv", bytes(range(256)), "binary"),
        ("rig.csv", bytes(range(128, 160)) * 20, "binary"),
        ("rig.csv.gz", GOOD[:-20], "cut short"),
        ("rig.csv.gz", GOOD[:20] + b"\xff\xff" + GOOD[22:], "cut short or damaged"),
        ("rig.csv.gz", b"t,x\n0,1\n", "not a gzip file"),
        ("rig.csv", b"t,x\n0,1\n0.1,2,3\n", "line 3 has 3 column.*have 2"),
        ("rig.csv", b"t,x\n# pause\n0,1\n0.1\n", "line 4 has 1 column"),
        ("rig.csv", b"t x\n0 1\n0.1 2 3\n", "line 3 has 3 column"),
        ("rig.csv", b't,x\n0,1\n"0.1,2"\n', "line 3 has 1 column"),
        ("rig.csv", b"t x\n0 1\n0.1 [2\n", "line 3 has 1 column"),
        ("rig.csv", b"t,F,x\n0,1\n0.1,2\n", "header names 3 columns but line 2 has 2"),
        ("rig.csv", b"t,x\n0,1\n0.1,OVERLOAD\n", "line 3, column 'x' holds 'OVERLOAD'"),
        ("rig.csv", b"t,x\n0,\n0.1,NA\n0.2,\n", "column 'x' is empty"),
        ("rig.csv", b"0,1\n0.1,abc\n", "line 2, column 2 holds 'abc'"),
    ],
)
def test_what_is_no_table_is_refused(name, content, words):
    with pytest.raises(BadInput, match=words) as caught:
        read_delimited(name, content).numbers([0, 1])
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(name)


def test_a_row_of_nothing_is_a_cell_of_nothing():
    with pytest.raises(BadInput, match="line 2, column 'a: 1' holds '1 2'"):
        read_delimited("rig.csv", b"a: 1\n1 2\n,").numbers([0])


@pytest.mark.parametrize("cell", ['"""a"', '"""a', '"""'])
def test_a_quote_within_a_cell_is_no_number_beside_cells_that_are_empty(cell):
    """Read once more with the empty cells as what they are, it was taken for the beginning of a longer cell."""
    content = f"t,y,x\n0,2,1\n0.1,3,NA\n0.2,{cell},4\n0.3,5,2\n"
    with pytest.raises(BadInput, match=r"rig\.csv: .*line 4"):
        read_delimited("rig.csv", content.encode()).numbers([0, 1, 2])


@pytest.mark.parametrize("header", ["t_s,x_mm,,", "t_s,x_mm,", "t_s,x_mm", "% t_s,x_mm,,", ",mass A,\nt_s,x_mm,,"])
@pytest.mark.parametrize("spare", ["", ",", ",,"])
def test_what_stands_behind_the_last_column_is_no_column(header, spare):
    """Spreadsheets make all rows as long as the longest, a preamble's; trackers of video end the header alone so."""
    rows = "\n".join(f"{0.01 * k:.2f},{k % 7}{spare}" for k in range(40))
    table = read_delimited("spare.csv", f"{header}\n{rows}\n".encode())
    assert table.names == ("t_s", "x_mm")
    assert table.numbers([1])[:9, 0].tolist() == [0, 1, 2, 3, 4, 5, 6, 0, 1]


@pytest.mark.parametrize("word", ["", "NA", "#N/A", "null", "NaN"])
def test_a_sample_without_a_number_is_bridged_and_said(tmp_path, word):
    clean = np.sin(0.02 * np.pi * np.arange(400))
    rows = "\n".join(f"{0.01 * k:.2f},{word if k == 230 else repr(x)},0" for k, x in enumerate(clean.tolist()))
    (tmp_path / "hole.csv").write_text(f"t_s,x_mm,F_N\n{rows}\n")
    recording = read(tmp_path / "hole.csv", checked=False)
    assert np.allclose(1e3 * recording.response, clean, rtol=0, atol=1e-5)
    assert recording.blank == ((230, 231),)
    assert any("1 sample(s) are missing" in note for note in recording.notes)


def test_a_channel_that_ends_before_the_others_ends_the_record(tmp_path):
    rows = "\n".join(f"{0.01 * k:.2f},{k % 7},{'' if k > 37 else k}" for k in range(40))
    table = read_delimited("ends.csv", f"t_s,x_mm,F_N\n{rows}\n".encode())
    assert np.isnan(table.numbers([1, 2])[38:, 1]).all()
    assert np.isfinite(table.numbers([1, 2])[:38]).all()
    assert np.isfinite(table.numbers([0, 1])).all()
    (tmp_path / "ends.csv").write_text(f"t_s,x_mm,F_N\n{rows}\n")
    recording = read(tmp_path / "ends.csv", checked=False)
    assert recording.n == 38
    assert any("2 row(s) behind its end were left out" in note for note in recording.notes)
    assert read(tmp_path / "ends.csv", force="none", response="x_mm", checked=False).n == 40


@pytest.mark.parametrize("units", ["", "s,mm,\n"])
def test_a_column_with_a_name_is_one_where_it_is_empty_throughout(units):
    rows = "\n".join(f"{0.01 * k:.2f},{k % 7}," for k in range(40))
    table = read_delimited("notes.csv", f"t,x,remark\n{units}{rows}\n".encode())
    assert table.names == ("t", "x", "remark")
    assert table.numbers([0, 1]).shape == (40, 2)
    with pytest.raises(BadInput, match="'remark' is empty"):
        table.numbers([0, 1, 2])


def test_an_infinite_number_at_the_end_is_no_end_of_a_channel(tmp_path):
    rows = "\n".join(f"{0.01 * k:.2f},{k % 7},{'inf' if k > 37 else k}" for k in range(40))
    (tmp_path / "over.csv").write_text(f"t_s,x_mm,F_N\n{rows}\n")
    with pytest.raises(BadInput, match=r"over\.csv"):
        read(tmp_path / "over.csv")


# Times of day, with dates of any order: seconds that go on over midnight; what is none is left to be refused.


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
