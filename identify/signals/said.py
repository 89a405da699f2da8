"""Values of a recording in words: in the unit that its file has, with a prefix where that is one of SI."""

from __future__ import annotations

import math

from ...model.display import scale_of
from ...model.parameter import Parameter
from ...model.show import value_and_error
from ...recording.as_recorded import of_force, of_response
from ...recording.recording import Recording
from .registry import shown

_SEEN = shown(5e-3, "of the value", why="a standard error below that changes none of three digits")


def said(recording: Recording, value: float, std: float | None = None, *, force: bool = False, per: str = "") -> str:
    """``0.365 mm``: a value of the response, or of the force, to three digits.

    Args:
        recording: whose unit it is in.
        value: in that unit, in SI.
        std: standard error, which is said where it would change these digits.
        force: whether it is a value of the force.
        per: behind the unit, such as ``/s``.
    """
    factor, unit = of_force(recording) if force else of_response(recording)
    if factor == 1.0 and not unit.startswith("rad"):
        scale = scale_of(unit, value)
        factor, unit = scale.factor, scale.unit
    if std is None or not math.isfinite(std) or std < _SEEN * abs(value):
        return f"{float(f'{value * factor:.3g}'):.12g} {unit}{per}"
    number, error = value_and_error(Parameter(value * factor, std * factor))
    return f"{number}{f' ± {error}' if error else ''} {unit}{per}"
