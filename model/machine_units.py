"""Parameters as the machine has them: a drag in N s²/m², where the model has it per unit mass in 1/m.

What multiplies a force inside the bracket of Eq. 17 is per unit mass; times the mass it is what a drawing states. Its
unit follows from the parameter's own and that of the mass alone, for Eq. 17 and for every further law alike.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from . import units
from .laws import BASE
from .oscillator import MASS_UNIT

if TYPE_CHECKING:
    from .oscillator import Oscillator

#: What the products of Eq. 17's own parameters with the mass are called; ``omega0`` is none.
NAMES = {"cubic": "cubic_stiffness", "preload": "preload_force", "viscous": "damping", "dry": "friction"}
_RATIO = "-ratio"


class Product(NamedTuple):
    """What a parameter times the mass is called, and its unit."""

    name: str
    unit: str


def in_force(template: str) -> str:
    """The unit template of a force's strength, from that per unit mass."""
    exponents = Counter(units.factors(MASS_UNIT))
    exponents.update(units.factors(template))
    return units.render({symbol: power for symbol, power in exponents.items() if power})


def products(oscillator: Oscillator) -> dict[str, Product]:
    """Each parameter that is per unit mass, by its name; none where the mass is not known.

    Those of further laws keep their names, but for a ratio of masses, whose product is a mass.
    """
    if oscillator.mass is None:
        return {}
    templates = {p.name: p.unit for law in BASE for p in law.parameters if p.name in NAMES}
    for term in oscillator.terms:
        if term.law.force is not None:
            templates |= {f"{term.effect}.{p.name}": p.unit for p in term.law.parameters if p.strength}
    unit = oscillator.response.displacement_unit
    return {
        name: Product(
            NAMES.get(name) or (name.removesuffix(_RATIO) if template == "1" else name),
            units.compose(in_force(template), unit, oscillator.force_unit),
        )
        for name, template in templates.items()
    }


def words_of_product(description: str) -> str:
    """What the product is, from what the parameter is in words."""
    for less in (", per unit mass", " per unit mass", " over the main mass"):
        description = description.replace(less, "")
    return description
