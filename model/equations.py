"""The equation of motion as one CasADi expression, from which every rendering is made.

State-space form with modes: ``zdot = f(z, t, u, p, s)``, where ``s`` holds one sign per switching surface.
Between two events the signs are constant and the right-hand side is smooth, so that a high-order integrator
keeps its order (Filippov 1988 for what happens on a surface).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

from .law import Expression, Motion
from .laws import BASE

if TYPE_CHECKING:
    from .oscillator import Oscillator


class SurfaceKind(IntEnum):
    """How a switching surface meets the motion."""

    OTHER = 0
    POSITION = 1  # a function of x alone: crossed with the velocity unchanged
    VELOCITY = 2  # the velocity itself: the motion may stick there


@dataclass(frozen=True)
class Equations:
    """The expressions and their symbols (all casadi.SX, column vectors).

    Attributes:
        z: states: displacement, velocity.
        t: time, s.
        u: recorded force (or force per unit mass where the mass is null).
        u_rate: its time derivative.
        p: parameters, in the order of ``parameter_names``.
        s: signs of the surfaces.
        zdot: right-hand side.
        surfaces: switching functions g(z, t, u, p).
        surface_rates: dg/dt along the motion.
        y: outputs: response as recorded, displacement, velocity, acceleration.
        kinds: kind of each surface.
        parameter_names, state_names, output_names: in order.
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
    kinds: tuple[SurfaceKind, ...]
    parameter_names: tuple[str, ...]
    state_names: tuple[str, ...] = ("displacement", "velocity")
    output_names: tuple[str, ...] = ("x", "displacement", "velocity", "acceleration")


def equations(oscillator: Oscillator) -> Equations:
    """Assemble the laws of an oscillator; only its structure matters, the values stay symbols."""
    import casadi as ca

    z = ca.SX.sym("z", 2)
    t, u, u_rate = ca.SX.sym("t"), ca.SX.sym("u"), ca.SX.sym("u_rate")
    names = tuple(oscillator.parameters())
    p = ca.SX.sym("p", len(names))
    value = {name: p[i] for i, name in enumerate(names)}
    motion = Motion(x=z[0], v=z[1], t=t)

    inner = sum(law.force(motion, value) for law in BASE)
    for term in oscillator.terms:
        own = {name: value[f"{term.effect}.{name}"] for name in term.parameters}
        inner += term.law.force(motion, own)
    drive = u / value["mass"] if "mass" in value else u
    acceleration = drive - inner
    zdot = ca.vertcat(motion.v, acceleration)

    s = ca.vertcat(*motion.signs) if motion.signs else ca.SX(0, 1)
    g = ca.vertcat(*motion.surfaces) if motion.surfaces else ca.SX(0, 1)
    g_rate = ca.jtimes(g, z, zdot) + ca.jtimes(g, t, ca.SX(1)) + ca.jtimes(g, u, u_rate)
    recorded = {"displacement": z[0], "velocity": z[1], "acceleration": acceleration}
    y = ca.vertcat(recorded[oscillator.response.quantity], z[0], z[1], acceleration)
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
        kinds=tuple(_kind(surface, z, t, u) for surface in motion.surfaces),
        parameter_names=names,
    )


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
