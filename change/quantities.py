"""What a parameter that moved is to the machine: a friction in N, a natural frequency in Hz."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..model.identified import Identified
from ..model.machine_units import products
from ..model.oscillator import Oscillator


@dataclass(frozen=True)
class Quantity:
    """A parameter as the machine has it.

    Attributes:
        name: of the quantity, in words.
        unit: of it.
        factors: by how much it is more than the parameter, in each state.
    """

    name: str
    unit: str
    factors: tuple[float, ...]


@dataclass(frozen=True)
class Change:
    """What became of a quantity: its value in one state and in another."""

    name: str
    unit: str
    before: float
    after: float

    @staticmethod
    def of(quantity: Quantity, first: int, second: int, before: float, after: float) -> Change:
        """From the parameter's values in two states."""
        one, other = (quantity.factors[state] for state in (first, second))
        return Change(quantity.name, quantity.unit, one * before, other * after)

    @property
    def words(self) -> str:
        """``friction from 0.15 to 0.22 N``."""
        return f"{self.name} from {self.before:.5g} to {self.after:.5g} {self.unit}"

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {"quantity": self.name, "unit": self.unit, "from": self.before, "to": self.after}


def quantities(models: Sequence[Identified], masses: Sequence[float] | None = None) -> dict[str, Quantity]:
    """Quantities of the machine by the parameter that each follows from, where it is not that itself.

    The parameters of a force law by itself are.

    Args:
        models: one for each state, in the same units.
        masses: of each state, where these are known better than by its own model.
    """
    rigs = [model for model in models if isinstance(model, Oscillator)]
    if len(rigs) < len(models):
        return {}
    found = {"omega0": Quantity("natural frequency", "Hz", (1.0 / (2.0 * math.pi),) * len(models))}
    if any(model.mass is None for model in rigs):
        return found
    own = tuple(model.mass.value for model in rigs if model.mass is not None)
    for model in rigs:
        for name, product in products(model).items():
            words = product.name.replace("_", " ")
            found.setdefault(name, Quantity(words, product.unit, own if masses is None else tuple(masses)))
    return found
