"""Units as they stand in column headers, and what they are in SI."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass

from ..errors import BadInput

STANDARD_GRAVITY = 9.80665  # m/s2, 3rd CGPM (1901)


@dataclass(frozen=True)
class Unit:
    """A unit: its SI spelling, the factor that brings a value to it, and the quantity it measures.

    `quantity` is displacement, velocity, acceleration, force, time, or "any" for what a transducer gives out
    before calibration (V, A, counts of a converter or an encoder, pixels of a camera): such a column can stand for a
    force or for a response.
    """

    text: str
    si: str
    factor: float
    quantity: str


_DEGREE = math.pi / 180
_UNITS = {
    unit.text: unit
    for unit in (
        Unit("m", "m", 1.0, "displacement"),
        Unit("cm", "m", 1e-2, "displacement"),
        Unit("mm", "m", 1e-3, "displacement"),
        Unit("um", "m", 1e-6, "displacement"),
        Unit("nm", "m", 1e-9, "displacement"),
        Unit("in", "m", 0.0254, "displacement"),
        Unit("ft", "m", 0.3048, "displacement"),
        Unit("mil", "m", 2.54e-5, "displacement"),
        Unit("rad", "rad", 1.0, "displacement"),
        Unit("mrad", "rad", 1e-3, "displacement"),
        Unit("deg", "rad", _DEGREE, "displacement"),
        Unit("strain", "strain", 1.0, "displacement"),
        Unit("microstrain", "strain", 1e-6, "displacement"),
        Unit("m/s", "m/s", 1.0, "velocity"),
        Unit("mm/s", "m/s", 1e-3, "velocity"),
        Unit("um/s", "m/s", 1e-6, "velocity"),
        Unit("in/s", "m/s", 0.0254, "velocity"),
        Unit("rad/s", "rad/s", 1.0, "velocity"),
        Unit("deg/s", "rad/s", _DEGREE, "velocity"),
        Unit("m/s2", "m/s2", 1.0, "acceleration"),
        Unit("mm/s2", "m/s2", 1e-3, "acceleration"),
        Unit("g", "m/s2", STANDARD_GRAVITY, "acceleration"),
        Unit("mg", "m/s2", 1e-3 * STANDARD_GRAVITY, "acceleration"),
        Unit("rad/s2", "rad/s2", 1.0, "acceleration"),
        Unit("deg/s2", "rad/s2", _DEGREE, "acceleration"),
        Unit("N", "N", 1.0, "force"),
        Unit("kN", "N", 1e3, "force"),
        Unit("mN", "N", 1e-3, "force"),
        Unit("lbf", "N", 4.4482216152605, "force"),
        Unit("kgf", "N", STANDARD_GRAVITY, "force"),
        Unit("N.m", "N.m", 1.0, "force"),
        Unit("V", "V", 1.0, "any"),
        Unit("mV", "V", 1e-3, "any"),
        Unit("A", "A", 1.0, "any"),
        Unit("mA", "A", 1e-3, "any"),
        Unit("counts", "counts", 1.0, "any"),
        Unit("px", "px", 1.0, "any"),
        Unit("s", "s", 1.0, "time"),
        Unit("ms", "s", 1e-3, "time"),
        Unit("us", "s", 1e-6, "time"),
    )
}
_WORDS = {
    "micron": "um", "microns": "um", "inch": "in", "inches": "in", "meter": "m", "metre": "m", "meters": "m",
    "metres": "m", "millimeter": "mm", "millimetre": "mm", "degree": "deg", "degrees": "deg", "°": "deg",
    "radian": "rad", "radians": "rad", "ue": "microstrain", "ustrain": "microstrain", "um/m": "microstrain",
    "newton": "N", "newtons": "N", "KN": "kN", "Nm": "N.m", "N*m": "N.m", "N m": "N.m", "volt": "V", "volts": "V",
    "count": "counts", "cts": "counts", "pixel": "px", "pixels": "px",
    "sec": "s", "second": "s", "seconds": "s", "msec": "ms", "usec": "us", "G": "g", "g0": "g", "gn": "g",
    "mps": "m/s", "mps2": "m/s2", "mmps": "mm/s", "mmps2": "mm/s2", "ips": "in/s", "rps": "rad/s",
}  # fmt: skip


_PLAIN = str.maketrans({"µ": "u", "μ": "u", "²": "2", "·": ".", "ε": "e"})


def find_unit(text: str) -> Unit | None:
    """Return the unit that `text` spells, or None. Accepts m_s2, m/s^2, m s-2, m/s², mps2, µm, με and the like."""
    text = re.sub(r"\s+", " ", text.strip()).translate(
        str.maketrans({"µ": "u", "μ": "u", "²": "2", "·": ".", "ε": "e"})
    )
    for spelling in (text, _slashed(text)):
        for known in (spelling, spelling.lower()):
            # lower case only where it cannot turn one unit into another: mN is not MN, mV not MV
            if known != spelling and spelling not in _CASELESS:
                continue
            unit = _UNITS.get(_WORDS.get(known, known))
            if unit:
                return unit
    return None


def parse_unit(text: str, where: str) -> Unit:
    """Return the unit that `text` spells; `where` begins the message.

    Raises BadInput with the nearest known units when there is none.
    """
    unit = find_unit(text)
    if unit:
        return unit
    near = difflib.get_close_matches(_slashed(text.strip()), [*_UNITS, *_WORDS], n=3, cutoff=0.5)
    advice = f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(_UNITS)}"
    raise BadInput(f"{where}: unit '{text}' is not known; {advice}")


def _slashed(text: str) -> str:
    """Bring m_s2, m s^-2, m.s-2, m/s/s, m/s**2 to the spelling m/s2."""
    text = text.replace("**", "").replace("^", "")
    text = re.sub(r"/s/s$|/\(s2\)$|/sec2$", "/s2", text)
    text = re.sub(r"/sec$", "/s", text)
    text = re.sub(r"[ ._*]s-([12])$", lambda m: "/s" + ("2" if m[1] == "2" else ""), text)
    return re.sub(r"^(\w+?)[ _]s(2?)$", r"\1/s\2", text)


# words and unmistakable units, whose capitals carry no meaning
_CASELESS = {
    spelling
    for word in [*(w for w in _WORDS if len(w) > 2 and w != "N*m"), "mm", "deg", "rad", "strain", "microstrain", "mm/s"]
    for spelling in (word.upper(), word.capitalize())
}
