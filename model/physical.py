"""The machine in its own units: masses in kg, springs in N/m, friction in N, from the quantities per unit mass.

What is identified is per unit mass (Eq. 17, inside the bracket); what a drawing or a data sheet states is not. These
follow from the parameters and are none themselves, so that nothing is said twice.
"""

from __future__ import annotations

import math

from .equations import PAYLOAD, Equations
from .law import Expression

#: Name, unit template (``X`` displacement, ``Q`` force) and words.
QUANTITIES = (
    ("total_mass", "Q.s2/X", "moving mass with its payload"),
    ("stiffness", "Q/X", "stiffness of the linear spring: mass omega0²"),
    ("cubic_stiffness", "Q/X3", "stiffness of the cubic spring: mass cubic"),
    ("preload_force", "Q", "force that leaves the seat of a preloaded spring: mass preload"),
    ("damping", "Q.s/X", "viscous damping: mass viscous"),
    ("friction", "Q", "dry friction: mass dry"),
    ("natural_frequency", "Hz", "undamped natural frequency of the linear part with the payload"),
)


def physical(eq: Equations) -> Expression:
    """The quantities (n,) as an expression of ``eq.p``; none, (0,), where the equations take no payload."""
    import casadi as ca

    if not eq.payload:
        return ca.SX(0, 1)
    p = {name: eq.p[i] for i, name in enumerate(eq.parameter_names)}
    mass, total = p["mass"], p["mass"] + p[PAYLOAD]
    per_mass = [p["omega0"] ** 2, p["cubic"], p["preload"], p["viscous"], p["dry"]]
    frequency = p["omega0"] * ca.sqrt(mass / total) / (2 * math.pi)
    return ca.vertcat(total, *[mass * quantity for quantity in per_mass], frequency)
