"""The equation of motion as one CasADi expression, from which every rendering is made.

State-space form with modes: ``zdot = f(z, t, u, p, s)``, where ``s`` holds one sign per switching surface.
Between two events the signs are constant and the right-hand side is smooth, so that a high-order integrator
keeps its order (Filippov 1988 for what happens on a surface).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from .dependence import Dependence, channels_of, strength_at
from .law import Expression, InnerState, Law, Motion
from .laws import BASE

if TYPE_CHECKING:
    from .element import Element
    from .oscillator import Oscillator


#: Structures whose equations are kept; a search goes through some hundred of them.
_KEPT = 512
#: Name of the mass beyond the identified one.
PAYLOAD = "payload"
#: Name of the displacement from which an element's laws count, and of what is recorded of it.
ORIGIN, FORCE = "origin", "force"


class SurfaceKind(IntEnum):
    """How a switching surface meets the motion."""

    OTHER = 0
    POSITION = 1  # a function of x alone: crossed with the velocity unchanged
    VELOCITY = 2  # the velocity itself: the motion may stick there


@dataclass(frozen=True)
class Equations:
    """The expressions and their symbols (all casadi.SX, column vectors).

    Attributes:
        z: states: displacement, velocity, then the laws' inner states.
        t: time, s.
        u: recorded force (or force per unit mass where the mass is null); of an element the acceleration.
        u_rate: its time derivative.
        p: parameters, in the order of ``parameter_names``.
        s: signs of the surfaces.
        zdot: right-hand side.
        surfaces: switching functions g(z, t, u, p).
        surface_rates: dg/dt along the motion.
        y: outputs: response as recorded, displacement, velocity, acceleration.
        drive: the force that reaches the mass, as ``u``; times the velocity it is the power put in.
        energy: kinetic energy and what the laws have stored, in ``Oscillator.energy_units``.
        dissipated: power that the laws take from the motion and do not store, in ``Oscillator.energy_units``; negative
            where a law gives more than it had stored (a drifting spring, a force that nobody recorded).
        kinds: kind of each surface.
        parameter_names, state_names, output_names: in order.
        inner: the inner states, in the order of ``z`` behind the first two.
        reaches: how far each of them goes, as an expression of p.
        recorded: which quantity the response is.
        payload: whether the last parameter is a mass beyond the identified one.
        moving: the mass that moves, in parts of that of Eq. 17: beyond 1 where a law's force is in proportion to the
            acceleration.
    """

    z: Expression
    t: Expression
    u: Expression
    u_rate: Expression
    p: Expression
    s: Expression
    zdot: Expression
    surfaces: Expression
    surface_rates: Expression
    y: Expression
    drive: Expression
    energy: Expression
    dissipated: Expression
    kinds: tuple[SurfaceKind, ...]
    parameter_names: tuple[str, ...]
    state_names: tuple[str, ...] = ("displacement", "velocity")
    output_names: tuple[str, ...] = ("x", "displacement", "velocity", "acceleration")
    inner: tuple[InnerState, ...] = ()
    reaches: Expression = None
    recorded: str = "displacement"
    payload: bool = False
    moving: Expression = 1.0

    @property
    def follows(self) -> tuple[int | None, ...]:
        """For each state the index of the one it is counted from at the start, or None."""
        places = {"displacement": 0, "velocity": 1}
        return (None, None, *(places.get(state.follows or "") for state in self.inner))

    def output(self, quantity: str) -> int:
        """Index in ``y`` of what a recording of a quantity shows; a sensor's laws are of the response alone."""
        return 0 if quantity == self.recorded else self.output_names.index(quantity)

    @property
    def free(self) -> tuple[bool, ...]:
        """For each state whether it has a value of its own even where the motion starts at rest."""
        return (False, False, *(state.free for state in self.inner))


@dataclass(frozen=True)
class Structure:
    """What the equations of an oscillator follow from: neither values nor units.

    Attributes:
        parameters: names, in the order of ``Oscillator.parameters()``.
        laws: of the terms beside Eq. 17, in their order; a law read again from a changed file is another one.
        recorded: what the recordings show: displacement, velocity or acceleration.
        payload: whether a further mass, ``payload``, is its last parameter; forces stay what they are.
        imposed: whether the motion is given and the force is the response, as of an ``Element``.
        dependences: of strengths on channels, whose values are the last parameters; without numbers of their own.
    """

    parameters: tuple[str, ...]
    laws: tuple[Law, ...] = field(hash=False)
    recorded: str
    payload: bool = False
    imposed: bool = False
    dependences: tuple[Dependence, ...] = ()


#: What the parameter of a channel's value is called: this and its name, which may be that of a member.
CHANNEL = "channel."


def structure_of(oscillator: Oscillator | Element, *, payload: bool = False) -> Structure:
    """The structure of an oscillator, by which what is made of its equations alone is kept.

    Without a mass there is none to add to, and ``payload`` is ignored. Of an element the last parameters are the origin
    of its displacement and the values of its channels.
    """
    from .element import Element  # which stands on the oscillator

    laws = tuple(term.law for term in oscillator.terms)
    if isinstance(oscillator, Element):
        ways = tuple(replace(one, parameter=None) for one in oscillator.dependences)
        channels = [f"{CHANNEL}{name}" for name in channels_of(ways)]
        return Structure((*oscillator.parameters(), ORIGIN, *channels), laws, FORCE, imposed=True, dependences=ways)
    loaded = payload and oscillator.mass is not None
    names = (*oscillator.parameters(), *((PAYLOAD,) if loaded else ()))
    return Structure(names, laws, oscillator.response.quantity, loaded)


def equations(oscillator: Oscillator | Element, *, payload: bool = False) -> Equations:
    """The laws of an oscillator assembled; only its structure matters, the values stay symbols.

    Oscillators of one structure share one value: an export or a fit asks for it dozens of times.
    """
    return equations_of(structure_of(oscillator, payload=payload))


@lru_cache(maxsize=_KEPT)
def equations_of(structure: Structure) -> Equations:
    """The same from the structure alone."""
    import casadi as ca

    from .element import INERTIA, MEMBERS  # which stands on the oscillator

    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    t, u, u_rate = ca.SX.sym("t"), ca.SX.sym("u"), ca.SX.sym("u_rate")
    names = structure.parameters
    p = ca.SX.sym("p", len(names))
    value = {name: p[i] for i, name in enumerate(names)}
    channels = {name: value[f"{CHANNEL}{name}"] for name in channels_of(structure.dependences)}
    ways = structure.dependences
    value |= {of: strength_at(ways, of, value[of], value, channels) for of in {one.of for one in ways}}
    shown = "displacement" if structure.imposed else structure.recorded
    a, sized = (u, value[INERTIA]) if structure.imposed else (ca.SX.sym("a"), 1.0)
    motion = Motion(x - value[ORIGIN] if structure.imposed else x, v, t, shown, a=a, mass=sized)
    terms = [(law, {q.name: value[f"{law.name}.{q.name}"] for q in law.parameters}) for law in structure.laws]
    taken: list[tuple[Expression, Expression]] = []  # the force of each law and what it has stored

    def ask(law: Law, own: Mapping[str, Expression], *signal: Expression) -> Expression:
        motion.owner = law.name
        made: Any = law.force or law.drive or law.record
        result = made(motion, own, *signal)
        if law.force:
            taken.append((result, _stored(law, motion, own)))
        return result

    drive = u
    for law, own in terms:
        if law.drive:
            drive = ask(law, own, drive)
    motion.force = drive
    inner = sum(ask(law, value) for law in (MEMBERS if structure.imposed else BASE))
    inner += sum(ask(law, own) for law, own in terms if law.force)
    moving = ca.SX(1)
    if not structure.imposed:
        inner, moving = _explicit(inner, a)
    if structure.imposed:  # the input is the acceleration of the motion that is given
        acceleration, inner = u, inner + value[INERTIA] * u
    elif structure.payload:  # the forces are those of the identified mass, whatever moves with it
        total = value["mass"] + value[PAYLOAD]
        part = value["mass"] / total
        acceleration = (drive / total - part * inner) / (1 + part * (moving - 1))
    else:
        acceleration = ((drive / value["mass"] if "mass" in value else drive) - inner) / moving
    recorded = {"displacement": x, "velocity": v, "acceleration": acceleration, FORCE: inner}[structure.recorded]
    for law, own in terms:
        if law.record:
            recorded = ask(law, own, recorded)

    # in the order of the terms, whatever their paths: a model with one more term has its states at the end
    rank = [law.name for law in structure.laws]
    order = sorted(range(len(motion.owners)), key=lambda i: rank.index(motion.owners[i]))
    inner_states = [motion.states[i] for i in order]

    s = ca.vertcat(*motion.signs) if motion.signs else ca.SX(0, 1)
    g = ca.vertcat(*motion.surfaces) if motion.surfaces else ca.SX(0, 1)
    scalars = ca.vertcat(x, v, *(motion.symbols[i] for i in order))
    z = ca.SX.sym("z", scalars.numel())
    zdot = ca.vertcat(v, acceleration, *(motion.rates[i] for i in order))
    y = ca.vertcat(recorded, x, v, acceleration)

    mass = value.get("mass", 1.0)
    kinetic = value[INERTIA] if structure.imposed else 1
    forces, stored = (ca.vertcat(*column) for column in zip(*taken, strict=True))
    if not structure.imposed:
        forces = ca.substitute(forces, a, acceleration)
    storing = ca.jtimes(stored, ca.vertcat(scalars, t), ca.vertcat(zdot, 1))
    energy = mass * (kinetic * v**2 / 2 + ca.sum1(stored)) + (value[PAYLOAD] * v**2 / 2 if structure.payload else 0)
    dissipated = mass * ca.sum1(forces * v - storing)  # law by law, so that a spring cancels before anything is summed
    made = [zdot, g, y, drive, energy, dissipated, moving]
    zdot, g, y, drive, energy, dissipated, moving = ca.substitute(made, [scalars], [z])
    g_rate = ca.jtimes(g, z, zdot) + ca.jtimes(g, t, ca.SX(1)) + ca.jtimes(g, u, u_rate)
    return Equations(
        z=z,
        t=t,
        u=u,
        u_rate=u_rate,
        p=p,
        s=s,
        zdot=zdot,
        surfaces=g,
        surface_rates=g_rate,
        y=y,
        drive=drive,
        energy=energy,
        dissipated=dissipated,
        kinds=tuple(_kind(g[i], z, t, u) for i in range(g.numel())),
        parameter_names=names,
        state_names=("displacement", "velocity", *(f"{motion.owners[i]}.{motion.states[i].name}" for i in order)),
        inner=tuple(inner_states),
        reaches=ca.vertcat(ca.SX(0, 1), *(motion.reaches[i] for i in order)),
        recorded=structure.recorded,
        payload=structure.payload,
        moving=moving,
        output_names=(FORCE if structure.imposed else "x", "displacement", "velocity", "acceleration"),
    )


def _explicit(inner: Expression, a: Expression) -> tuple[Expression, Expression]:
    """The force per unit mass at no acceleration, and the mass that moves, in parts of that of Eq. 17.

    Raises BadInput where the force is not in proportion to the acceleration: the equation is then not explicit.
    """
    import casadi as ca

    if not ca.depends_on(inner, a):
        return inner, ca.SX(1)
    slope = ca.jacobian(inner, a)
    if ca.depends_on(slope, a):
        raise BadInput("a law's force is not in proportion to motion.a; write motion.a times what does not hold it")
    return ca.substitute(inner, a, ca.SX(0)), 1 + slope


def _stored(law: Law, motion: Motion, own: Mapping[str, Expression]) -> Expression:
    """Energy per unit mass that a law has stored, its force having been asked for just before."""
    import casadi as ca

    if law.stored is None:
        return ca.SX(0)
    asked = len(motion.signs), len(motion.states)
    energy = ca.SX(law.stored(motion, own))
    if (len(motion.signs), len(motion.states)) != asked:
        # it would add an event or a state to the motion, which has neither
        raise BadInput(
            f"what {law.name} has stored depends on a sign or state that its force does not have; "
            "use the force's own surfaces, and its states by motion.inner(name)"
        )
    return energy


def rates_feel_rest(eq: Equations) -> bool:
    """Whether, with the mass at rest, an inner state's rate depends on what each surface carries of the forces."""
    import casadi as ca

    if not eq.inner or not eq.kinds:
        return False
    at_rest = ca.substitute(eq.zdot[2:], eq.z[1], ca.SX(0))
    holding = [i for i, kind in enumerate(eq.kinds) if kind != SurfaceKind.OTHER]
    return any(ca.depends_on(at_rest, eq.s[i]) for i in holding)


def _kind(surface: Expression, z: Expression, t: Expression, u: Expression) -> SurfaceKind:
    import casadi as ca

    if ca.is_equal(surface, z[1], 10):
        return SurfaceKind.VELOCITY
    outside = ca.vertcat(z[1:], t, u)
    if ca.depends_on(surface, z[0]) and not ca.depends_on(surface, outside):
        return SurfaceKind.POSITION
    return SurfaceKind.OTHER


def signed(eq: Equations, expression: Expression, width: Expression | None = None) -> Expression:
    """``expression`` with its signs written out: ``sign(g)``, or ``tanh(g / width)`` where a width is given.

    Args:
        eq: the equations that ``expression`` belongs to.
        expression: any expression of their symbols.
        width: column vector of one smoothing width per surface, in the surface's unit.
    """
    import casadi as ca

    if not eq.kinds:
        return expression
    plain = ca.sign(eq.surfaces) if width is None else ca.tanh(eq.surfaces / width)
    return ca.substitute(expression, eq.s, plain)
