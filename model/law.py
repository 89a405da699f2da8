"""What a force law is: one expression, its parameters, and the words an engineer needs to recognise it.

A law is written once, as a CasADi expression of the motion and of its own parameters. Simulation, FMU, CasADi
function and printed equation are all made from that one expression.

Signs and kinks are not written with ``sign()``: a law asks the motion for ``motion.sign(surface)``. The rendering
then decides what the sign is: an integer mode that changes at located events (exact), ``casadi.sign``
(a plain right-hand side), or ``tanh`` of a stated width (smooth).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Expression = Any  # casadi.SX; casadi is imported only where expressions are made


@dataclass(frozen=True)
class LawParameter:
    """A parameter of a law. ``unit`` is a template: ``X`` stands for the unit of the displacement."""

    name: str
    unit: str
    description: str
    lower: float = -math.inf
    upper: float = math.inf


@dataclass
class Motion:
    """The symbols a law may use, and the switching surfaces that the laws have asked for.

    Attributes:
        x, v: displacement and velocity.
        t: time in s.
        surfaces: expressions whose sign changes the law; filled by ``sign``.
        signs: one symbol per surface.
    """

    x: Expression
    v: Expression
    t: Expression
    surfaces: list[Expression] = field(default_factory=list)
    signs: list[Expression] = field(default_factory=list)

    def sign(self, surface: Expression) -> Expression:
        """Sign of ``surface``: -1 or 1, and between them while the motion rests on the surface.

        Two laws that ask for the same surface share one sign, so that a stop of the motion is one event.
        """
        import casadi

        for known, symbol in zip(self.surfaces, self.signs, strict=True):
            if casadi.is_equal(known, surface, 10):
                return symbol
        symbol = casadi.SX.sym(f"s{len(self.signs)}")
        self.surfaces.append(surface)
        self.signs.append(symbol)
        return symbol


@dataclass(frozen=True)
class Law:
    """A force law per unit mass, as it stands inside the bracket of Eq. 17 (positive opposes the motion).

    Attributes:
        name: the effect's name, as in the model file.
        path: restoring, dissipation, ... (where in the rig it lives).
        parameters: what is to be identified.
        force: ``force(motion, parameters) -> expression`` in units of the displacement per s².
        equation: the term as text, for reports.
        sentence: what it is, for an engineer.
        source: where the law comes from.
    """

    name: str
    path: str
    parameters: tuple[LawParameter, ...]
    force: Callable[[Motion, Mapping[str, Expression]], Expression]
    equation: str
    sentence: str
    source: str
