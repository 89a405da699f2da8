"""Motions of a model in the unit that its recordings had: 1.2 mm, 0.5 g, where the model file has m and m/s2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import BadInput
from . import units
from .parameter import Parameter
from .quantity import converted

if TYPE_CHECKING:
    from .element import Element
    from .oscillator import Oscillator

#: Accelerations whose unit is no length over a time squared, in m/s2; `recording` has the same, and knows no models.
_OF_GRAVITY = {"g": 9.80665, "mg": 9.80665e-3}


def recorded_length(model: Oscillator | Element) -> str:
    """Unit of length, or of angle, that all recordings had; that of the model where they had several or none is known.

    ``mm`` where a velocity was recorded in mm/s.
    """
    own = model.response.displacement_unit
    known = {str(r.get("unit") or own) for r in model.identified.recordings}
    if len(known) != 1:
        return own
    unit, _, _ = known.pop().partition("/")
    return unit if _factor(own, unit) is not None else own


def recorded_response(model: Oscillator | Element) -> str:
    """Unit of the response as all recordings had it: ``mm/s``, ``g``; that of the model where no other one is known."""
    own = model.response.unit
    known = {str(r.get("unit") or own) for r in model.identified.recordings}
    if own == "m/s2" and len(known) == 1 and known <= _OF_GRAVITY.keys():
        return known.pop()
    return own.replace(model.response.displacement_unit, recorded_length(model), 1)


def as_recorded(model: Oscillator | Element, value: float, unit: str) -> tuple[float, str]:
    """A displacement, velocity or acceleration of the model in that unit of length; anything else as it is.

    An acceleration of a model whose accelerometers said g is in g.
    """
    if unit == "m/s2" and (recorded := recorded_response(model)) in _OF_GRAVITY:
        return value / _OF_GRAVITY[recorded], recorded
    length, own = recorded_length(model), model.response.displacement_unit
    for template in ("X", "X/s", "X/s2"):
        if length != own and units.same(unit, units.compose(template, own)):
            return value * (_factor(own, length) or 1.0), units.compose(template, length)
    return value, unit


def parameter_as_recorded(model: Oscillator | Element, parameter: Parameter) -> Parameter:
    """A parameter likewise, with its standard error."""
    value, unit = as_recorded(model, parameter.value, parameter.unit)
    std = None if parameter.std is None else as_recorded(model, parameter.std, parameter.unit)[0]
    return Parameter(value, std, unit)


def _factor(own: str, length: str) -> float | None:
    """How many of one unit the other is; None where it is none of the same kind."""
    if not length.isalpha() or not own.isalpha():
        return None
    try:
        return converted(1.0, own, length, "the recorded unit")
    except BadInput:  # counts, or another unit that is no length
        return None
