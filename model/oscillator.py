"""What an oscillator is: Eq. 17 with its numbers, further terms, and where they came from."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

from ..errors import BadInput
from . import units
from .law import Law
from .laws import BASE
from .limits import plain_number
from .parameter import Parameter

if TYPE_CHECKING:
    import numpy as np

MASS_UNIT = "Q.s2/X"
QUANTITIES = ("displacement", "velocity", "acceleration")
#: Half the width of a band's flank, as a part of the way from the mode to its edge (in logarithms).
_TAPER = 0.25
#: How the recorded force ran between its samples, and in words.
HOLDS = {
    "zero": "held from sample to sample",
    "linear": "in straight lines between samples",
    "smooth": "smooth between samples",
}


@dataclass(frozen=True)
class Response:
    """What the recordings show of the motion, and in which unit."""

    quantity: str = "displacement"
    unit: str = "m"

    @property
    def displacement_unit(self) -> str:
        """Unit of the displacement that belongs to the recorded quantity."""
        order = QUANTITIES.index(self.quantity)
        return units.compose(f"X.s{order}" if order else "X", self.unit)


@dataclass(frozen=True)
class Range:
    """What the recordings covered, from ``min`` to ``max``."""

    min: float
    max: float
    unit: str


@dataclass(frozen=True)
class Band:
    """The band in which one mode of a recording was looked at, in Hz.

    Attributes:
        mode: frequency of the mode.
        low: lower edge, at half height; 0 for none.
        high: upper edge, at half height; None for none.
    """

    mode: float
    low: float = 0.0
    high: float | None = None

    @property
    def flat(self) -> tuple[float, float]:
        """Between which frequencies it passes everything: three quarters of the way to its edges, in logarithms."""
        below = self.mode * (self.low / self.mode) ** (1 - _TAPER) if self.low > 0 else 0.0
        return below, math.inf if self.high is None else self.mode * (self.high / self.mode) ** (1 - _TAPER)

    @property
    def taper(self) -> float:
        """Width in Hz of its narrower flank, from all to nothing."""
        edges = [edge for edge in (self.low, self.high) if edge]
        widths = [self.mode * abs((e / self.mode) ** (1 + _TAPER) - (e / self.mode) ** (1 - _TAPER)) for e in edges]
        return min(widths, default=math.inf)

    def gain(self, frequency: np.ndarray) -> np.ndarray:
        """(n,) gain, 0 to 1, at frequencies in Hz: flanks are half a cosine of the frequency's logarithm."""
        import numpy as np

        octaves = np.log(np.maximum(frequency, 1e-9 * self.mode) / self.mode)
        gain = np.ones(frequency.shape)
        for edge, sign in ((self.low, -1.0), (self.high, 1.0)):
            if edge:
                way = sign * octaves / abs(math.log(edge / self.mode))
                gain = gain * (0.5 + 0.5 * np.cos(np.pi * np.clip((way - 1 + _TAPER) / (2 * _TAPER), 0.0, 1.0)))
        return gain


@dataclass(frozen=True)
class Term:
    """One further effect beside Eq. 17, with the parameters of its law by their names."""

    law: Law
    parameters: Mapping[str, Parameter]

    @property
    def effect(self) -> str:
        """Name of the law."""
        return self.law.name


@dataclass(frozen=True)
class Provenance:
    """Where the numbers come from.

    Attributes:
        recordings: one mapping a recording with ``file``, ``sha256``, ``kind`` and what the model leaves of it, by its
            rms: ``nrmse`` over the standard deviation of the motion, ``over_noise`` over the noise; ``zero`` is
            what its sensor shows at rest, in the unit of the response, where that stands out; ``fault`` says what the
            measuring chain did to it, where that was asked for and found.
        method: for example ``maximum-likelihood``.
        software: name and version.
        commit: of the checkout that it ran from, "" where it was installed.
        versions: of Python and of the packages that compute, by name.
        command: line that was typed, "" where none was.
        parameters: names in the order of the covariance's rows.
        covariance: rows of the parameters' covariance, in the parameters' units.
        log_likelihood: at the maximum.
        band: in which one of several modes was isolated; None where recordings were taken as they are.
    """

    recordings: tuple[Mapping[str, Any], ...] = ()
    method: str = ""
    software: str = ""
    parameters: tuple[str, ...] = ()
    covariance: tuple[tuple[float, ...], ...] | None = None
    log_likelihood: float | None = None
    band: Band | None = None
    commit: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    command: str = ""


@dataclass(frozen=True, repr=False)
class Oscillator:
    """A single oscillator: the Eq. 17 family and further terms.

    ``mass (x'' + viscous x' + dry sgn x' + omega0² x + cubic x³ + preload sgn x + terms) = F``

    All forces are per unit mass. ``mass`` is None where only free decays were fitted, or where a moving base drove the
    rig; the input is then a force per unit mass, of a base minus its acceleration. ``hold`` says for which course of
    the force between its samples the numbers were identified, one of HOLDS; the equation is the same. Source: Feldman,
    Bucher, Rotberg, Eq. 17, in SI units (cubic in 1/(m² s²)).
    """

    mass: Parameter | None
    omega0: Parameter
    cubic: Parameter
    preload: Parameter
    viscous: Parameter
    dry: Parameter
    name: str = "oscillator"
    terms: tuple[Term, ...] = ()
    response: Response = Response()
    force_unit: str = "N"
    hold: str = "smooth"
    amplitude: Range | None = None
    frequency: Range | None = None
    identified: Provenance = field(default_factory=Provenance)

    #: Whether its motion is given and its force follows, as of an ``Element``.
    imposed: ClassVar[bool] = False

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {p}" for name, p in self.parameters().items())
        return f"<Oscillator {self.name!r}: {values}>"

    @classmethod
    def from_values(
        cls,
        values: Mapping[str, float],
        *,
        name: str = "oscillator",
        response: Response | None = None,
        force_unit: str = "N",
        laws: Sequence[Law] = (),
    ) -> Oscillator:
        """An oscillator from plain numbers, units filled in; a missing ``mass`` means None.

        Args:
            values: by the names of ``parameters()``; those of further effects as ``effect.parameter``.
            name: the rig's name.
            response: what the recordings show.
            force_unit: unit of the excitation.
            laws: of the further effects; ``library.oscillator_with`` finds them by their names.

        Raises:
            BadInput: a parameter is missing, not known, or no number.
        """
        response = response or Response()
        given = dict(values)
        unit = response.displacement_unit

        def take(key: str, template: str) -> Parameter:
            if key not in given:
                raise BadInput(f"parameter {key!r} is missing; give a value for it")
            value = plain_number(key, given.pop(key))
            return Parameter(value, None, units.compose(template, unit, force_unit, response.unit))

        mass = take("mass", MASS_UNIT) if given.get("mass") is not None else None
        given.pop("mass", None)
        base: dict[str, Any] = {p.name: take(p.name, p.unit) for law in BASE for p in law.parameters}
        terms = tuple(Term(law, {p.name: take(f"{law.name}.{p.name}", p.unit) for p in law.parameters}) for law in laws)
        if given:
            unknown = min(map(str, given))
            raise BadInput(f"unknown parameter {unknown[:60]!r}; known are mass, {', '.join(base)}")
        return cls(mass=mass, **base, name=name, terms=terms, response=response, force_unit=force_unit)

    @property
    def takes_acceleration(self) -> bool:
        """Whether it was identified under a moving base: its force is minus the base's acceleration."""
        return self.force_unit == units.compose("X/s2", self.response.displacement_unit)

    @property
    def is_base_driven(self) -> bool:
        """Whether its input is minus the acceleration of the base, and nothing else."""
        return self.mass is None and self.takes_acceleration

    @property
    def driven_through(self) -> str:
        """ "spring" or "damper", where its input is the displacement or velocity of what moves the other end of one."""
        length = self.response.displacement_unit
        through = {length: "spring", units.compose("X/s", length): "damper"}
        return through.get(self.force_unit, "") if length in ("m", "rad") else ""

    @property
    def input_words(self) -> str:
        """What its input is, in words."""
        if self.driven_through:
            moved = "displacement" if self.driven_through == "spring" else "velocity"
            return f"{moved} of what moves the other end of the {self.driven_through} that drives it"
        if self.is_base_driven:
            return "minus the acceleration of the base; the response is relative to the base"
        if self.mass is None:
            return "excitation force per unit mass, positive along x (the mass was not identified)"
        return "excitation force, positive along x"

    @property
    def over_what_drives(self) -> str:
        """What the machine's own quantities are over, where a spring or damper drives it; else empty."""
        of = {"spring": "stiffness", "damper": "damping"}
        through = self.driven_through
        return f", over the {of[through]} of the {through} that drives it" if through else ""

    @property
    def why_no_mass(self) -> str:
        """Why there is no mass."""
        if self.is_base_driven:
            return "its base moves it, which tells no mass"
        return "only free decays were fitted" if self.identified.recordings else "none was given"

    def parameters(self) -> dict[str, Parameter]:
        """Every parameter by its name, in the order used everywhere: mass (unless None), Eq. 17, the terms."""
        parameters: dict[str, Parameter] = {} if self.mass is None else {"mass": self.mass}
        for law in BASE:
            for p in law.parameters:
                parameters[p.name] = getattr(self, p.name)
        for term in self.terms:
            for name, parameter in term.parameters.items():
                parameters[f"{term.effect}.{name}"] = parameter
        return parameters

    @property
    def energy_units(self) -> tuple[str, str]:
        """Units of energy and power; without a mass both are per unit mass, as the force is."""
        energy, power = ("X2/s2", "X2/s3") if self.mass is None else (units.ENERGY, units.POWER)
        length = self.response.displacement_unit
        return units.compose(energy, length, self.force_unit), units.compose(power, length, self.force_unit)

    def values(self) -> dict[str, float]:
        """The parameters' plain values."""
        return {name: parameter.value for name, parameter in self.parameters().items()}

    def with_parameters(self, changed: Mapping[str, Parameter]) -> Oscillator:
        """The same oscillator with some parameters replaced, by the names of ``parameters()``."""
        plain = {name: parameter for name, parameter in changed.items() if "." not in name}
        terms = tuple(
            replace(
                term,
                parameters={
                    name: changed.get(f"{term.effect}.{name}", parameter) for name, parameter in term.parameters.items()
                },
            )
            for term in self.terms
        )
        return replace(self, terms=terms, **plain)

    def descriptions(self) -> dict[str, str]:
        """What each parameter is, in words."""
        descriptions = {} if self.mass is None else {"mass": f"moving mass{self.over_what_drives}"}
        for law in BASE:
            descriptions.update({p.name: p.description for p in law.parameters})
        for term in self.terms:
            descriptions.update({f"{term.effect}.{p.name}": p.description for p in term.law.parameters})
        return descriptions

    def bounds(self) -> dict[str, tuple[float, float]]:
        """Lower and upper bound of each parameter, in its unit; infinite where there is none."""
        bounds = {} if self.mass is None else {"mass": (0.0, math.inf)}
        for law in BASE:
            bounds.update({p.name: (p.lower, p.upper) for p in law.parameters})
        for term in self.terms:
            bounds.update({f"{term.effect}.{p.name}": (p.lower, p.upper) for p in term.law.parameters})
        return bounds

    def equation(self, shown: Callable[[str], str] | None = None) -> str:
        """The equation of motion as text, for reports; further equations and what the paths do stand behind semicolons.

        ``shown`` makes the text of a parameter, by the names of ``parameters()``; by default that is its name, for a
        further effect as short as can be without two of the same.
        """
        if shown is None:
            shown = self._short
        order = (3, 4, 0, 1, 2)  # the order of Eq. 17: damping first
        inner, further = ["x''", *(BASE[i].in_words(shown) for i in order)], []
        for term in self.terms:
            text = term.law.in_words(lambda name, term=term: shown(f"{term.effect}.{name}"))
            first, *rest = text.split("; ")
            (inner if term.law.force else further).append(first)
            further += rest
        bracket = " + ".join(inner).replace("+ -", "- ")
        whole = f"{bracket} = f(t)" if self.mass is None else f"{shown('mass')} [{bracket}] = F(t)"
        return "; ".join([whole, *further])

    def _short(self, name: str) -> str:
        effect, _, own = name.rpartition(".")
        if own == "coefficient":
            return effect
        return own if sum(other.rpartition(".")[2] == own for other in self.parameters()) == 1 else name
