"""From file to Recording."""

from __future__ import annotations

import gzip
import hashlib
import os
from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read

FS = 1000.0
TIME = np.arange(4000) / FS
DECAY = 5e-3 * np.exp(-2.5 * TIME) * np.cos(2 * np.pi * 12.67 * TIME)


def write(path: Path, header: str, *columns: np.ndarray) -> Path:
    rows = "\n".join(",".join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    text = f"{header}\n{rows}\n" if header else rows
    path.write_bytes(gzip.compress(text.encode()) if path.suffix == ".gz" else text.encode())
    return path


@pytest.mark.parametrize("name", ["decay.csv", "decay.CSV", "run.2.csv.gz", "decay.txt"])
def test_free_decay(tmp_path, name):
    path = write(tmp_path / name, "time_s,displacement_mm", TIME + 2, 1e3 * DECAY)
    recording = read(path)
    np.testing.assert_allclose(recording.response, DECAY, atol=1e-11)
    assert (recording.fs, recording.start, recording.force) == (FS, 2.0, None)
    assert (recording.name, recording.unit, recording.quantity, recording.notes) == (name, "m", "displacement", ())
    assert recording.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("header", "options", "factor", "unit", "quantity"),
    [
        ("acceleration_g", {}, 9.80665, "m/s2", "acceleration"),
        ("velocity_m_s", {}, 1.0, "m/s", "velocity"),
        ("phi_deg", {}, np.pi / 180, "rad", "displacement"),
        ("strain0_microstrain", {}, 1e-6, "strain", "displacement"),
        ("Displacement [µm]", {}, 1e-6, "m", "displacement"),
        ("probe_V", {"quantity": "velocity"}, 1.0, "V", "velocity"),
        ("displacement_m", {"unit": "mm"}, 1e-3, "m", "displacement"),
        ("displacement_furlong [furlong]", {"unit": "mm"}, 1e-3, "m", "displacement"),
    ],
)
def test_units_and_quantities(tmp_path, header, options, factor, unit, quantity):
    recording = read(write(tmp_path / "r.csv", header, DECAY), fs=FS, checked=False, **options)
    np.testing.assert_allclose(recording.response, factor * DECAY, rtol=1e-8)
    assert (recording.unit, recording.quantity) == (unit, quantity)


def test_force_and_time_are_converted(tmp_path):
    path = write(tmp_path / "r.csv", "Time [ms],Force [kN],x_m", 1e3 * TIME, np.sin(TIME), DECAY)
    recording = read(path, checked=False)
    assert recording.fs == pytest.approx(FS)
    assert recording.force is not None
    np.testing.assert_allclose(recording.force, 1e3 * np.sin(TIME), rtol=1e-8)
    assert read(path, force_unit="N", checked=False).force == pytest.approx(np.sin(TIME), rel=1e-8)


def test_a_file_without_header(tmp_path):
    path = write(tmp_path / "r.csv", "", TIME, DECAY)
    recording = read(path, time=1, response=2)
    assert recording.fs == FS
    assert "m is assumed" in recording.notes[0]
    assert read(path, time=1, response=2, unit="m").notes == ()


def test_unchecked_reading_says_nothing_of_the_signal(tmp_path):
    path = write(tmp_path / "r.csv", "x_m", np.zeros(100))
    assert read(path, fs=FS, checked=False).n == 100
    with pytest.raises(BadInput, match="throughout"):
        read(path, fs=FS)


def test_all_errors_come_at_once(tmp_path):
    path = write(tmp_path / "r.csv", "x_m", np.sin(2 * np.pi * 400 * TIME))
    with pytest.raises(BadInput) as caught:
        read(path, fs=FS)
    assert "samples a cycle" in str(caught.value)
    assert "pass --unit" in str(caught.value)


def test_a_decay_beside_an_idle_force_sensor_is_free(tmp_path):
    noise = np.random.default_rng(0).standard_normal((2, len(TIME)))
    path = write(tmp_path / "r.csv", "time_s,force_N,x_m", TIME, 1e-3 * noise[0], DECAY + 1e-6 * noise[1])
    recording = read(path)
    assert recording.force is None
    assert "left out" in recording.notes[0]


@pytest.mark.parametrize(
    ("header", "columns", "options", "words"),
    [
        ("x_m", [DECAY], {}, "no time column.*--time.*--fs"),
        ("t_s,x_m", [TIME, DECAY], {"fs": 500.0}, "--fs says 500 Hz but the time column says 1000 Hz"),
        ("t_s,x_m", [TIME, DECAY], {"unit": "milimeter"}, "--unit.*did you mean millimeter"),
        ("t_s,x [furlong]", [TIME, DECAY], {}, "column 'x .furlong.': unit 'furlong' is not known"),
        ("t_s,x_m", [TIME, DECAY], {"quantity": "velocity"}, "contradicts the unit 'm'"),
        ("t_s,x_m", [TIME, DECAY], {"quantity": "speed"}, "quantity 'speed' is not known"),
        ("t_s,x_m", [TIME, DECAY], {"response": "t_s", "time": "none"}, "'t_s' has the unit 's'.*--response"),
        ("t_s,x_m,y_m", [TIME, DECAY, DECAY], {"force": "y_m", "response": "x_m"}, "'y_m'.*none of a force"),
        ("t_s,x_m", [TIME, DECAY], {"time": "x_m", "response": "t_s", "unit": "m"}, "time column 'x_m' has the unit"),
        ("V1_V,V2_V", [DECAY, DECAY], {"fs": FS}, "--response, and what drives it with --base"),
    ],
)
def test_bad_input(tmp_path, header, columns, options, words):
    with pytest.raises(BadInput, match=words) as caught:
        read(write(tmp_path / "rig.csv", header, *columns), **options)
    assert "rig.csv" in str(caught.value) or "quantity" in options
    assert "\n" not in str(caught.value)


def test_bad_paths(tmp_path):
    with pytest.raises(BadInput, match="does not exist"):
        read(tmp_path / "absent.csv")
    with pytest.raises(BadInput, match="folder"):
        read(tmp_path)
    (tmp_path / "r.ods").write_text("t,x")
    with pytest.raises(BadInput, match=r"'\.ods' cannot be read; supported are \.csv"):
        read(tmp_path / "r.ods")


SHARED = Path(os.environ.get("DASHPOT_DATA", Path(__file__).parents[2].parent / "shared" / "data"))
SILVERBOX = {"fs": 610.3515625, "force": "V1_V", "response": "V2_V"}


@pytest.mark.parametrize(
    ("name", "options", "n", "fs", "unit"),
    [
        ("silverbox_snls80mv", SILVERBOX, 131072, 610.3515625, "V"),
        ("emps_train", {}, 24841, 1000.0, "m"),
        ("kvlcc2_roll_21338", {}, 19464, 100.0, "rad"),
        ("frid_magmech_decay", {}, 29000, 1000.0, "strain"),
    ],
)
def test_real_recordings_raise_no_false_alarm(name, options, n, fs, unit):
    path = SHARED / f"{name}.csv.gz"
    if not path.exists():
        pytest.skip(f"{path} is absent; set DASHPOT_DATA to the folder of the real recordings")
    recording = read(path, **options)
    assert (recording.n, recording.unit) == (n, unit)
    assert recording.fs == pytest.approx(fs, rel=1e-6)


PRACTICE = sorted((SHARED.parent / "practice").glob("*/*.csv.gz"))


@pytest.mark.skipif(not PRACTICE, reason="the practice recordings are absent; set DASHPOT_DATA")
@pytest.mark.parametrize("path", PRACTICE, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_practice_recordings_raise_no_false_alarm(path):
    recording = read(path)
    assert (recording.force is not None, recording.notes) == (True, ())
