"""What programs of phones and printers leave out of their files is known by the header, said, and may be overruled."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read, read_records
from dashpot.recording.formats.loggers import header_of, is_remark

FS, N = 400.0, 1600
T = np.arange(N) / FS
A = 6.0 * np.exp(-1.5 * T) * np.cos(2 * np.pi * 9.3 * T)


def text(header, *columns):
    return (
        f"{header}\n" + "\n".join(",".join(f"{v!r}" for v in row) for row in np.column_stack(columns).tolist()) + "\n"
    )


@pytest.mark.parametrize("first", ["#time,accel_x,accel_y,accel_z", "##{'errors': 0}\n#time,accel_x,accel_y,accel_z"])
def test_klipper_writes_millimetres(tmp_path, first):
    path = tmp_path / "raw_data_x_20261130.csv"
    path.write_text(text(first, T + 4321.5, 1e3 * A, 0 * A, 0 * A + 9806.65))
    recording = read(path, response="accel_x")
    np.testing.assert_allclose(recording.response, A, rtol=0, atol=1e-12)
    assert (recording.quantity, recording.unit, recording.fs) == ("acceleration", "m/s2", pytest.approx(FS, rel=1e-6))
    assert any("the header that Klipper writes" in note and "mm/s2" in note for note in recording.notes)
    stated = read(path, response="accel_x", unit="m/s2", checked=False)
    np.testing.assert_allclose(stated.response, 1e3 * A, rtol=1e-12)


def test_the_same_names_without_the_sign_are_of_anybody(tmp_path):
    path = tmp_path / "rec.csv"
    path.write_text(text("time,accel_x,accel_y,accel_z", T, A, 0 * A, 0 * A))
    recording = read(path, response="accel_x")
    np.testing.assert_allclose(recording.response, A, rtol=0, atol=1e-12)
    assert not any("Klipper" in note for note in recording.notes)


def sensor_logger(sign=1.0):
    ticks = 1_718_030_736_872_695_300 + np.round(T * 1e9).astype(np.int64)
    rows = (
        f"{n},{t!r},0.25,-0.5,{a!r}" for n, t, a in zip(ticks.tolist(), T.tolist(), (sign * A).tolist(), strict=True)
    )
    return "time,seconds_elapsed,z,y,x\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    ("name", "quantity", "unit"),
    [
        ("Accelerometer.csv", "acceleration", "m/s2"),
        ("swing-TotalAcceleration-2.csv", "acceleration", "m/s2"),
        ("Gyroscope.csv", "velocity", "rad/s"),
    ],
)
def test_a_file_of_sensor_logger_is_what_its_name_says(tmp_path, name, quantity, unit):
    (tmp_path / name).write_text(sensor_logger())
    recording = read(tmp_path / name, response="x")
    np.testing.assert_allclose(recording.response, A, rtol=0, atol=1e-12)
    assert (recording.quantity, recording.unit, recording.fs) == (quantity, unit, pytest.approx(FS, rel=1e-9))


def test_an_uncalibrated_one_asks_for_its_unit(tmp_path):
    path = tmp_path / "AccelerometerUncalibrated.csv"
    path.write_text(sensor_logger())
    recording = read(path, response="acceleration x", unit="g")
    np.testing.assert_allclose(recording.response, 9.80665 * A, rtol=1e-12)
    assert any("in g on iPhones and in m/s2 on Androids" in note for note in read(path, response="*n x").notes)


def test_one_of_no_sensor_is_refused(tmp_path):
    (tmp_path / "swing.csv").write_text(sensor_logger())
    with pytest.raises(BadInput, match=r"x, y, z may be of any sensor; give the file the name that it had"):
        read(tmp_path / "swing.csv", response="x")


def test_an_archive_of_a_phone_holds_a_record_a_sensor(tmp_path):
    path = tmp_path / "swing.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("Accelerometer.csv", sensor_logger())
        archive.writestr("Gyroscope.csv", sensor_logger(-1.0))
        archive.writestr("Metadata.csv", "version,device name,recording epoch time\n3,phone,1718030736872\n")
        archive.writestr("Annotation.csv", "time,seconds_elapsed,text\n")
        archive.writestr("notes.txt", "the second one was longer")
    first, second = read_records(path, response="x")
    assert (first.name, second.name) == ("swing.zip#Accelerometer", "swing.zip#Gyroscope")
    np.testing.assert_allclose(read(f"{path}#Gyroscope", response="x").response, -A, rtol=0, atol=1e-12)
    with pytest.raises(BadInput, match=r"name one: swing\.zip#Accelerometer"):
        read(path, response="x")


def test_an_archive_without_a_table_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "rec.zip", "w") as archive:
        archive.writestr("rec.h5", b"")
    with pytest.raises(BadInput, match=r"holds no text file with a table .*; unpack it"):
        read(tmp_path / "rec.zip")


@pytest.mark.parametrize(
    ("header", "column", "factor"),
    [
        ("time,gFx,gFy,gFz,TgF", "gFx", 9.80665),
        ("time,ax,ay,az,aT", "ax", 1.0),
        ("time,wx,wy,wz", "wx", 1.0),
    ],
)
def test_physics_toolbox_abbreviates(tmp_path, header, column, factor):
    path = tmp_path / "rec.csv"
    others = [0 * A] * (header.count(",") - 1)
    path.write_text(text(header, T, A, *others))
    recording = read(path, response=column)
    np.testing.assert_allclose(recording.response, factor * A, rtol=1e-12, atol=1e-12)
    assert recording.quantity == ("velocity" if column == "wx" else "acceleration")


def test_times_of_day_with_a_colon_before_milliseconds(tmp_path):
    clock = [f"18:25:{58 + int(t)}:{round(1e3 * t) % 1000:03d}" for t in T[:600]]
    rows = "\n".join(f"{stamp},{a!r}" for stamp, a in zip(clock, A.tolist(), strict=False))
    (tmp_path / "rec.csv").write_text(f"time,a_m_s2\n{rows}\n")
    recording = read(tmp_path / "rec.csv")
    assert recording.fs == pytest.approx(FS, rel=1e-3)


def test_phyphox_says_all_in_its_header(tmp_path):
    names = ("Linear Acceleration x (m/s^2)", "Linear Acceleration y (m/s^2)", "Absolute acceleration (m/s^2)")
    header = "\t".join(f'"{name}"' for name in ("Time (s)", *names))
    rows = "\n".join(f"{t:.9E}\t{a:.9E}\t0.000000000E0\t{abs(a):.9E}" for t, a in zip(T, A, strict=True))
    (tmp_path / "Raw Data.csv").write_text(f"{header}\n{rows}\n")
    recording = read(tmp_path / "Raw Data.csv", response="*acceleration x*")
    np.testing.assert_allclose(recording.response, A, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("names", "units"),
    [(("time", "ax", "ay", "az"), ("",) * 4), (("time", "gFx", "gFy", "gFz"), ("s", "g", "g", "g"))],
)
def test_headers_that_state_units_or_are_of_others_stay(names, units):
    header = header_of("rec.csv", names, units, commented=False)
    assert (header.names, header.units, header.notes) == (names, units, ())


@pytest.mark.parametrize(
    ("name", "remark"),
    [
        ("meta/time.csv", True),
        ("Metadata Device", True),
        ("Annotation.csv", True),
        ("metal.csv", False),
        ("Raw", False),
    ],
)
def test_what_is_about_the_phone(name, remark):
    assert is_remark(name) == remark
