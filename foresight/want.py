"""What is wanted to be known, and how well: ``cubic 1%``, ``dry 0.001 m/s2``, ``friction 5%``."""

from __future__ import annotations

import difflib
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..identify.signals.registry import shown
from ..model import Oscillator
from ..model.parameter import Parameter
from ..model.physical import machine
from ..model.quantity import converted, said
from .information import with_covariance

_LONGEST = shown(60, "characters", why="of what is asked, in a message")


@dataclass(frozen=True)
class Want:
    """One quantity and the standard error that is wanted of it.

    Attributes:
        name: of a parameter, or of a quantity of the machine.
        error: standard error, in ``unit``.
        unit: of the quantity.
        text: as it was asked.
    """

    name: str
    error: float
    unit: str
    text: str


def wants_of(texts: Sequence[str], model: Oscillator) -> tuple[Want, ...]:
    """What texts want of a model; raises BadInput where one is no quantity of it with an error."""
    if not texts:
        raise BadInput("nothing is wanted; say what is to be known and how well, such as 'cubic 1%'")
    return tuple(_want(text, model) for text in texts)


def _want(text: str, model: Oscillator) -> Want:
    name, _, size = text.strip().partition(" ")
    known = quantities(model)
    text = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
    name = name[:_LONGEST]
    if name not in known and f"{name}.coefficient" in known:
        name = f"{name}.coefficient"
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1)
        meant = f"did you mean {near[0]}? There" if near else "there"
        raise BadInput(f"{text!r}: there is no quantity {name!r}; {meant} are {', '.join(known)}")
    value, unit = known[name].value, known[name].unit
    what = f"the error wanted of {name}"
    number, given = said(size, what) if size.strip() else (math.nan, "")
    if not number > 0 or not math.isfinite(number):
        raise BadInput(f"{text!r}: say how well it is to be known, such as '{name} 1%' or '{name} 0.1 {unit}'")
    if given == "%":
        if not value:
            raise BadInput(
                f"{text!r}: {name} is zero in the model, of which a share says nothing; give '{name} 0.1 {unit}'"
            )
        return Want(name, number / 100.0 * abs(value), unit, text)
    error = number if not given else converted(number, given, unit, what)
    if error is None:
        raise BadInput(f"{text!r}: {given} is no unit of {name}; give it in {unit} or in %")
    return Want(name, error, unit, text)


def quantities(model: Oscillator) -> dict[str, Parameter]:
    """The parameters and the quantities of the machine, by name."""
    return model.parameters() | {name: p for name, p in machine(model).items() if not name.endswith("_amid")}


def errors_of(wants: Sequence[Want], model: Oscillator, names: Sequence[str], covariance: np.ndarray) -> list[float]:
    """Standard errors of what is wanted, from the covariance (k, k) of parameters; inf where one is not found."""
    known = quantities(with_covariance(model, names, covariance))
    return [stated(known.get(want.name)) for want in wants]


def stated(parameter: Parameter | None) -> float:
    """Standard error of a quantity; inf where there is none."""
    std = None if parameter is None else parameter.std
    return float(std) if std is not None and std > 0 and math.isfinite(std) else math.inf
