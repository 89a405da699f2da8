"""The pieces that closed forms are made of: each a function of one variable with at most one constant inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Atom:
    """One piece.

    Attributes:
        name: for lists.
        values: ``values(q, a)`` of q (n,) and the constant within, in the unit of q.
        text: the same for people; ``{q}`` and ``{a}`` stand for variable and constant.
        code: the same in Python for a law's ``force``, with ``ca`` for casadi.
        stored: its integral from zero, likewise.
        slope: its derivative, likewise.
        power: of the variable's unit that the piece has; None: it has a constant within, and no unit.
    """

    name: str
    values: Callable[[np.ndarray, float], np.ndarray]
    text: str
    code: str
    stored: str
    slope: str
    power: int | None = None

    @property
    def within(self) -> bool:
        """Whether it has a constant within, of the variable's unit."""
        return self.power is None


_MADE = (
    Atom("square", lambda q, a: q**2, "{q}²", "{q}**2", "{q}**3 / 3",
         "2 * {q}", 2),
    Atom("signed-square", lambda q, a: q * np.abs(q), "{q}|{q}|", "motion.sign({q}) * {q}**2",
         "motion.sign({q}) * {q}**3 / 3",
         "2 * motion.sign({q}) * {q}", 2),
    Atom("cube", lambda q, a: q**3, "{q}³", "{q}**3", "{q}**4 / 4",
         "3 * {q}**2", 3),
    Atom("size", lambda q, a: np.abs(q), "|{q}|", "motion.sign({q}) * {q}", "motion.sign({q}) * {q}**2 / 2",
         "motion.sign({q})", 1),
    Atom("fourth", lambda q, a: q**4, "{q}⁴", "{q}**4", "{q}**5 / 5",
         "4 * {q}**3", 4),
    Atom("fifth", lambda q, a: q**5, "{q}⁵", "{q}**5", "{q}**6 / 6",
         "5 * {q}**4", 5),
    Atom("tanh", lambda q, a: np.tanh(q / a), "tanh({q}/{a})", "ca.tanh({q} / {a})",
         "{a} * ca.log(ca.cosh({q} / {a}))",
         "(1 - ca.tanh({q} / {a}) ** 2) / {a}"),
    Atom("sine", lambda q, a: np.sin(q / a), "sin({q}/{a})", "ca.sin({q} / {a})", "{a} * (1 - ca.cos({q} / {a}))",
         "ca.cos({q} / {a}) / {a}"),
    Atom("exponential", lambda q, a: np.expm1(q / a), "(exp({q}/{a}) - 1)", "ca.expm1({q} / {a})",
         "{a} * ca.expm1({q} / {a}) - {q}",
         "ca.exp({q} / {a}) / {a}"),
    Atom("falling-exponential", lambda q, a: np.expm1(-q / a), "(exp(-{q}/{a}) - 1)", "ca.expm1(-{q} / {a})",
         "-{a} * ca.expm1(-{q} / {a}) - {q}",
         "-ca.exp(-{q} / {a}) / {a}"),
    Atom("root", lambda q, a: np.sqrt(1 + (q / a) ** 2) - 1, "(sqrt(1 + ({q}/{a})²) - 1)",
         "ca.sqrt(1 + ({q} / {a}) ** 2) - 1",
         "({q} * ca.sqrt(1 + ({q} / {a}) ** 2) + {a} * ca.asinh({q} / {a})) / 2 - {q}",
         "{q} / ({a}**2 * ca.sqrt(1 + ({q} / {a}) ** 2))"),
    Atom("over-root", lambda q, a: q / np.sqrt(a**2 + q**2), "{q}/sqrt({a}² + {q}²)",
         "{q} / ca.sqrt({a}**2 + {q}**2)", "ca.sqrt({a}**2 + {q}**2) - {a}",
         "{a}**2 / ca.sqrt({a}**2 + {q}**2) ** 3"),
    Atom("rational", lambda q, a: (q / a) / (1 + (q / a) ** 2), "({q}/{a})/(1 + ({q}/{a})²)",
         "({q} / {a}) / (1 + ({q} / {a}) ** 2)", "{a} / 2 * ca.log1p(({q} / {a}) ** 2)",
         "(1 - ({q} / {a}) ** 2) / ({a} * (1 + ({q} / {a}) ** 2) ** 2)"),
    Atom("even-rational", lambda q, a: (q / a) ** 2 / (1 + (q / a) ** 2), "({q}/{a})²/(1 + ({q}/{a})²)",
         "({q} / {a}) ** 2 / (1 + ({q} / {a}) ** 2)", "{q} - {a} * ca.atan({q} / {a})",
         "2 * {q} / ({a}**2 * (1 + ({q} / {a}) ** 2) ** 2)"),
    Atom("saturation", lambda q, a: np.clip(q / a, -1, 1), "sat({q}/{a})",
         "({q} - motion.beyond({q} - {a}) + motion.beyond(-{q} - {a})) / {a}",
         "({q}**2 - motion.beyond({q} - {a}) ** 2 - motion.beyond(-{q} - {a}) ** 2) / (2 * {a})",
         "-(motion.sign(-{q} - {a}) + motion.sign({q} - {a})) / (2 * {a})"),
    Atom("dead-zone", lambda q, a: np.sign(q) * np.maximum(np.abs(q) / a - 1, 0), "dz({q}/{a})",
         "(motion.beyond({q} - {a}) - motion.beyond(-{q} - {a})) / {a}",
         "(motion.beyond({q} - {a}) ** 2 + motion.beyond(-{q} - {a}) ** 2) / (2 * {a})",
         "(2 + motion.sign({q} - {a}) + motion.sign(-{q} - {a})) / (2 * {a})"),
    Atom("above", lambda q, a: np.maximum(q / a - 1, 0), "max({q}/{a} - 1, 0)", "motion.beyond({q} - {a}) / {a}",
         "motion.beyond({q} - {a}) ** 2 / (2 * {a})",
         "(1 + motion.sign({q} - {a})) / (2 * {a})"),
    Atom("below", lambda q, a: np.minimum(q / a + 1, 0), "min({q}/{a} + 1, 0)", "-motion.beyond(-{q} - {a}) / {a}",
         "motion.beyond(-{q} - {a}) ** 2 / (2 * {a})",
         "(1 + motion.sign(-{q} - {a})) / (2 * {a})"),
)  # fmt: skip

#: Every piece by its name, the plainest first.
ATOMS: dict[str, Atom] = {atom.name: atom for atom in _MADE}
