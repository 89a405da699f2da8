"""What a learnt term makes of the rig: the whole curve, Eq. 17's part with it, and its covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ..law import Motion
from ..oscillator import Oscillator, Term

#: Points of a curve over the recorded range: far more than knots.
_POINTS = 121
#: Of Eq. 17 what a learnt term has its curve beside, and as which power of the variable.
_BESIDE = {"free/spring": {"omega0": 1, "cubic": 3}, "free/damping": {"viscous": 1}, "free/surface": {"viscous": 0}}


@dataclass(frozen=True, eq=False)
class LearntCurve:
    """A force per unit mass over x or x', or a damping over x.

    Attributes:
        effect: of the learnt term.
        variable: ``x`` or ``v``.
        at: (n,) where, in the unit of the variable, over what was recorded.
        value: (n,) of the curve.
        covariance: (n, n).
        times: ``v`` where the force is the curve times the velocity, else empty.
        spacing: of its knots, in the unit of the variable.
    """

    effect: str
    variable: str
    at: np.ndarray
    value: np.ndarray
    covariance: np.ndarray
    times: str = ""
    spacing: float = 0.0

    @property
    def std(self) -> np.ndarray:
        """(n,) standard error."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def learnt_terms(model: Oscillator) -> list[Term]:
    """The terms of a model whose shape was learnt over one variable."""
    return [term for term in model.terms if term.law.learnt and term.law.effect in _BESIDE and "/" in term.effect[5:]]


def curve_of(model: Oscillator, term: Term) -> LearntCurve:
    """The curve of a learnt term together with the members of Eq. 17 over the same variable.

    Raises:
        BadInput: the model states no covariance.
    """
    import casadi as ca

    effect, law = term.law.effect, term.law
    provenance = model.identified
    if provenance is None or provenance.covariance is None:
        raise BadInput("the model has no covariance, which a formula is judged by; identify or diagnose it again")
    over = "v" if effect == "free/damping" else "x"
    own = {name: parameter.value for name, parameter in term.parameters.items()}
    reach = own[law.parameters[-1].name]
    at = reach * np.linspace(-1.0, 1.0, _POINTS)
    q, strengths = ca.SX.sym("q"), [p.name for p in law.parameters if p.strength]
    symbols = {name: ca.SX.sym(name) for name in strengths}
    motion = Motion(q if over == "x" else ca.SX(0), q if over == "v" else ca.SX(1), ca.SX(0))
    assert law.force is not None
    made = law.force(motion, own | symbols)
    slopes = ca.Function("slopes", [q], [ca.jacobian(made, ca.vertcat(*symbols.values())).T])
    each = np.array(slopes.map(_POINTS)(at[None])).reshape(len(strengths), _POINTS, order="F")
    columns = {f"{term.effect}.{name}": column for name, column in zip(strengths, each, strict=True)}
    value = sum(own[name] * columns[f"{term.effect}.{name}"] for name in strengths)
    known = model.values()
    for name, power in _BESIDE[effect].items():
        column = at**power
        size = known[name] ** 2 if name == "omega0" else known[name]
        value = value + size * column
        columns[name] = 2.0 * known[name] * column if name == "omega0" else column
    names = provenance.parameters or tuple(known)
    rows = np.array(provenance.covariance, float)
    jacobian = np.column_stack([columns.get(name, np.zeros(_POINTS)) for name in names])
    covariance = jacobian @ rows @ jacobian.T
    times = "v" if effect == "free/surface" else ""
    spacing = 2.0 * reach / int(term.effect.rpartition("/")[2])
    return LearntCurve(effect, over, at, np.asarray(value), covariance, times, spacing)
