"""A model with a law more or less, or with other values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .library import find
from .oscillator import Oscillator
from .parameter import Parameter


def with_term(model: Oscillator, effect: str, values: Mapping[str, float]) -> Oscillator:
    """The model with one further effect, its parameters given by name."""
    laws = (*(term.law for term in model.terms), find(effect))
    numbers = model.values() | {f"{effect}.{name}": value for name, value in values.items()}
    grown = Oscillator.from_values(
        numbers, name=model.name, response=model.response, force_unit=model.force_unit, laws=laws
    )
    return replace(grown, amplitude=model.amplitude, frequency=model.frequency)


def without_term(model: Oscillator, effect: str) -> Oscillator:
    """The model without one of its effects."""
    return replace(model, terms=tuple(term for term in model.terms if term.effect != effect))


def generalised(model: Oscillator, effect: str) -> Oscillator:
    """The model with one effect as its more general twin, whose further parameters are zero."""
    law = find(effect)
    assert law.twin is not None
    values = model.values()
    own = [values[f"{effect}.{p.name}"] for p in law.parameters]
    names = [p.name for p in find(law.twin).parameters]
    return with_term(
        without_term(model, effect), law.twin, dict.fromkeys(names, 0.0) | dict(zip(names, own, strict=False))
    )


def with_values(model: Oscillator, values: np.ndarray) -> Oscillator:
    """The model with other values, in the order of ``parameters()``, and no errors."""
    old = model.parameters()
    return model.with_parameters(
        {name: Parameter(float(value), None, old[name].unit) for name, value in zip(old, values, strict=True)}
    )


def without_hold(model: Oscillator) -> Oscillator:
    """The model without what can hold the mass: dry friction and preload at zero."""
    known = model.parameters()
    return model.with_parameters({name: replace(known[name], value=0.0) for name in ("dry", "preload")})


def linear(model: Oscillator) -> Oscillator:
    """The model as a linear rig that comes to rest, with its own frequency: what simulates along any motion."""
    known = without_hold(model).parameters()
    damping = abs(known["viscous"].value) or 0.01 * known["omega0"].value
    return model.with_parameters(
        known | {"cubic": replace(known["cubic"], value=0.0), "viscous": replace(known["viscous"], value=damping)}
    )
