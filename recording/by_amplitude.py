"""Parts of a recording by the amplitude of its motion: the loud beginning of a decay, its quiet end, what is between.

The amplitude at an instant is half of what the response ranges over within a cycle around it, which a zero of the
sensor or a load does not move.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of, shown
from .oscillation import SMALLEST, oscillation_of
from .pace import cycle_of
from .recording import Recording
from .units import Unit, find_unit, parse_unit

#: Cycles of the shortest part that is taken.
_FEWEST = 3
#: What moves less than so many times the noise rests.
_ABOVE_NOISE = 4.0
_SIDE = re.compile(r"\s*(\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)?\s*(.*?)\s*")
_HOW = "write such as 5mm (up to that), 1mm..5mm, or 1mm.. (from that on)"


@dataclass(frozen=True)
class Amplitudes:
    """From the least to the most, in `unit`; None stands for that of the response in SI."""

    least: float
    most: float
    unit: Unit | None = None

    def __str__(self) -> str:
        unit = "" if self.unit is None else f" {self.unit.text}"
        if math.isinf(self.most):
            return f"at least {self.least:g}{unit}"
        return f"at most {self.most:g}{unit}" if self.least == 0 else f"{self.least:g} to {self.most:g}{unit}"


def amplitudes_of(given: Any) -> Amplitudes | None:
    """Amplitudes as a text, ``5mm``, ``1mm..5mm``, ``1mm..``, empty for all; a number, or two, in SI.

    Raises:
        BadInput: it is none of these, or holds no amplitude.
    """
    if given is None or isinstance(given, Amplitudes):
        return given
    if isinstance(given, str):
        return _parsed(given) if given.strip() else None
    if isinstance(given, list | tuple) and len(given) == 2:
        least, most = (number_of(side, "a side of amplitude") for side in given)
        return _in_order(given, least, most, None)
    return _in_order(given, 0.0, number_of(given, "amplitude"), None)


def _parsed(text: str) -> Amplitudes:
    low, dots, high = text.partition("..")
    if not dots:
        low, high = "", low
    sides = [_SIDE.fullmatch(side) for side in (low, high)]
    if not (low.strip() or high.strip()) or any(s is None or (s[2] and not s[1]) for s in sides):
        raise BadInput(f"amplitude {shown(text)} is not understood; {_HOW}")
    units = [parse_unit(side[2], f"amplitude {shown(text)}") if side and side[2] else None for side in sides]
    unit = units[1] or units[0]
    numbers = [float(side[1]) if side and side[1] else None for side in sides]
    if unit is not None and units[0] is not None and numbers[0] is not None:
        if units[0].si != unit.si:
            raise BadInput(f"amplitude {shown(text)} is from {units[0].text} to {unit.text}; {_HOW}")
        numbers[0] *= units[0].factor / unit.factor
    return _in_order(text, numbers[0] or 0.0, math.inf if numbers[1] is None else numbers[1], unit)


def _in_order(given: Any, least: float, most: float, unit: Unit | None) -> Amplitudes:
    if not 0 <= least < most:
        raise BadInput(f"amplitude {shown(given)} holds none; {_HOW}, the smaller one first")
    return Amplitudes(least, most, unit)


def of_amplitude(recording: Recording, wanted: Amplitudes | None) -> list[Recording]:
    """The parts of a recording whose motion has the amplitudes that are wanted, in order; all of it where None is.

    A part has three cycles at least. What rests before or between motions is none.

    Raises:
        BadInput: no part has, or the unit is not of the response.
    """
    if wanted is None:
        return [recording]
    factor = _factor(recording, wanted)
    cycle = max(2, round(recording.fs * cycle_of(recording)))
    size = _sizes(np.asarray(recording.response, float), cycle)
    inside = (size >= wanted.least * factor) & (size <= wanted.most * factor)
    rests = max(_ABOVE_NOISE * oscillation_of(recording).noise, SMALLEST * float(size.max()))
    runs = [(a, b) for a, b in _runs(inside, cycle) if np.count_nonzero(size[a:b] > rests) >= _FEWEST * cycle]
    if not runs:
        there = size[size > rests]
        low, high = (f"{value / factor:.4g}" for value in (there.min(), there.max()))
        unit = recording.unit if wanted.unit is None else wanted.unit.text
        raise BadInput(
            f"{recording.name}: moves with amplitudes from {low} to {high} {unit}, and nowhere for {_FEWEST} cycles "
            f"with {wanted}; choose others with --amplitude"
        )
    if runs == [(0, recording.n)]:
        return [recording]
    return [_cut(recording, run, wanted, several=len(runs) > 1) for run in runs]


def _factor(recording: Recording, wanted: Amplitudes) -> float:
    if wanted.unit is None:
        return 1.0
    if wanted.unit.si != recording.unit:
        units = "its unit" if find_unit(recording.unit) is None else f"{recording.unit}, or a unit of the same kind"
        raise BadInput(
            f"{recording.name}: --amplitude is in {wanted.unit.text}, and the response is a {recording.quantity} in "
            f"{recording.unit}; give it in {units}"
        )
    return wanted.unit.factor


def _sizes(response: np.ndarray, cycle: int) -> np.ndarray:
    """Half the range of the response (n,) within a cycle around each sample."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    span = cycle + 1
    return 0.5 * (maximum_filter1d(response, span, mode="nearest") - minimum_filter1d(response, span, mode="nearest"))


def _runs(inside: np.ndarray, cycle: int) -> list[tuple[int, int]]:
    """Start and stop of what is inside; what is outside for less than a cycle divides nothing."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])))
    runs: list[tuple[int, int]] = []
    for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if runs and a - runs[-1][1] < cycle:
            runs[-1] = (runs[-1][0], b)
        else:
            runs.append((a, b))
    return runs


def _cut(recording: Recording, run: tuple[int, int], wanted: Amplitudes, *, several: bool) -> Recording:
    begin, end = (place / recording.fs for place in run)
    span = f"{begin:.6g} to {end:.6g} s"
    note = f"{recording.name}: {span} are used, where the amplitude is {wanted}; the rest is left out"
    part = recording.slice(*run)
    apart = " " if "#" in recording.name else "#"  # what stands before it is the file
    return replace(part, name=f"{recording.name}{apart}{span}" if several else part.name, notes=(*part.notes, note))
