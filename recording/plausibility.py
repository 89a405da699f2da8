"""Whether a response is of a size that a vibrating thing can have, or its unit is wrong by orders of magnitude."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .units import STANDARD_GRAVITY, parse_unit

FASTEST = 20.0  # m/s: a resonating solid is strained by v/c (Hunt 1960); 20 m/s over 5000 m/s breaks most of them
FAST = 5.0  # m/s: beyond what shakers reach
HARDEST = 1000 * STANDARD_GRAVITY  # m/s2, for what moves by more than LARGE: shakers end near 100 g
LARGE = 0.01  # m
FAINT = 1e-9, 1e-6  # m and m/s2, both: a nanometre is seen by interferometers, 0.1 ug by seismometers
FAINTEST = 1e-12  # m
MOST_TURNED = math.pi  # rad: beyond half a turn it rotates and does not vibrate
MOST_STRAINED = 0.05  # elastic strain of metals ends near 0.005, of most plastics near 0.05
LEAST_STRAINED = 1e-10

ROTATIONS = ("rad", "rad/s", "rad/s2")
_SMALLER = {"m": ("mm", "um"), "m/s": ("mm/s", "um/s"), "m/s2": ("mm/s2",), "strain": ("microstrain",)}


@dataclass(frozen=True)
class Implausible:
    """Why a response cannot be (`impossible`) or hardly is of this size, and the unit that would make sense of it."""

    impossible: bool
    reason: str
    probable: str | None


def implausible(quantity: str, unit: str, amplitude: float, frequency: float) -> Implausible | None:
    """Judge an amplitude (SI, as `unit` says) at a frequency in Hz; None if it can be.

    Volts and other raw signals are not judged.
    """
    omega = 2 * math.pi * max(frequency, 1e-9)
    order = {"displacement": 0, "velocity": 1, "acceleration": 2}[quantity]
    moved, speed, acceleration = (amplitude * omega ** (k - order) for k in range(3))
    size = f"{amplitude:.3g} {unit} at {frequency:.3g} Hz"
    if unit in ROTATIONS and moved > MOST_TURNED:
        return Implausible(True, f"{size} is {moved / (2 * math.pi):.3g} turns", unit.replace("rad", "deg"))
    if unit == "strain" and amplitude > MOST_STRAINED:
        return Implausible(True, f"{size} would break the part", "microstrain")
    if unit == "strain" and amplitude < LEAST_STRAINED:
        return Implausible(True, f"{size} is less than any gauge resolves", None)
    if unit not in _SMALLER or unit == "strain":
        return None
    if moved < FAINTEST or (moved < FAINT[0] and acceleration < FAINT[1]):
        size += f" is a motion of {moved:.3g} m and {acceleration / STANDARD_GRAVITY:.3g} g"
        return Implausible(True, f"{size}, less than any sensor resolves", None)
    impossible = speed > FASTEST or (acceleration > HARDEST and moved > LARGE)
    if impossible or (speed > FAST and moved > LARGE):
        factors = [(name, parse_unit(name, "").factor) for name in _SMALLER[unit]]
        probable = next((name for name, factor in factors if speed * factor <= FAST), factors[-1][0])
        size += f" is a peak of {acceleration / STANDARD_GRAVITY:.3g} g and {speed:.3g} m/s"
        return Implausible(impossible, size, probable)
    return None
