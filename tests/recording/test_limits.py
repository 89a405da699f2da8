"""Files that never end, numbers that nothing gives, times and numerals of other habits: read rightly, or refused."""

from __future__ import annotations

import gzip
import os

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.checks import impossible
from dashpot.recording.formats.delimited import numerals_of

FS, N = 500.0, 1000
T = np.arange(N) / FS
X = 5e-3 * np.exp(-2 * T) * np.cos(2 * np.pi * 12 * T) + 1e-6 * np.random.default_rng(0).standard_normal(N)
F = np.sin(2 * np.pi * 11 * T)


def csv(path, time, header="time_s,x_m", delimiter=",", response=X, write="{:.9g}"):
    rows = [
        delimiter.join([*(str(t) for t in [stamp]), write.format(x)]) for stamp, x in zip(time, response, strict=True)
    ]
    path.write_text("\n".join([header, *rows]), encoding="utf-8")
    return path


def pipe(path):
    os.mkfifo(path)


FILES = {
    "a pipe": (pipe, "is a pipe or a device, which may never end; save it as a file first"),
    "a device": (lambda path: path.symlink_to("/dev/zero"), "is a pipe or a device"),
    "a long file": (
        lambda path: path.write_bytes(b"1,2\n" * 300_000),
        "holds more than 1 MB; .* raise the limit with --max-size",
    ),
    "a bomb": (lambda path: path.write_bytes(gzip.compress(bytes(50_000_000))), "holds more than 1 MB"),
    "a cut archive": (lambda path: path.write_bytes(gzip.compress(b"1,2\n" * 999)[:30]), "cut short or damaged"),
    "a folder": (lambda path: path.mkdir(), "is a folder"),
    "no rows but one": (lambda path: path.write_bytes(b"1," * 20_000), "has 20000 columns, more than the 16384 of a"),
    "a name without end": (
        lambda path: path.write_bytes(b"t,x" + b"1" * 5000 + b"z\n" + b"1,2\n" * 50),
        "the name of column 2 has 5002 characters; shorten it",
    ),
    "a circle": (lambda path: path.symlink_to(path), "leads back to itself; name the file"),
}


@pytest.mark.skipif(os.name != "posix", reason="of POSIX")
@pytest.mark.parametrize(("make", "says"), FILES.values(), ids=FILES)
def test_a_file_that_cannot_be_a_recording(tmp_path, make, says):
    make(tmp_path / "rec.csv")
    with pytest.raises(BadInput, match=says):
        read(tmp_path / "rec.csv", max_size=1.0)


def test_the_limit_can_be_raised(tmp_path):
    csv(tmp_path / "rec.csv", T)
    with pytest.raises(BadInput, match=r"more than 0\.01 MB"):
        read(tmp_path / "rec.csv", max_size=0.01)
    assert read(tmp_path / "rec.csv", max_size=0.1).n == N


@pytest.mark.parametrize(
    ("header", "scale", "begin"),
    [
        ("timestamp,x_m", 1.0, 1.7e9),
        ("timestamp,x_m", 1e3, 1.7e12),
        ("time,x_m", 1e6, 1.7e15),
        ("t,x_m", 1e9, 1.7e18),
        ("time_ms,x_m", 1e3, 1.7e12),
        ("time_us,x_m", 1e6, 0),
    ],
)
def test_ticks_since_1970_are_known(tmp_path, header, scale, begin):
    stamps = [int(begin) + round(t * scale) for t in T] if scale > 1 else [f"{begin + t:.3f}" for t in T]
    recording = read(csv(tmp_path / "rec.csv", stamps, header))
    assert (recording.fs, recording.start, recording.n) == (pytest.approx(FS, rel=1e-6), 0.0, N)
    assert np.allclose(recording.response, X, atol=1e-9)
    assert any("since 1970" in note for note in recording.notes) == (begin > 0)


@pytest.mark.parametrize(
    ("header", "stamps", "says"),
    [
        (
            "time,x_m",
            np.arange(N),
            r"holds the whole numbers 0, 1, \.\.\. without a unit; say it: --calibration time='1 ms' if 1000",
        ),
        (
            "Time Stamp,x_m",
            19_202_812 + np.cumsum(np.where(np.arange(N) % 2, 1868, 1876)),
            r"holds the whole numbers .* time='1 us' if 53",
        ),
        ("t,x_m", 2 * np.arange(N), r"holds the whole numbers 0, 2, \.\.\. without a unit"),
        ("time_s,x_m", 1_700_000_000_000 + np.arange(N), "thousands of years from now; check the unit"),
        (
            "time,x_m",
            5_000_000_000_000_000_000_000 + 1e15 * np.arange(N),
            "which is no time in seconds; write its unit",
        ),
    ],
)
def test_what_cannot_be_seconds_is_said(tmp_path, header, stamps, says):
    with pytest.raises(BadInput, match=says):
        read(csv(tmp_path / "rec.csv", stamps, header))


def test_a_count_of_samples_is_no_clock(tmp_path):
    recording = read(csv(tmp_path / "rec.csv", np.arange(N), "time,x_m"), fs=FS)
    assert (recording.fs, recording.start) == (FS, 0.0)
    assert any("counts the samples" in note for note in recording.notes)


#: How a number is written, by what stands between cells.
HABITS = [
    (";", lambda v: f"{v:.3f}".replace(".", ",")),
    (";", lambda v: f"{v:,.2f}"),
    ("\t", lambda v: f"{v:,.2f}"),
    (";", lambda v: f"{v:,.2f}".translate({44: ".", 46: ","})),
    (";", lambda v: f"{v:,.2f}".replace(",", "'")),
    (";", lambda v: f"{v:,.2f}".replace(",", "\u202f").replace(".", ",")),
    ("\t", lambda v: f"{v:,.2f}".replace(",", "\u00a0")),
    (",", lambda v: f'"{v:,.2f}"'),
    (",", lambda v: f"{v:.2f}"),
]


@pytest.mark.parametrize(("delimiter", "write"), HABITS)
def test_numerals_of_other_habits(tmp_path, delimiter, write):
    rows = [f"{write(1000 * t)}{delimiter}{write(2e6 * x)}" for t, x in zip(T, X, strict=True)]
    path = tmp_path / "rec.csv"
    path.write_text("\n".join([f"time_ms{delimiter}x_um", *rows]), encoding="utf-8")
    recording = read(path)
    assert recording.fs == pytest.approx(FS)
    assert np.allclose(recording.response, 2 * X, atol=0.6e-8)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1,234;5\n2,345;6", "cannot tell whether 1,234 has a decimal comma or a sign that groups thousands"),
        ("0,5;1,234.5", "comma and point are each used as the decimal sign"),
        ("1,5;2.5", "each used as the decimal sign"),
        ("1.234.567;0.5", "each used as the decimal sign"),
    ],
)
def test_numerals_that_contradict_are_said(text, says):
    with pytest.raises(BadInput, match=says):
        numerals_of("rec.csv", text)


@pytest.mark.parametrize("value", [1e38, 1e160, -1e31, 1e12])
def test_a_sample_that_nothing_gives(tmp_path, value):
    force = F.copy()
    force[300] = value
    rows = "\n".join(f"{t:.3f},{f:.6g},{x:.9g}" for t, f, x in zip(T, force, X, strict=True))
    (tmp_path / "rec.csv").write_text(f"time_s,force_N,x_m\n{rows}")
    with pytest.raises(BadInput, match=r"the force is \S+ N at 0\.6 s, .*; mend or cut out that sample"):
        read(tmp_path / "rec.csv")


def test_blows_and_silence_are_possible():
    noise = 1e-6 * np.random.default_rng(1).standard_normal(N)
    blow = noise.copy()
    blow[500] = 10.0
    for signal in (blow, np.eye(1, N, 500)[0], X, 1e29 * F, np.zeros(N)):
        assert impossible(signal) is None


@pytest.mark.skipif(os.name != "posix", reason="of POSIX")
def test_what_is_shown_as_a_file_and_lets_wait_is_not_waited_for(tmp_path, monkeypatch):
    # As the kernel's /proc/kmsg does while it has nothing to tell; here the end of a pipe that nobody writes to.
    reading, writing = os.pipe()
    os.set_blocking(reading, False)
    (tmp_path / "rec.csv").write_text("1,2\n", encoding="utf-8")
    monkeypatch.setattr("dashpot.recording.content.at_once", lambda path, flags: reading)
    with pytest.raises(BadInput, match="a pipe or a device, which may never end"):
        read(tmp_path / "rec.csv")
    os.close(writing)


def test_the_unit_of_the_time_column_can_be_said(tmp_path):
    stamps = 19_202_812 + np.cumsum(np.where(np.arange(N) % 2, 1998, 2002))
    path = csv(tmp_path / "rec.csv", stamps, "Time Stamp,x_m")
    recording = read(path, calibration={"time": "1 us"})
    assert recording.fs == pytest.approx(500, rel=1e-6)
    with pytest.raises(BadInput, match="has the unit 'N'; choose with --time"):
        read(path, calibration={"time": "1 N"})


@pytest.mark.parametrize("power", [-300, 300])
def test_a_rate_that_no_recorder_has(tmp_path, power):
    path = csv(tmp_path / "rec.csv", [f"{i}e{power}" for i in range(N)])
    with pytest.raises(BadInput, match="none that a recorder has; check the unit of the time column"):
        read(path)
    with pytest.raises(BadInput, match="none that a recorder has; check --fs"):
        read(path, time="none", response=2, fs=10.0**power)


@pytest.mark.parametrize(("header", "known"), [("time,x_m", True), ("time_s,x_m", True), ("time,x_m", False)])
def test_days_of_spreadsheets_are_known(tmp_path, header, known):
    """45000.5 is noon of a day in 2023; a clock in seconds may show the same, but not a million samples in one."""
    stamps = [repr(float(45_000.5 + t / (86_400.0 if known else 1.0))) for t in T]
    recording = read(csv(tmp_path / "rec.csv", stamps, header))
    assert (recording.fs, recording.n) == (pytest.approx(FS, rel=1e-4), N)
    assert np.allclose(recording.response, X, atol=1e-9)
    assert any("holds days as spreadsheets count them" in note for note in recording.notes) == known
