"""Recordings of every kind that a logger, a spreadsheet or an accident makes: read as they were meant, or refused.

A file that is well written in any of the habits gives exactly its numbers or a sentence, never others; whatever else
the bytes are, there is a recording or a sentence.
"""

from __future__ import annotations

import gzip
import random

import numpy as np
import pytest
from dashpot.recording import Recording, read
from hypothesis import strategies as st

N = 300
TIME = np.arange(N) / 500.0
RESPONSE = 5e-3 * np.exp(-3 * TIME) * np.cos(80 * TIME) + 1e-6 * np.random.default_rng(0).standard_normal(N)
FORCE = 1.5 * np.sin(70 * TIME + 5 * TIME**2) + 1e-4 * np.random.default_rng(1).standard_normal(N)

ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "latin-1", "cp1252")
PREAMBLES = ("", "# made by a logger\n", "% a comment\n#\n", "\n\n", "# time_s force_N x_m\n", "# 3 channels, 500 Hz\n")
ENDS = ("\n", "\r\n", "\r", "\n\n")
HEADERS = {
    "plain": ("time_s", "force_N", "x_m"),
    "brackets": ("Time [s]", "Force [N]", "Displacement [m]"),
    "round": ("t (s)", "F (N)", "x (m)"),
    "bare": ("time", "force", "displacement"),
    "quoted": ('"time_s"', '"force_N"', '"x_m"'),
    "none": (),
}
#: How the three columns of a file are scaled and written: enough digits that nothing is lost beyond rounding.
NUMERALS = {
    "plain": "{:.9g}",
    "exponents": "{:.8e}",
    "capitals": "{:+.8E}",
    "fixed": "{:.9f}",
    "comma": "{:.9f},",
    "comma and exponent": "{:.8e},",
    "quoted": '"{:.9g}"',
    "padded": "  {:12.9f} ",
    "grouped": "{:,.9f}",
}


def cell(value: float, how: str) -> str:
    text = NUMERALS[how].format(value)
    return text[:-1].replace(".", ",") if NUMERALS[how].endswith(",") else text


@st.composite
def well_written(draw):
    """A file's bytes, the columns' numbers from 1 where they must be said, and whether it holds the force."""
    delimiter, how = draw(st.sampled_from([",", ";", "\t", " ", "; ", ", "])), draw(st.sampled_from(sorted(NUMERALS)))
    header, forced = draw(st.sampled_from(sorted(HEADERS))), draw(st.booleans())
    columns = [TIME, FORCE, RESPONSE] if forced else [TIME, RESPONSE]
    names = [name for i, name in enumerate(HEADERS[header]) if forced or i != 1]
    trailing = delimiter.strip() if draw(st.integers(0, 5)) == 0 else ""
    rows = [delimiter.join(names) + trailing] if names else []
    if names and draw(st.integers(0, 4)) == 0:
        rows.append(delimiter.join(["s", "N", "m"] if forced else ["s", "m"]) + trailing)
    rows += [delimiter.join(cell(v, how) for v in row) + trailing for row in zip(*columns, strict=True)]
    text = draw(st.sampled_from(PREAMBLES)) + draw(st.sampled_from(ENDS)).join(rows) + draw(st.sampled_from(["", "\n"]))
    content = text.encode(draw(st.sampled_from(ENCODINGS)))
    return gzip.compress(content, 1) if draw(st.booleans()) else content, forced, bool(names)


def test_any_well_written_file_gives_its_own_numbers(every, unless_refused, tmp_path):
    right = 0

    def holds(made):
        nonlocal right
        content, forced, named = made
        path = tmp_path / "rec.csv"
        path.write_bytes(content)
        options = {} if named else {"time": 1, "response": 2 + forced, **({"force": 2} if forced else {})}
        recording = unless_refused(read, path, **options)
        if recording is None:
            return
        right += 1
        assert recording.n == N
        assert recording.fs == pytest.approx(500.0)
        assert np.allclose(recording.response, RESPONSE, rtol=0, atol=1e-9)
        assert (recording.force is None) != forced
        if forced:
            assert np.allclose(recording.force, FORCE, rtol=0, atol=1e-8)

    every(well_written(), holds, 500)
    assert right > 20 or right == 1  # not all may be refused


GOOD = "time_s,force_N,x_m\n" + "\n".join(
    f"{t:.3f},{f:.6g},{x:.7g}" for t, f, x in zip(TIME, FORCE, RESPONSE, strict=True)
)
#: What files hold that break what reads them.
ODD = (
    "", " ", "\0", "\ufeff", "\ufffe", "é", "\x1a", "\x85", "\u2028", "\x0b", "\x0c", "\u202f", "\u0663", "\ud7ff",
    "𝟘", "nan", "NaN", "inf", "-Infinity", "1e400", "-1e-400", "1_000", "0x1p3", "1e", "+-1", "..", "1.2.3",
    "1,2,3", ",", ";", "\t", '"', "'", '""', '"a\nb"', "#", "%", "\n", "\r", "\r\n", "//", "\\", "=1+1", "-", "N/A",
    "#N/A", "[", "]", "(", ")", "[mm]", "{", "}", "{0}", "%s", "%n", "time_s", "s", "N", "m", "µm", "m/s^2", "V",
    "x" * 5000, "12:00:00", "2024-01-01T00:00:00Z", "1.234,5", "1'234", "1 234", "1e38", "1e308", "9" * 400, "true",
    "None",
)  # fmt: skip
OPTIONS = st.fixed_dictionaries(
    {},
    optional={
        "time": st.sampled_from(["1", "2", "none", "time_s", "x", "", "9", "-1", "\0", "[", "9" * 30, "²"]),
        "force": st.sampled_from(["1", "2", "none", "force_N", "F", "", "0"]),
        "response": st.sampled_from(["1", "3", "none", "x_m", "x", "time_s", "", "a\nb"]),
        "quantity": st.sampled_from(["displacement", "velocity", "acceleration", "position"]),
        "unit": st.sampled_from(["mm", "m", "g", "V", "", "m/s", "\n", "rad", "µε", "furlong", "{}"]),
        "force_unit": st.sampled_from(["N", "kN", "V", "m", ""]),
        "fs": st.one_of(st.floats(), st.sampled_from([500.0, 0.0, -1.0, 1e308, 5e-324])),
        "part": st.tuples(st.floats(), st.floats()),
        "hold": st.sampled_from(["zero", "linear", "smooth", "odd"]),
        "max_size": st.sampled_from([1e-6, 1.0, 500.0]),
    },
)


@st.composite
def damaged(draw):
    """The bytes of a good file after some accidents: spans lost, repeated, moved, replaced."""
    dice = random.Random(draw(st.integers(0, 2**32)))
    content = bytearray(GOOD.encode())
    if draw(st.booleans()):
        content = content.replace(b",", dice.choice([b";", b"\t", b" ", b" , ", b",,"]))
    for _ in range(draw(st.integers(0, 8))):
        at = dice.choice([dice.randrange(len(content) + 1), dice.randrange(min(40, len(content) + 1))])
        span = dice.choice([0, 1, 1, 4, 20, 200, 4000])
        piece = dice.choice(ODD).encode("utf-8", "surrogatepass")
        kind = dice.randrange(5)
        if kind == 0:
            content[at : at + span] = b""
        elif kind == 1:
            content[at:at] = content[at : at + span] * dice.choice([1, 3])
        elif kind == 2:
            content[at : at + span] = bytes(dice.randrange(256) for _ in range(dice.choice([1, 3, 30])))
        else:
            content[at : at + min(span, 20)] = piece
    encoding = dice.choice(["", "", "", "utf-16", "utf-16-be", "utf-32"])
    text = bytes(content)
    if encoding:
        text = text.decode("latin-1").encode(encoding)
    if dice.randrange(6) == 0:
        packed = bytearray(gzip.compress(text, 1))
        for _ in range(dice.randrange(4)):
            packed[dice.randrange(len(packed))] = dice.randrange(256)
        text = bytes(packed[: dice.choice([len(packed), dice.randrange(len(packed) + 1)])])
    return text


@st.composite
def tables(draw):
    """A small text of cells that are numbers, words or neither, in rows that need not agree."""
    dice = random.Random(draw(st.integers(0, 2**32)))
    delimiter = dice.choice([",", ";", "\t", " ", "|"])
    width = dice.choice([1, 2, 3, 3, 3, 4, 40])
    words = ("time_s", "t", "x_mm", "F", "force [kN]", "a (g)", "v_m_s", "s", "m", "", "#", "x", "x", "[", "Time / s")

    def row(i):
        if dice.randrange(60) == 0:
            return [dice.choice(ODD) for _ in range(dice.choice([width, dice.randrange(5)]))]
        return [f"{i * 10.0 ** dice.randrange(-3, 3) if j == 0 else dice.gauss(0, 1):.6g}" for j in range(width)]

    rows = [[dice.choice(words) for _ in range(width)] for _ in range(dice.choice([0, 1, 1, 2, 3]))]
    rows += [row(i) for i in range(dice.choice([0, 1, 2, 3, 20, 200]))]
    return dice.choice(["\n", "\r\n", "\r"]).join(delimiter.join(cells) for cells in rows).encode("utf-8", "replace")


@pytest.mark.parametrize("kind", [damaged(), tables(), st.binary(max_size=400), st.text(max_size=400)], ids=str)
def test_any_bytes_are_a_recording_or_a_sentence(every, unless_refused, tmp_path, kind):
    names = st.sampled_from(["rec.csv", "rec.txt", "rec.csv.gz", "rec.TSV", "rec.dat", "rec.xlsx", "rec", ".gz"])

    def holds(given):
        content, name, options = given
        path = tmp_path / name
        path.write_bytes(content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content)
        recording = unless_refused(read, path, **options)
        if recording is not None:
            assert isinstance(recording, Recording)
            assert np.isfinite(recording.response).all()
            assert recording.force is None or np.isfinite(recording.force).all()
            assert 0 < recording.fs < np.inf
            assert all(note.strip() for note in recording.notes)

    every(st.tuples(kind, names, OPTIONS), holds)
