"""Text files of odd loggers, spreadsheets and accidents, each with what must come of it: its numbers, or a sentence."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.checks import check

TIME = np.arange(600) / 500.0
X = 5e-3 * np.exp(-3 * TIME) * np.cos(80 * TIME) + 1e-6 * np.random.default_rng(0).standard_normal(TIME.size)


def text(header="time_s,x_m", time="{:.6g}".format, x="{:.9g}".format, delimiter=","):
    return "\n".join([header, *(f"{time(t)}{delimiter}{x(v)}" for t, v in zip(TIME, X, strict=True))])


def between(word):
    """``word`` instead of the numbers from 0.4 s on, for a tenth of a second."""
    rows = text().split("\n")
    return "\n".join(f"{row.split(',')[0]},{word}" if 200 < place < 250 else row for place, row in enumerate(rows))


def turned():
    """What a ring buffer gives whose end was not put in order."""
    head, *rows = text().split("\n")
    return "\n".join([head, *rows[300:], *rows[:300]])


NO_NUMBER = "which is not a number; mend or remove that line"
#: What is in the file, and the sentence that refuses it; None where its numbers must come out.
FILES = {
    "digits of full width": (text().translate(str.maketrans("0123456789", "０１２３４５６７８９")), "cannot be read"),
    "underscores": (text(x=lambda v: f"{v:.9f}".replace("0.0", "0.0_")), "cannot be read|not a number"),
    "exponents of Fortran": (text(x=lambda v: f"{v:.8E}".replace("E", "D")), NO_NUMBER),
    "a typographic minus": (text(x=lambda v: f"{v:.9g}".replace("-", "\u2212")), NO_NUMBER),
    "hexadecimal": (text(x=lambda v: float(v).hex()), NO_NUMBER),
    "per cent": (text(x="{:.9g}%".format), NO_NUMBER),
    "units in the cells": (text(x="{:.9g} m".format), NO_NUMBER),
    "a clock's time": (text(time=lambda t: f"12:59:{t:06.3f}"), None),
    "dates with a zone": (text(time=lambda t: f"2026-10-25T02:00:{t:06.3f}+02:00"), None),
    "a ring buffer": (turned(), "time does not increase"),
    "two files in one": (text() + "\n" + text(), NO_NUMBER),
    "not a number for a while": (between("NaN"), None),
    "nothing for a while": (between(""), None),
    "not available for a while": (between("NA"), None),
    "a word for a while": (between("OVER"), NO_NUMBER),
    "a code for a while": (between("-999"), "only 1 oscillation|the unit is probably"),
    "a unit of another code page": (text("time_s,x [\u00e6m]"), "unit .* is not known"),
    "inches as a mark": (text('time_s,x (")'), "unit .* is not known"),
    "minutes": (text("time (min),x_m"), "unit 'min' is not known"),
    "one name twice": (text("time_s,x_m,x_m", x=lambda v: f"{v:.9g},{v:.9g}"), "cannot tell which of the columns"),
    "one name in two cases": (text("time_s,X_m,x_m", x=lambda v: f"{v},{2 * v}"), "cannot tell which of the columns"),
    "no time that passes": (text(time=lambda _: "0"), "time does not increase"),
    "null bytes": (text().replace("0.5,", "0.\x005,"), "is a binary file"),
    "the end of a file of DOS": (text() + "\n\x1a", "has 1 column.s. where the lines before have 2"),
    "prose": ("lorem ipsum, dolor\n" * 500, "cannot tell which of the columns|not a number"),
    "a page of the web": ("<html><table><tr><td>1</td></tr></table></html>\n" * 30, NO_NUMBER),
    "denormal numbers": (text(x=lambda v: repr(float(v) * 1e-317)), "less than any sensor resolves"),
    "numbers beyond all": (text(x=lambda v: repr(float(v) * 1e12)), "the unit is probably um"),
    "the Greek mu": (text("time_s,x [\u03bcm]", x=lambda v: f"{1e6 * v:.9g}"), None),
    "the micro sign": (text("time_s,x [\u00b5m]", x=lambda v: f"{1e6 * v:.9g}"), None),
    "units in a row": (text("time,x\ns,mm", x=lambda v: f"{1e3 * v:.9g}"), None),
    "German, with commas": (
        text("Zeit;Weg\ns;mm", "{:.6f}".format, lambda v: f"{1e3 * v:.9f}", ";").replace(".", ","),
        None,
    ),
    "a formula as a name": (text("time_s,=cmd|x_m"), None),
    "colours in a name": (text("time_s,x\x1b[31mred\x1b[0m_m"), None),
}


@pytest.mark.parametrize("packed", [False, True], ids=["plain", "packed"])
@pytest.mark.parametrize(("content", "refused"), FILES.values(), ids=FILES)
def test_a_file_gives_its_own_numbers_or_a_sentence(tmp_path, content, refused, packed):
    path = tmp_path / ("rec.csv.gz" if packed else "rec.csv")
    path.write_bytes(gzip.compress(content.encode()) if packed else content.encode())
    if refused is None:
        recording = read(path)
        there = np.ones(recording.n, bool)
        for start, stop in recording.blank:
            there[start:stop] = False
        assert recording.response[there] == pytest.approx(X[there], abs=1e-9)
        assert recording.response == pytest.approx(X, abs=0.02 * np.ptp(X))
        assert read(path).fs == pytest.approx(500.0, rel=1e-6)
        return
    with pytest.raises(BadInput, match=refused):
        checked(path)


def checked(path):
    if errors := [problem.sentence for problem in check(read(path)) if problem.severity == "error"]:
        raise BadInput("\n".join(errors))
