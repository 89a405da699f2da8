"""Values that a person knows, in the person's own units, as the parameters of Eq. 17 and of laws: per unit mass.

A friction in N is the mass times ``dry``, a stiffness in N/m the mass times ``omega0`` squared: it fixes a parameter
where the mass is known beside it.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping, Sequence

from ..errors import BadInput
from . import units
from .law import Law
from .laws import BASE
from .limits import checked_value
from .oscillator import Response
from .physical import QUANTITIES
from .quantity import converted, said

#: Quantities of the machine: the parameter that each follows from, and that parameter from quantity and mass.
_OF_MACHINE: dict[str, tuple[str, Callable[[float, float], float]]] = {
    "total_mass": ("mass", lambda value, _mass: value),
    "stiffness": ("omega0", lambda value, mass: math.sqrt(max(value, 0.0) / mass)),
    "cubic_stiffness": ("cubic", lambda value, mass: value / mass),
    "preload_force": ("preload", lambda value, mass: value / mass),
    "damping": ("viscous", lambda value, mass: value / mass),
    "friction": ("dry", lambda value, mass: value / mass),
    "natural_frequency": ("omega0", lambda value, _mass: 2.0 * math.pi * value),
}
_UNITS = {name: template for name, template, _ in QUANTITIES}
#: Those that are no product with the mass.
_BY_THEMSELVES = ("total_mass", "natural_frequency")
_MASS = "Q.s2/X"


def known_values(
    given: Mapping[str, float | str], laws: Sequence[Law], response: Response, force: str = "N"
) -> dict[str, float]:
    """The parameters that are meant, in their units.

    Args:
        given: by the name of a parameter (``dry``, ``quadratic-drag.coefficient``) or of a quantity of the machine
            (``friction``, ``stiffness``, ``natural_frequency``): a number in SI, or a text with a unit, ``0.15 N``.
        laws: beside Eq. 17.
        response: what is recorded, in its unit.
        force: unit of the recorded force.

    Raises:
        BadInput: a text is no number with a unit, the unit measures something else, a quantity needs a mass that is not
            given, or two of them say the same parameter.
    """
    templates = {"mass": _MASS} | {p.name: p.unit for law in BASE for p in law.parameters}
    templates |= {f"{law.name}.{p.name}": p.unit for law in laws for p in law.parameters}
    strengths = {f"{law.name}.{p.name}" for law in laws for p in law.parameters if p.strength and law.force}
    made: dict[str, float] = {}

    def take(name: str, value: float, as_given: str) -> None:
        if made.get(name, value) != value:
            raise BadInput(
                f"{as_given} says that {name} is {value:g}, and it is fixed at {made[name]:g}; give it one value"
            )
        made[name] = value

    def unit_of(template: str) -> str:
        return (
            template if template == "Hz" else units.compose(template, response.displacement_unit, force, response.unit)
        )

    order = sorted(given, key=lambda name: name not in ("mass", "total_mass"))  # the others may need it
    for name in order:
        value, what = given[name], f"the fixed {name}"
        template = _UNITS.get(name, templates.get(name))
        number, unit = said(value, what) if isinstance(value, str) else (checked_value(name, value), "")
        if template is None:
            if unit:
                near = difflib.get_close_matches(name, [*templates, *_UNITS], n=1)
                meant = f"did you mean {near[0]}? There" if near else "there"
                raise BadInput(f"there is no parameter {name!r}; {meant} are {', '.join([*templates, *_UNITS])}")
            take(name, number, what)  # the fit says what there is
            continue
        if unit:
            found = converted(number, unit, unit_of(template), what)
            if found is None and (name in strengths or name in ("cubic", "preload", "viscous", "dry")):
                found = converted(number, unit, _times_mass(unit_of(template), unit_of(_MASS)), what)
                found = None if found is None else found / _mass(made, name, value)
            if found is None:
                raise BadInput(f"{what} is {value!r}, and {unit} is no unit of it; give it in {unit_of(template)}")
            number = found
        if name in _OF_MACHINE:
            parameter, of = _OF_MACHINE[name]
            take(parameter, of(number, 1.0 if name in _BY_THEMSELVES else _mass(made, name, value)), what)
        else:
            take(name, number, what)
    for name, number in made.items():
        checked_value(name, number)
    return made


def _times_mass(unit: str, mass: str) -> str:
    total = dict(units.factors(unit))
    for symbol, power in units.factors(mass).items():
        total[symbol] = total.get(symbol, 0) + power
    return units.render({symbol: power for symbol, power in total.items() if power})


def _mass(made: Mapping[str, float], name: str, value: float | str) -> float:
    if "mass" not in made:
        template = f"{_OF_MACHINE[name][0]}, which is per unit mass" if name in _OF_MACHINE else "it per unit mass"
        raise BadInput(
            f"{name} = {value} is a product with the mass, which is not given; give the mass too, or fix {template}"
        )
    return made["mass"]
