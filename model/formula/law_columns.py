"""Laws of the library as functions of the one variable of a learnt curve."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..law import Expression, Law, LawParameter, Motion, Scales
from ..laws import LIBRARY, PRESCRIBED
from .curve import LearntCurve

_SIZES = 60  # of a constant inside, even in the logarithm: where it is first looked for
_WIDER = 3.0  # times its probes, on either side
_ALIKE = 1e-9  # of two numbers that are one


class _Rendered(Motion):
    """A motion whose signs are written out."""

    def sign(self, surface: Expression) -> Expression:
        """The sign itself."""
        import casadi as ca

        return ca.sign(surface)


@dataclass(frozen=True, eq=False)
class Column:
    """A law as a function of the curve's variable.

    Attributes:
        law: None: Eq. 17 has nothing beside it.
        strength: the parameter that it is proportional to.
        inside: the others that it depends on.
        made: ``made(inside)`` gives (n,) at the curve's points, of a strength of one.
    """

    law: Law | None
    strength: LawParameter | None
    inside: tuple[LawParameter, ...]
    made: Callable[[np.ndarray], np.ndarray]

    @property
    def constants(self) -> int:
        """How many it has."""
        return len(self.inside) + (self.strength is not None)

    def grid(self, scales: Scales) -> np.ndarray:
        """(m, inside) sizes among which the constants inside are first looked for."""
        each = []
        for parameter in self.inside:
            given = parameter.probes
            probes = np.array([1.0] if isinstance(given, str) or not given else given)
            size = np.geomspace(np.min(np.abs(probes)) / _WIDER, np.max(np.abs(probes)) * _WIDER, _SIZES)
            if probes.size == 1:
                size = np.abs(probes)  # an exponent
            size = np.concatenate([-size[::-1], size]) if np.any(probes < 0) else size
            size = parameter.natural(scales) * size
            each.append(size[(size > parameter.lower) & (size < parameter.upper)])
        return np.array(list(product(*each))) if each else np.zeros((1, 0))


def columns_for(curve: LearntCurve) -> Iterator[Column]:
    """Eq. 17 by itself, and each law that is a function of the curve's variable alone, the plainer first."""
    yield Column(None, None, (), lambda _: np.zeros(curve.at.size))
    for law in (*LIBRARY.values(), *PRESCRIBED.values()):
        if law.force is not None and not law.learnt and law.path in ("restoring", "dissipation"):
            column = _column(law, curve)
            if column is not None:
                yield column


def _column(law: Law, curve: LearntCurve) -> Column | None:
    """A law over the curve's variable; None where it follows another one too, remembers, or does not follow it."""
    import casadi as ca

    q, off, time = ca.SX.sym("q"), ca.SX.sym("off"), ca.SX.sym("t")
    symbols = {parameter.name: ca.SX.sym(parameter.name) for parameter in law.parameters}

    def over(x: Expression, v: Expression) -> Expression | None:
        motion = _Rendered(x, v, time)
        assert law.force is not None
        made = ca.SX(law.force(motion, symbols))
        return None if motion.states or ca.depends_on(made, time) else made

    made = over(off, q) if curve.variable == "v" else over(q, ca.SX(1.0 if curve.times else 0.0))
    if made is None or not ca.depends_on(made, q) or ca.depends_on(made, off):
        return None
    if curve.times:  # it has to be in proportion to the velocity
        twice = over(q, ca.SX(2.0)) - 2.0 * made
        known = ca.Function("known", [q, *symbols.values()], [made, twice])
        once, beside = (float(value) for value in known(0.37, *(0.61 + 0.1 * k for k in range(len(symbols)))))
        if once == 0.0 or abs(beside / once) > _ALIKE:
            return None
    used = [p for p in law.parameters if not p.shape and ca.depends_on(made, symbols[p.name])]
    strengths, inside = ([p for p in used if p.strength == wanted] for wanted in (True, False))
    if len(strengths) != 1:
        return None
    fixed = {p.name: _first(p) for p in law.parameters if p not in used} | {strengths[0].name: 1.0}
    made = ca.substitute(made, ca.vertcat(*(symbols[name] for name in fixed)), ca.DM(list(fixed.values())))
    function = ca.Function("column", [q, ca.vertcat(*(symbols[p.name] for p in inside))], [made])
    at, many = curve.at[None], function.map(curve.at.size)

    def values(within: np.ndarray) -> np.ndarray:
        return np.array(many(at, np.repeat(within[:, None], at.size, axis=1))).ravel()

    return Column(law, strengths[0], tuple(inside), values)


def _first(parameter: LawParameter) -> float:
    probes = parameter.probes
    return float(probes[0]) if parameter.shape and not isinstance(probes, str) and probes else 0.0
