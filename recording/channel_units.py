"""Units of what a rig is recorded under: temperature, pressure, current, gap, load, speed, and what they are in SI."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass

from ..errors import BadInput
from .units import find_unit


@dataclass(frozen=True)
class ChannelUnit:
    """A unit: its SI spelling, and factor and offset that bring a value to it.

    A temperature stays in degrees Celsius, as a bench reads it; its zero is a convention.
    """

    text: str
    si: str
    factor: float
    offset: float = 0.0


CELSIUS = "degC"
_ATMOSPHERE = 101325.0  # Pa, 10th CGPM (1954)
_UNITS = {
    unit.text: unit
    for unit in (
        ChannelUnit("degC", CELSIUS, 1.0),
        ChannelUnit("K", CELSIUS, 1.0, -273.15),
        ChannelUnit("degF", CELSIUS, 5.0 / 9.0, -160.0 / 9.0),
        ChannelUnit("Pa", "Pa", 1.0),
        ChannelUnit("hPa", "Pa", 1e2),
        ChannelUnit("kPa", "Pa", 1e3),
        ChannelUnit("MPa", "Pa", 1e6),
        ChannelUnit("bar", "Pa", 1e5),
        ChannelUnit("mbar", "Pa", 1e2),
        ChannelUnit("psi", "Pa", 6894.757293168361),
        ChannelUnit("atm", "Pa", _ATMOSPHERE),
        ChannelUnit("rpm", "rad/s", math.pi / 30.0),
        ChannelUnit("Hz", "Hz", 1.0),
        ChannelUnit("kHz", "Hz", 1e3),
        ChannelUnit("T", "T", 1.0),
        ChannelUnit("mT", "T", 1e-3),
        ChannelUnit("W", "W", 1.0),
        ChannelUnit("kg", "kg", 1.0),
        ChannelUnit("g", "kg", 1e-3),
        ChannelUnit("%", "1", 1e-2),
        ChannelUnit("1", "1", 1.0),
    )
}
_WORDS = {"°C": "degC", "C": "degC", "celsius": "degC", "°F": "degF", "F": "degF", "1/min": "rpm", "percent": "%"}
#: What a channel of a telling name is measured in.
_OF_NAME = {
    "temperature": (CELSIUS,),
    "temp": (CELSIUS,),
    "pressure": ("Pa",),
    "current": ("A",),
    "voltage": ("V",),
    "gap": ("m",),
    "load": ("N", "N.m", "kg"),
    "speed": ("m/s", "rad/s", "Hz"),
}


def find_channel_unit(text: str) -> ChannelUnit | None:
    """The unit that a text spells, or None."""
    text = text.strip()
    known = _UNITS.get(_WORDS.get(text, text))
    if known is not None:
        return known
    other = find_unit(text)
    return None if other is None else ChannelUnit(other.text, other.si, other.factor)


def channel_unit(name: str, text: str, where: str) -> ChannelUnit:
    """The unit of a channel of a name; ``where`` begins the message.

    Raises:
        BadInput: nobody knows the unit, or what bears such a name is not measured in it.
    """
    expected = _OF_NAME.get(name.lower())
    if not text.strip() and expected is not None:
        raise BadInput(
            f"{where}: nobody says the unit of the channel {name}; write it behind the number, as in 20 {expected[0]}"
        )
    unit = find_channel_unit(text.strip() or "1")
    if unit is None:
        near = difflib.get_close_matches(text.strip(), [*_UNITS, *_WORDS, "A", "mA", "V", "N", "mm"], n=3, cutoff=0.5)
        advice = (
            f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(_UNITS)}, A, V, N, mm and more"
        )
        raise BadInput(f"{where}: the unit '{text.strip()}' of the channel {name} is not known; {advice}")
    if expected is not None and unit.si not in expected:
        raise BadInput(
            f"{where}: the channel {name} is in '{unit.text}', and a {name} is measured in {' or '.join(expected)}; "
            "state its unit, or give it another name"
        )
    return unit
