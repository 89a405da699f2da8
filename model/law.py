"""What a law is: one expression, its parameters, and the words an engineer needs to recognise it.

A law is written once, as a CasADi expression of the motion and of its own parameters. Simulation, FMU, CasADi
function and printed equation are all made from that one expression.

Signs and kinks are not written with ``sign()``: a law asks the motion for ``motion.sign(surface)``. The rendering
then decides what the sign is: an integer mode that changes at located events (exact), ``casadi.sign``
(a plain right-hand side), or ``tanh`` of a stated width (smooth). A law with a memory asks for ``motion.state(...)``
and says with ``motion.rate(...)`` how that state changes.

What a law has ``stored`` of the energy that it took is the one further fact; what it dissipates follows from both.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from ..errors import BadInput

_BRACES = re.compile(r"\{([^{}]*)\}")

Expression = Any  # casadi.SX; casadi is imported only where expressions are made


@dataclass(frozen=True)
class Scales:
    """Sizes of the motion that a law is looked for in: what is natural for a parameter follows from them.

    Attributes:
        length: largest displacement, in its unit.
        omega: natural frequency, rad/s.
        force: largest force, in its unit; 0 without one.
        response: largest recorded signal, in its unit.
        duration: of the longest recording, s.
        mass: None where only free decays were fitted.
        lines: frequencies in rad/s that stand out of what the model leaves over, the strongest first.
    """

    length: float
    omega: float
    force: float
    response: float
    duration: float
    mass: float | None = None
    lines: tuple[float, ...] = ()

    def of(self, unit: str) -> float:
        """Natural size of a parameter with that unit template (``X`` displacement, ``Q`` force)."""
        from .units import factors

        size = 1.0
        for symbol, power in factors(unit).items():
            base = {
                "X": self.length,
                "Y": self.response,
                "s": 1.0 / self.omega,
                "Q": self.force or 1.0,
            }.get(symbol, 1.0)
            size *= base**power
        return size


@dataclass(frozen=True)
class LawParameter:
    """A parameter of a law. ``unit`` is a template: ``X`` stands for the unit of the displacement, ``Q`` of the force.

    Attributes:
        lower, upper: bounds, in the unit.
        probes: where to look for it first, as multiples of ``size``; for a parameter that the law is
            proportional to (``strength``) the sizes to try where a small one tells nothing.
        strength: whether the law vanishes with it in proportion, so that a derivative at zero shows it.
        shape: whether it is kept at its first probe until the data ask for it.
        scale: whether it is a size that others are measured by, which no data ask for: never fitted.
        size: natural size where that of the unit is not it.
        in_radians: what it is where the displacement is the angle itself, in radians, whose sine gravity makes; fitted
            elsewhere, and there where the recordings ask for another value.
    """

    name: str
    unit: str
    description: str
    lower: float = -math.inf
    upper: float = math.inf
    probes: tuple[float, ...] | Literal["lines"] = ()
    strength: bool = False
    shape: bool = False
    scale: bool = False
    size: Callable[[Scales], float] | None = None
    in_radians: float | None = None

    def natural(self, scales: Scales) -> float:
        """Natural size of the parameter for a motion of these scales."""
        return scales.of(self.unit) if self.size is None else self.size(scales)


@dataclass(frozen=True)
class InnerState:
    """A state that a law adds to displacement and velocity.

    Attributes:
        name: within the law.
        unit: template as for a parameter.
        follows: what it is counted from at the start: ``displacement`` or ``velocity`` of the mass (a spring that
            has relaxed, a body that rides along); anything else: from zero.
        free: whether it has a value of its own in each recording even when that starts at rest (a phase).
    """

    name: str
    unit: str
    follows: str | None = None
    free: bool = False


@dataclass
class Motion:
    """The symbols a law may use, and what the laws have asked for.

    Attributes:
        x, v: displacement and velocity.
        t: time in s.
        recorded: what the recordings show: displacement, velocity or acceleration.
        force: that reaches the mass, for what is recorded beside it.
        a: acceleration, which a force may be in proportion to: of a mass beyond that of Eq. 17.
        mass: of Eq. 17, as forces are counted: 1 per unit mass, of an element what moves with it.
        surfaces: expressions whose sign changes the law; filled by ``sign``.
        signs: one symbol per surface.
        states, symbols, rates, reaches, owners: inner states and the law of each, filled by ``state``.
        owner: name of the law that is asking.
    """

    x: Expression
    v: Expression
    t: Expression
    recorded: str = "displacement"
    force: Expression = 0.0
    a: Expression = 0.0
    mass: Expression = 1.0
    surfaces: list[Expression] = field(default_factory=list)
    signs: list[Expression] = field(default_factory=list)
    states: list[InnerState] = field(default_factory=list)
    symbols: list[Expression] = field(default_factory=list)
    rates: list[Expression] = field(default_factory=list)
    reaches: list[Expression] = field(default_factory=list)
    owners: list[str] = field(default_factory=list)
    owner: str = ""

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

    def beyond(self, surface: Expression) -> Expression:
        """``surface`` where it is positive, else zero: what presses on a stop that it is the distance beyond."""
        return 0.5 * (1 + self.sign(surface)) * surface

    def state(
        self,
        name: str,
        unit: str,
        *,
        follows: str | None = None,
        free: bool = False,
        reach: Expression = 0.0,
    ) -> Expression:
        """A further state (see ``InnerState``); ``rate`` must be called for it.

        ``reach`` is how far it goes, where that and not its start decides how fast it can change.
        """
        import casadi

        symbol = casadi.SX.sym(name)
        self.states.append(InnerState(name, unit, follows, free))
        self.symbols.append(symbol)
        self.rates.append(None)
        self.reaches.append(reach)
        self.owners.append(self.owner)
        return symbol

    def inner(self, name: str) -> Expression:
        """The state of that name that the same law's force has asked for; raises BadInput where there is none."""
        for owner, state, symbol in zip(self.owners, self.states, self.symbols, strict=True):
            if (owner, state.name) == (self.owner, name):
                return symbol
        raise BadInput(f"stored looks for a state {name!r}; ask for it in force with motion.state({name!r}, unit)")

    def rate(self, state: Expression, expression: Expression) -> None:
        """Says how fast a state changes."""
        import casadi

        place = next(i for i, known in enumerate(self.symbols) if casadi.is_equal(known, state))
        self.rates[place] = expression


#: ``force(motion, parameters)``: force per unit mass, positive where it opposes a positive motion.
Force = Callable[[Motion, Mapping[str, Expression]], Expression]
#: ``path(motion, parameters, signal)``: what becomes of the recorded force, or of the motion that is to be recorded.
Path = Callable[[Motion, Mapping[str, Expression], Expression], Expression]
#: ``stored(motion, parameters)``: energy per unit mass, of the states and signs that the force asked for.
Stored = Callable[[Motion, Mapping[str, Expression]], Expression]


@dataclass(frozen=True)
class Law:
    """One physical effect. One of ``force``, ``drive`` and ``record`` says what it does.

    Attributes:
        name: as in the model file: the effect's name, with ``/variant`` behind it where the effect has several forms.
        path: restoring, dissipation, memory, inertia, excitation, measurement, either, environment: where in
            the rig it acts.
        parameters: what is to be identified.
        force: force per unit mass, as it stands inside the bracket of Eq. 17 (positive opposes the motion), in units of
            the displacement per s².
        stored: of a ``force``, the energy per unit mass that the law holds and can give back, in units of the
            displacement squared per s²; None: it holds none, so that all power it takes is dissipated.
        drive: from the force as recorded to the force that reaches the mass.
        record: from the motion to what the sensor makes of it.
        equation: as text, for reports: of a ``force`` the term in the bracket of Eq. 17, of the others what becomes of
            the force F or of the recorded signal r. Parameters stand in braces, further lines behind a semicolon:
            ``{stiffness} (x - q); q' = {rate} (x - q)``.
        sentence: what it is, for an engineer.
        phrase: the same in a few words that begin in small letters and can follow "missing:", without commas, so that
            several can be listed; ``effect_words`` makes one of the sentence where it is left empty.
        source: where the law comes from.
        curves: what it does to backbone and damping curve.
        proper: ``proper(values, base)``, with the values of Eq. 17 as ``base``, tells whether these values are what the
            name stands for, where another law has the same equation (a stop is stiffer than the spring, a clearance is
            not); None: always.
        rugged: whether its likelihood, simulated, has too many side valleys for a start from a screen.
        twin: name of a more general law that begins with the same parameters and, its further ones zero, has the same
            equation; where it has no further ones this law is not fitted by itself.
        cases: ``cases(values)`` gives laws of fewer parameters, by name, with the values at which they move the rig
            alike as long as the motion leaves some part of this law alone (one stop of two); None: there are none.
        learnt: whether its shape is learnt from the motion and stands for no cause: asked for where every law that has
            one has failed. Its name is ``free/...``, each an effect of its own.
        finer: of a learnt curve the law that has the same one and knots between; None: there is none.
    """

    name: str
    path: str
    parameters: tuple[LawParameter, ...]
    equation: str
    sentence: str
    source: str
    curves: str = ""
    phrase: str = ""
    force: Force | None = None
    stored: Stored | None = None
    drive: Path | None = None
    record: Path | None = None
    proper: Callable[[Mapping[str, float], Mapping[str, float]], bool] | None = None
    rugged: bool = False
    twin: str | None = None
    cases: Callable[[Mapping[str, float]], Sequence[tuple[str, Mapping[str, float]]]] | None = None
    learnt: bool = False
    finer: str | None = None

    def in_words(self, shown: Callable[[str], str]) -> str:
        """The equation with ``shown(name)`` in place of each parameter, by its name within the law."""
        return _BRACES.sub(lambda match: shown(match.group(1)), self.equation)

    @property
    def lags(self) -> bool:
        """Whether all that it does is to come late, by its one parameter."""
        return self.force is None and len(self.parameters) == 1 and self.parameters[0].unit == "s"

    @property
    def effect(self) -> str:
        """The effect's name, without the variant; of what is learnt without its fineness."""
        return "/".join(self.name.split("/")[: 2 if self.learnt else 1])
