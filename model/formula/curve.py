"""What a learnt term makes of the rig: the whole curve, Eq. 17's part with it, and its covariance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...errors import BadInput
from ..law import Expression, Law, Motion
from ..oscillator import Oscillator, Term

#: Points of a curve over the recorded range: far more than knots.
_POINTS = 121


@dataclass(frozen=True)
class Kind:
    """What the curve of a learnt law is.

    Attributes:
        variable: ``x`` displacement, ``v`` velocity, ``F`` recorded force, ``r`` what reaches the sensor.
        over: template of its unit.
        unit: template of the curve's unit.
        beside: of Eq. 17 what it stands beside, and as which power of the variable.
        times: what the curve is a factor of, ``v`` or ``x''``; its plainest form is then a constant and no line.
        mass: 1 where the plainest form is the mass of Eq. 17, -1 where it is a gain, in whose place the mass stands.
    """

    variable: str
    over: str
    unit: str
    beside: Mapping[str, int] = field(default_factory=dict)
    times: str = ""
    mass: int = 0


#: Of each learnt law, by its effect; a mass is told in parts of that of Eq. 17.
KINDS: dict[str, Kind] = {
    "free/spring": Kind("x", "X", "X/s2", {"omega0": 1, "cubic": 3}),
    "free/damping": Kind("v", "X/s", "X/s2", {"viscous": 1}),
    "free/surface": Kind("x", "X", "1/s", {"viscous": 0}, times="v"),
    "free/inertia": Kind("x", "X", "1", times="x''", mass=1),
    "free/drive": Kind("F", "Q", "Q", mass=-1),
    "free/sensor": Kind("r", "Y", "Y", mass=-1),
}


@dataclass(frozen=True, eq=False)
class LearntCurve:
    """A force per unit mass over x or x', a damping or a mass over x, or a map of the drive or of the sensor.

    Attributes:
        effect: of the learnt term.
        at: (n,) where, in the unit of the variable, over what was recorded.
        value: (n,) of the curve.
        covariance: (n, n).
        spacing: of its knots, in the unit of the variable.
    """

    effect: str
    at: np.ndarray
    value: np.ndarray
    covariance: np.ndarray
    spacing: float = 0.0

    @property
    def kind(self) -> Kind:
        """What it is."""
        return KINDS[self.effect]

    @property
    def variable(self) -> str:
        """See ``Kind``."""
        return self.kind.variable

    @property
    def times(self) -> str:
        """See ``Kind``."""
        return self.kind.times

    @property
    def std(self) -> np.ndarray:
        """(n,) standard error."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def learnt_terms(model: Oscillator) -> list[Term]:
    """The terms of a model whose shape was learnt over one variable."""
    return [term for term in model.terms if term.law.learnt and term.law.effect in KINDS and "/" in term.effect[5:]]


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
    kind = KINDS[effect]
    own = {name: parameter.value for name, parameter in term.parameters.items()}
    reach = own[law.parameters[-1].name]
    at = reach * np.linspace(-1.0, 1.0, _POINTS)
    q, strengths = ca.SX.sym("q"), [p.name for p in law.parameters if p.strength]
    symbols = {name: ca.SX.sym(name) for name in strengths}
    made = _made(law, kind, q, own | symbols)
    heights = ca.vertcat(*symbols.values())
    slope = ca.substitute(ca.jacobian(made, heights).T, heights, ca.DM([own[name] for name in strengths]))
    slopes = ca.Function("slopes", [q], [slope])
    each = np.array(slopes.map(_POINTS)(at[None])).reshape(len(strengths), _POINTS, order="F")
    columns = {f"{term.effect}.{name}": column for name, column in zip(strengths, each, strict=True)}
    value = np.sum([own[name] * columns[f"{term.effect}.{name}"] for name in strengths], axis=0)
    known = model.values()
    for name, power in kind.beside.items():
        column = at**power
        size = known[name] ** 2 if name == "omega0" else known[name]
        value = value + size * column
        columns[name] = 2.0 * known[name] * column if name == "omega0" else column
    if kind.mass:
        value = value + (1.0 if kind.times else at)
        columns["mass"] = kind.mass / known.get("mass", 1.0) * value
    names = provenance.parameters or tuple(known)
    rows = np.array(provenance.covariance, float)
    jacobian = np.column_stack([columns.get(name, np.zeros(_POINTS)) for name in names])
    covariance = jacobian @ rows @ jacobian.T
    spacing = 2.0 * reach / int(term.effect.rpartition("/")[2])
    return LearntCurve(effect, at, np.asarray(value), covariance, spacing)


def _made(law: Law, kind: Kind, q: Expression, own: Mapping[str, Expression]) -> Expression:
    """What a law makes of its variable, of a factor alone, of a map what it adds."""
    if path := law.drive or law.record:
        return path(Motion(0.0, 0.0, 0.0), own, q) - q
    assert law.force is not None
    place = 0.0 if kind.variable == "v" else q
    speed = q if kind.variable == "v" else float(kind.times == "v")
    return law.force(Motion(place, speed, 0.0, a=float(kind.times == "x''")), own)
