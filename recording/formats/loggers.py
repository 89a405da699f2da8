"""What programs that log leave out of their files: units, which sensor, which of two clocks; known by their headers.

Sources: Klipper, klippy/extras/adxl345.py, whose raw samples are in mm/s²; Sensor Logger, "One-Page Unit Reference";
Physics Toolbox Sensor Suite, whose headers are abbreviations (gF: force over weight, a: linear acceleration, w: angular
velocity).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from ...errors import BadInput

#: Sheets and entries in which programs of phones write about the phone and the test.
_REMARKS = re.compile(r"(?:meta|metadata|annotations?)(?:[ _-].*)?(?:\.\w+)?")
_KLIPPER = ("time", "accel_x", "accel_y", "accel_z")
_TOOLBOX = {"gF": "g", "TgF": "g", "a": "m/s2", "aT": "m/s2", "w": "rad/s"}
#: Headers of which Physics Toolbox has one at least; others may call something ax as well.
_TOOLBOX_HEADERS = ({"gFx", "gFy", "gFz"}, {"ax", "ay", "az", "aT"})
_TOOLBOX_GYROSCOPE = ("time", "wx", "wy", "wz")
_SINCE_1970, _SINCE_START = "time", "seconds_elapsed"
#: Files of Sensor Logger by what their names begin with, longest first, with the unit of x, y and z.
_SENSORS = {
    "accelerometeruncalibrated": "",
    "totalacceleration": "m/s2",
    "accelerometer": "m/s2",
    "gravity": "m/s2",
    "gyroscope": "rad/s",
}
_ANGLES = ("roll", "pitch", "yaw")
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Header:
    """The columns of a file as they are to be read.

    Attributes:
        taken: indices of the columns that are left.
        names, units: of those.
        notes: what was known of the program.
    """

    taken: tuple[int, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    notes: tuple[str, ...] = ()


def is_remark(name: str) -> bool:
    """Whether a sheet, or an entry of an archive, is about the phone or the test and no recording."""
    return any(_REMARKS.fullmatch(part.lower()) for part in PurePosixPath(name).parts)


def header_of(where: str, names: Sequence[str], units: Sequence[str], *, commented: bool) -> Header:
    """The columns with what the program that wrote them leaves out; as they are where none of these did.

    Args:
        where: name of the file or record.
        names, units: of its columns.
        commented: whether the names stand behind a #.

    Raises:
        BadInput: Sensor Logger wrote it, and its name does not say of which sensor it is.
    """
    as_it_is = Header(tuple(range(len(names))), tuple(names), tuple(units))
    if any(units):
        return as_it_is
    if tuple(names) == _KLIPPER and commented:
        return _with_units(as_it_is, dict.fromkeys(_KLIPPER[1:], "mm/s2"), where, "Klipper")
    if {_SINCE_1970, _SINCE_START} <= set(names):
        return _of_sensor_logger(where, as_it_is)
    if any(header <= set(names) for header in _TOOLBOX_HEADERS) or tuple(names) == _TOOLBOX_GYROSCOPE:
        known = {name: unit for name in names if (unit := _TOOLBOX.get(name.rstrip("xyz")) or _TOOLBOX.get(name))}
        return _with_units(as_it_is, known, where, "Physics Toolbox")
    return as_it_is


def _with_units(header: Header, known: dict[str, str], where: str, program: str) -> Header:
    units = tuple(known.get(name, "") for name in header.names)
    by_unit = {
        unit: [name for name in header.names if known.get(name) == unit] for unit in dict.fromkeys(known.values())
    }
    said = "; ".join(f"{', '.join(names)} in {unit}" for unit, names in by_unit.items())
    note = f"{where}: has the header that {program} writes, without units: {said}; --unit states another"
    return Header(header.taken, header.names, units, (*header.notes, note))


def _of_sensor_logger(where: str, header: Header) -> Header:
    """With the seconds since the beginning for its time: those since 1970 are in ns, beyond what a double resolves."""
    taken = tuple(i for i in header.taken if header.names[i] != _SINCE_1970)
    names = tuple(header.names[i] for i in taken)
    note = (
        f"{where}: has the header that Sensor Logger writes: '{_SINCE_START}' is the time, '{_SINCE_1970}' is left out"
    )
    plain = Header(taken, names, ("",) * len(names), (note,))
    if not set(_AXES) <= set(names):
        return (
            _with_units(plain, dict.fromkeys(_ANGLES, "rad"), where, "Sensor Logger") if _ANGLES[0] in names else plain
        )
    called = re.sub(r"[^a-z]", "", where.lower())
    sensor = next((sensor for sensor in _SENSORS if sensor in called), None)
    if sensor is None:
        raise BadInput(
            f"{where}: Sensor Logger wrote it, and x, y, z may be of any sensor; give the file the name that it had, "
            "such as Accelerometer.csv or Gyroscope.csv"
        )
    if unit := _SENSORS[sensor]:
        return _with_units(plain, dict.fromkeys(_AXES, unit), where, "Sensor Logger")
    renamed = tuple(f"acceleration {name}" if name in _AXES else name for name in names)
    unsure = f"{where}: uncalibrated accelerations are in g on iPhones and in m/s2 on Androids; --unit says which"
    return Header(taken, renamed, plain.units, (note, unsure))
