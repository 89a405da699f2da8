"""What resists a motion that is imposed on it: a damper, a seal, a gas strut, a joint in a test machine.

``inertia x'' + viscous x' + dry sgn x' + stiffness x + cubic x³ + preload sgn x + load + terms = F``

Here the motion is given and the force follows, so that nothing is per unit mass: the members are those of Eq. 17 times
a mass, in newtons, and each strength of a further law with them. The inertia is that of what moves between the specimen
and the load cell; it may be none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from ..errors import BadInput
from . import units
from .dependence import Dependence, channels_of, in_order, own_unit, strength_at
from .law import Law, LawParameter
from .laws import BASE
from .limits import plain_number
from .machine_units import in_force, words_of_product
from .oscillator import MASS_UNIT, Provenance, Range, Response, Term
from .parameter import Parameter

_STIFFNESS = Law(
    name="element-stiffness",
    path="restoring",
    parameters=(LawParameter("stiffness", "1/s2", "stiffness of the linear spring"),),
    force=lambda motion, p: p["stiffness"] * motion.x,
    stored=lambda motion, p: p["stiffness"] * motion.x**2 / 2,
    equation="{stiffness} x",
    sentence="A spring whose force grows in proportion to the displacement.",
    source="Feldman, Bucher, Rotberg, Eqs. 2 and 17",
)
_LOAD = Law(
    name="element-load",
    path="restoring",
    parameters=(LawParameter("load", "X/s2", "constant force"),),
    force=lambda motion, p: p["load"],
    stored=lambda motion, p: p["load"] * motion.x,
    equation="{load}",
    sentence="A force that is there whatever the motion.",
    source="statics",
)
#: Name of the mass that moves with it.
INERTIA = "inertia"
#: Its members, in the order of the file: Eq. 17 with a stiffness in place of a natural frequency, and a constant.
MEMBERS: tuple[Law, ...] = (_STIFFNESS, *BASE[1:], _LOAD)
_WORDS = {
    INERTIA: "mass that moves with it, of grips and rod",
    "stiffness": "stiffness of the linear spring",
    "cubic": "stiffness of the cubic spring",
    "preload": "force that leaves the seat of a preloaded spring",
    "viscous": "viscous damping",
    "dry": "dry friction",
    "load": "constant force",
}


def template_of(parameter: LawParameter) -> str:
    """Unit template of a law's parameter where the law acts by itself: only its strengths are forces."""
    return in_force(parameter.unit) if parameter.strength else parameter.unit


def templates() -> dict[str, str]:
    """Unit template of each member."""
    return {INERTIA: MASS_UNIT} | {p.name: in_force(p.unit) for law in MEMBERS for p in law.parameters}


@dataclass(frozen=True, repr=False)
class Element:
    """A force law by itself, identified from a prescribed motion and the force that this took.

    Attributes:
        members: inertia and members by their names, in the order of ``MEMBERS``.
        name: of the specimen.
        terms: further laws, whose strengths are forces and not forces per unit mass.
        unit: of the displacement.
        force_unit: of the force.
        origin: displacement, as recorded, from which the laws count it.
        amplitude, speed: what the recordings covered.
        identified: where the numbers come from.
        dependences: strengths that depend on a channel: their values are those at its reference.
    """

    members: Mapping[str, Parameter]
    name: str = "element"
    terms: tuple[Term, ...] = ()
    unit: str = "m"
    force_unit: str = "N"
    origin: float = 0.0
    amplitude: Range | None = None
    speed: Range | None = None
    identified: Provenance = field(default_factory=Provenance)
    dependences: tuple[Dependence, ...] = ()

    #: Whether its motion is given and its force follows.
    imposed: ClassVar[bool] = True

    def __repr__(self) -> str:
        return f"<Element {self.name!r}: {', '.join(f'{name} {p}' for name, p in self.parameters().items())}>"

    @classmethod
    def from_values(
        cls,
        values: Mapping[str, float],
        *,
        name: str = "element",
        unit: str = "m",
        force_unit: str = "N",
        origin: float = 0.0,
        laws: Sequence[Law] = (),
        dependences: Sequence[Dependence] = (),
    ) -> Element:
        """An element from plain numbers, units filled in; members that are left out are zero.

        Args:
            values: by the names of ``parameters()``.
            name: of the specimen.
            unit: of the displacement.
            force_unit: of the force.
            origin: displacement from which the laws count it.
            laws: of the further terms.
            dependences: on channels, whose own numbers are among the values.

        Raises:
            BadInput: a parameter of a law is missing, one is not known, or is no number.
        """
        given = dict(values)

        def take(key: str, template: str, otherwise: float | None = None) -> Parameter:
            if key not in given and otherwise is None:
                raise BadInput(f"parameter {key!r} is missing; give a value for it")
            value = plain_number(key, given.pop(key, otherwise))
            return Parameter(value, None, units.compose(template, unit, force_unit))

        members = {key: take(key, template, 0.0) for key, template in templates().items()}
        terms = tuple(
            Term(law, {p.name: take(f"{law.name}.{p.name}", template_of(p)) for p in law.parameters}) for law in laws
        )
        known = members | {f"{term.effect}.{name}": p for term in terms for name, p in term.parameters.items()}
        made: list[Dependence] = []
        for one in dependences:
            if one.of not in known:
                raise BadInput(f"nothing is called {one.of[:60]!r} that may depend on {one.channel}")
            number = take(one.name, "1") if one.name else None
            if number is not None:
                number = replace(number, unit=own_unit(one.how, known[one.of].unit, one.unit))
            made.append(replace(one, parameter=number))
        if given:
            unknown = min(map(str, given))
            raise BadInput(f"unknown parameter {unknown[:60]!r}; known are {', '.join(members)}")
        return cls(members, name, terms, unit, force_unit, float(origin), dependences=tuple(made))

    @property
    def response(self) -> Response:
        """What is prescribed of it."""
        return Response("displacement", self.unit)

    def parameters(self) -> dict[str, Parameter]:
        """Every parameter by its name: the members, then those of the terms, then those of dependences."""
        named = {f"{t.effect}.{name}": p for t in self.terms for name, p in t.parameters.items()}
        own = {one.name: one.parameter for one in self.dependences if one.parameter is not None}
        return {**self.members, **named, **own}

    def values(self) -> dict[str, float]:
        """The parameters' plain values."""
        return {name: parameter.value for name, parameter in self.parameters().items()}

    def with_parameters(self, changed: Mapping[str, Parameter]) -> Element:
        """The same with some parameters replaced, by the names of ``parameters()``."""
        terms = tuple(
            replace(t, parameters={name: changed.get(f"{t.effect}.{name}", p) for name, p in t.parameters.items()})
            for t in self.terms
        )
        ways = tuple(replace(one, parameter=changed.get(one.name, one.parameter)) for one in self.dependences)
        members = {n: changed.get(n, p) for n, p in self.members.items()}
        return replace(self, members=members, terms=terms, dependences=ways)

    @property
    def channels(self) -> dict[str, Dependence]:
        """A dependence on each channel, by the channel's name: unit, reference and what was recorded."""
        return channels_of(self.dependences)

    def at(self, channels: Mapping[str, float]) -> Element:
        """The element where channels have values, by name; those that are left out have their references.

        Raises:
            BadInput: it depends on no such channel.
        """
        for name in channels:
            if name not in self.channels:
                raise BadInput(
                    f"{self.name} depends on no channel {name[:60]!r}; it has {', '.join(self.channels) or 'none'}"
                )
        known, changed = self.parameters(), {}
        for of in {one.of for one in self.dependences}:
            value = strength_at(self.dependences, of, known[of].value, self.values(), channels)
            changed[of] = replace(known[of], value=float(value))
        return replace(self.with_parameters(changed), dependences=())

    def descriptions(self) -> dict[str, str]:
        """What each parameter is, in words."""
        own = {f"{t.effect}.{p.name}": p.description for t in self.terms for p in t.law.parameters}
        ways = {d.name: d.form.words.format(channel=d.channel, of=d.of) for d in self.dependences if d.name}
        return _WORDS | {name: words_of_product(text) for name, text in own.items()} | ways

    def bounds(self) -> dict[str, tuple[float, float]]:
        """Lower and upper bound of each parameter, in its unit; infinite where there is none."""
        own = {p.name: (p.lower, p.upper) for law in MEMBERS for p in law.parameters} | {INERTIA: (0.0, math.inf)}
        bounds = {name: own[name] for name in self.members}
        bounds |= {d.name: (-math.inf, math.inf) for d in self.dependences if d.name}
        return bounds | {f"{t.effect}.{p.name}": (p.lower, p.upper) for t in self.terms for p in t.law.parameters}

    @property
    def energy_units(self) -> tuple[str, str]:
        """Units of energy and power."""
        return units.compose(units.ENERGY, self.unit, self.force_unit), units.compose(
            units.POWER, self.unit, self.force_unit
        )

    def equation(self, shown: Callable[[str], str] | None = None) -> str:
        """The force as text; further equations stand behind semicolons. Members that are zero are left out.

        ``shown`` makes the text of a parameter, by the names of ``parameters()``; by default that is its name.
        """
        plain: Callable[[str], str] = shown or self._short
        ways = {one.of for one in self.dependences}

        def text(name: str) -> str:
            made = plain(name)
            for one in in_order(self.dependences, name):
                own = plain(one.name) if one.name else ""
                made = one.form.text.format(s=made, a=own, c=one.channel, c0=f"{one.reference:.4g}")
            return made.replace("- -", "+ ").replace("+ -", "- ") if name in ways else made

        there = {name for name, p in self.members.items() if p.value or p.std or name in ways}
        order = (3, 4, 0, 1, 2, 5)  # damping first, as in Eq. 17
        inner = [f"{text(INERTIA)} x''"] if INERTIA in there else []
        inner += [MEMBERS[i].in_words(text) for i in order if MEMBERS[i].parameters[0].name in there]
        further: list[str] = []
        for term in self.terms:
            first, *rest = term.law.in_words(lambda n, t=term: text(f"{t.effect}.{n}")).split("; ")
            inner.append(first)
            further += rest
        where = f"x counted from {self.origin:.6g} {self.unit}"
        return "; ".join(
            ["F = " + (" + ".join(inner).replace("+ -", "- ") or "0"), *further, *([where] if self.origin else [])]
        )

    def _short(self, name: str) -> str:
        effect, _, own = name.rpartition(".")
        if own == "coefficient":
            return effect
        return own if sum(other.rpartition(".")[2] == own for other in self.parameters()) == 1 else name


def grown(element: Element, law: Law, values: Mapping[str, float]) -> Element:
    """The element with one further law, its parameters given by name."""
    made: dict[str, Any] = {
        p.name: Parameter(float(values[p.name]), None, units.compose(template_of(p), element.unit, element.force_unit))
        for p in law.parameters
    }
    return replace(element, terms=(*element.terms, Term(law, made)))
