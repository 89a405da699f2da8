"""The event-exact step as a CasADi function: the same rules as engine/engine.c, for controllers and for Python.

Signs are not remembered between steps but read off the state: a surface value of exactly zero is a motion that is
just crossing (its direction decides) or that rests there. So the step is a plain function of state, force and
parameters. Filippov (1988) gives the rule for sticking, Dormand and Prince (1980) the formula between events.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from ..model.equations import Equations, Structure, SurfaceKind, equations_of, rates_feel_rest, structure_of
from ..model.law import Expression
from .runge_kutta import dormand_prince

if TYPE_CHECKING:
    from ..model import Oscillator

#: Events handled within one internal step. After them the state stays for what is left of it: a motion that switches so
#: often (bounces that follow each other ever faster) is all but at rest.
PHASES = 8
#: A crossing is passed by this part of an internal step, so that rounding does not leave the state before it: signs are
#: read off the state. (On the velocity surface the state is put exactly.)
BEYOND = 1e-10
#: A flight shorter than this part of an internal step ends at rest on its surface, as in the C engine.
REST = 0.01
_NEWTON = 7
_HALVINGS = 16
_SECANTS = 8


@dataclass(frozen=True)
class _Line:
    """Force within a step: ``start + rate * tau``; ``time`` at tau = 0."""

    start: Expression
    rate: Expression
    time: Expression

    def at(self, tau: Expression) -> Expression:
        return self.start + self.rate * tau


class _Stepper:
    """Builds the expressions of one internal step from the equations."""

    def __init__(self, eq: Equations, outputs: Expression = None) -> None:
        import casadi as ca

        self.ca = ca
        self.eq = eq
        arguments = [eq.z, eq.t, eq.u, eq.p, eq.s]
        self._field = ca.Function("field", arguments, [eq.zdot])
        rates = [eq.z, eq.t, eq.u, eq.u_rate, eq.p, eq.s]
        self._surface = ca.Function("surface", rates, [ca.densify(eq.surfaces), ca.densify(eq.surface_rates)])
        self._output = ca.Function("output", arguments, [eq.y if outputs is None else outputs])
        self._feels_rest = rates_feel_rest(eq)
        self.velocity = [i for i, kind in enumerate(eq.kinds) if kind is SurfaceKind.VELOCITY]
        self.positions = [i for i, kind in enumerate(eq.kinds) if kind is SurfaceKind.POSITION]
        self.others = [i for i, kind in enumerate(eq.kinds) if kind is SurfaceKind.OTHER]

    def surfaces(self, z, tau, line: _Line, p, s):
        return self._surface(z, line.time + tau, line.at(tau), line.rate, p, s)

    def raw_field(self, z, tau, line: _Line, p, s):
        return self._field(z, line.time + tau, line.at(tau), p, s)

    def field(self, z, tau, line: _Line, p, s, held):
        """Right-hand side; displacement and velocity stand still while the motion is held."""
        ca = self.ca
        f = self.raw_field(z, tau, line, p, self.shares(z, tau, line, p, s, held) if self._feels_rest else s)
        still = ca.vertcat(0, 0, *([1] * (z.numel() - 2)))
        return ca.if_else(held, f * still, f)

    def flow(self, z, tau, h, line: _Line, p, s, held):
        return dormand_prince(lambda state, at: self.field(state, at, line, p, s, held), z, tau, h)

    def balance(self, z, tau, line: _Line, p, s):
        """Acceleration without what can hold the motion, and how much can (negative: nothing)."""
        ca = self.ca
        g, _ = self.surfaces(z, tau, line, p, s)
        joined = [i in self.velocity or (i in self.positions and g[i] == 0) for i in range(s.numel())]
        free = ca.vertcat(*[s[i] * (1 - joined[i]) if i in self.positions else (0 if i in self.velocity else s[i])
                            for i in range(s.numel())])  # fmt: skip
        rest = self.raw_field(z, tau, line, p, free)[1]
        capacity = ca.SX(0)
        for i in [*self.velocity, *self.positions]:
            unit = ca.SX(free)
            unit[i] = 1
            part = rest - self.raw_field(z, tau, line, p, unit)[1]
            if i in self.velocity:
                capacity += part
            else:
                capacity += ca.if_else(g[i] == 0, ca.fmax(part, 0), 0)
        return rest, capacity

    def shares(self, z, tau, line: _Line, p, s, held):
        """Signs ``s``, and while the motion is held each surface's share of what balances the other forces."""
        ca = self.ca
        if not self.velocity:
            return s
        g, _ = self.surfaces(z, tau, line, p, s)
        rest, capacity = self.balance(z, tau, line, p, s)
        share = ca.fmax(-1, ca.fmin(1, rest / ca.if_else(capacity > 0, capacity, ca.inf)))
        s = ca.SX(s)
        for i in [*self.velocity, *self.positions]:
            carries = held if i in self.velocity else ca.logic_and(held, g[i] == 0)
            s[i] = ca.if_else(carries, share, s[i])
        return s

    def output(self, z, line: _Line, p):
        """Outputs with the signs that the state shows."""
        s, held = self.modes(z, self.ca.SX(0), line, p)
        return self._output(z, line.time, line.start, p, self.shares(z, self.ca.SX(0), line, p, s, held))

    def modes(self, z, tau, line: _Line, p):
        """Signs read off the state, and whether the motion is held."""
        ca = self.ca
        count = len(self.eq.kinds)
        zero = ca.SX.zeros(count)
        g, _ = self.surfaces(z, tau, line, p, zero)
        s = ca.vertcat(*[ca.sign(g[i]) for i in range(count)])
        _, rates = self.surfaces(z, tau, line, p, s)
        for i in self.positions:
            s[i] = ca.if_else(g[i] == 0, ca.sign(rates[i]), s[i])
        _, rates = self.surfaces(z, tau, line, p, s)
        for i in range(count):
            if i not in self.positions and i not in self.velocity:
                s[i] = ca.if_else(g[i] == 0, ca.if_else(rates[i] < 0, -1, 1), s[i])
        if not self.velocity:
            return s, ca.SX(0)
        rest, capacity = self.balance(z, tau, line, p, s)
        stopped = z[1] == 0
        held = ca.logic_and(stopped, ca.fabs(rest) <= capacity)
        way = ca.if_else(held, 0, ca.if_else(rest >= 0, 1, -1))
        for i in self.velocity:
            s[i] = ca.if_else(stopped, way, s[i])
        for i in self.positions:
            s[i] = ca.if_else(ca.logic_and(stopped, g[i] == 0), way, s[i])
        return s, held

    def crossing(self, m, g0, d0, g1, d1):
        """Part of the step at which a surface value first changes sides, and a point beyond; 2 where it does not."""
        ca = self.ca
        g0, d0, g1, d1 = m * g0, m * d0, m * g1, m * d1

        def cubic(x):
            y = 1 - x
            return g0 * (1 + 2 * x) * y * y + d0 * x * y * y + g1 * x * x * (3 - 2 * x) - d1 * x * x * y

        a, b = 6 * (g0 - g1) + 3 * (d0 + d1), -6 * (g0 - g1) - 4 * d0 - 2 * d1
        disc = b * b - 4 * a * d0
        q = -0.5 * (b + ca.if_else(b < 0, -1, 1) * ca.sqrt(ca.fmax(disc, 0)))
        first = ca.if_else(a != 0, q / ca.if_else(a != 0, a, 1), 2)
        second = ca.if_else(q != 0, d0 / ca.if_else(q != 0, q, 1), 2)
        dip = ca.if_else(ca.logic_and(first > 0, first < 1), first, 2)
        dip = ca.if_else(ca.logic_and(second > 0, second < dip), second, dip)
        left_it = g0 == 0  # a negative slope is then rounding
        may = ca.logic_and(ca.logic_and(d0 < 0, ca.logic_not(left_it)), ca.logic_or(d1 > 0, g1 < 0))
        dips = ca.logic_and(ca.logic_and(may, disc > 0), ca.logic_and(dip < 1, cubic(dip) < 0))
        top = ca.if_else(dips, dip, 1)
        lo, hi = ca.SX(0), top
        for _ in range(_HALVINGS):
            middle = 0.5 * (lo + hi)
            below = cubic(middle) < 0
            lo, hi = ca.if_else(below, lo, middle), ca.if_else(below, middle, hi)
        crosses = ca.logic_and(m != 0, ca.logic_or(dips, g1 < 0))
        return ca.if_else(crosses, 0.5 * (lo + hi), 2), top

    def attempt(self, z, tau, remaining, line: _Line, p):
        """The whole rest of an internal step at once: state at its end, and whether an event lies in it."""
        ca = self.ca
        s, held = self.modes(z, tau, line, p)
        end = self.flow(z, tau, remaining, line, p, s, held)
        best, _, _ = self._first(z, tau, remaining, line, p, s, held, end)
        rest, capacity = self.balance(end, tau + remaining, line, p, s) if self.velocity else (ca.SX(0), ca.SX(0))
        return end, ca.logic_or(ca.logic_and(held, ca.fabs(rest) > capacity), best < 2)

    def _first(self, z, tau, remaining, line: _Line, p, s, held, end):
        """The first crossing between z and end: place (2: none), a point beyond it, and which surface (0 or 1 each)."""
        ca = self.ca
        best, top, chosen = ca.SX(2), ca.SX(1), ca.SX(-1)
        g0, d0 = self.surfaces(z, tau, line, p, s)
        g1, d1 = self.surfaces(end, tau + remaining, line, p, s)
        for i in range(s.numel()):
            place, beyond = self.crossing(s[i], g0[i], ca.if_else(held, 0, d0[i]) * remaining, g1[i], d1[i] * remaining)
            first = place < best
            best, top = ca.if_else(first, place, best), ca.if_else(first, beyond, top)
            chosen = ca.if_else(first, i, chosen)
        return best, top, ca.vertcat(*[chosen == i for i in range(s.numel())])

    def to_event(self, z, tau, remaining, h, line: _Line, p):
        """From (z, tau) to the event that ``attempt`` saw: the state there and the part of ``remaining`` it used."""
        ca = self.ca
        s, held = self.modes(z, tau, line, p)
        end = self.flow(z, tau, remaining, line, p, s, held)
        best, top, pick = self._first(z, tau, remaining, line, p, s, held, end)
        side = ca.dot(pick, s)
        x, lo, hi = ca.fmin(best, 1), ca.SX(0), top
        for _ in range(_NEWTON):  # Newton on the flow, inside a bracket that moves
            state = self.flow(z, tau, x * remaining, line, p, s, held)
            g, d = self.surfaces(state, tau + x * remaining, line, p, s)
            value, rate = ca.dot(pick, g), ca.dot(pick, d) * remaining
            over = value * side < 0
            lo, hi = ca.if_else(over, lo, x), ca.if_else(over, x, hi)
            newton = x - value / ca.if_else(rate != 0, rate, 1)
            inside = ca.logic_and(rate != 0, ca.logic_and(newton >= lo, newton <= hi))
            x = ca.if_else(value == 0, x, ca.if_else(inside, newton, 0.5 * (lo + hi)))
        if self.others:
            other = sum(pick[i] for i in self.others)
            x = ca.if_else(other, ca.fmin(1, x + BEYOND * h / remaining), x)
        state = self.flow(z, tau, x * remaining, line, p, s, held)
        state = self._land(state, tau + x * remaining, h, line, p, s, pick)
        if not self.velocity:
            return state, x
        gone, where, breaks = self._break_away(z, tau, remaining, line, p, s, held)
        first = ca.logic_and(breaks, ca.logic_or(best >= 2, where <= x))
        return ca.if_else(first, gone, state), ca.if_else(first, where, x)

    def _land(self, z, tau, h, line: _Line, p, s, pick):
        """The state put on the surface that it reached; at rest where endlessly many flights would follow (Zeno)."""
        ca = self.ca
        x, v = z[0], z[1]
        g, d = self.surfaces(z, tau, line, p, s)
        for i in self.positions:
            x = ca.if_else(ca.logic_and(pick[i], d[i] != 0), x - g[i] * v / ca.if_else(d[i] != 0, d[i], 1), x)
        if self.positions:
            g, _ = self.surfaces(ca.vertcat(x, v, z[2:]), tau, line, p, s)
            before = sum(ca.logic_and(pick[i], s[i] * g[i] > 0) for i in self.positions)
            x = ca.if_else(before, x + BEYOND * h * v, x)
        for i in self.velocity:
            v = ca.if_else(pick[i], 0, v)
        landed = ca.vertcat(x, v, z[2:])
        if not (self.velocity and self.positions):
            return landed
        beyond, _ = self.modes(landed, tau, line, p)
        a = self.raw_field(landed, tau, line, p, beyond)[1]
        stopped = ca.vertcat(x, 0, z[2:])
        rest, capacity = self.balance(stopped, tau, line, p, beyond)
        on_position = sum(pick[i] for i in self.positions)
        short = ca.logic_and(a * v < 0, 2 * ca.fabs(v) <= REST * h * ca.fabs(a))
        ends = ca.logic_and(ca.logic_and(on_position, short), ca.fabs(rest) <= capacity)
        return ca.if_else(ends, stopped, landed)

    def _break_away(self, z, tau, remaining, line: _Line, p, s, held):
        """The state where within ``remaining`` forces exceed what holds the motion, that place, and whether they do."""
        ca = self.ca

        def excess(x):
            state = self.flow(z, tau, x * remaining, line, p, s, held)
            rest, capacity = self.balance(state, tau + x * remaining, line, p, s)
            return ca.fabs(rest) - capacity

        lo, hi = ca.SX(0), ca.SX(1)
        low, high = excess(lo), excess(hi)
        breaks = ca.logic_and(held, high > 0)
        for n in range(_SECANTS):
            span = ca.if_else(high > low, high - low, 1)
            x = 0.5 * (lo + hi) if n % 3 == 2 else lo - (hi - lo) * low / span
            x = ca.if_else(ca.logic_and(x > lo, x < hi), x, 0.5 * (lo + hi))
            value = excess(x)
            free = value >= 0
            hi, high = ca.if_else(free, x, hi), ca.if_else(free, value, high)
            lo, low = ca.if_else(free, lo, x), ca.if_else(free, low, value)
        return self.flow(z, tau, hi * remaining, line, p, s, held), hi, breaks


def exact_step(oscillator: Oscillator, dt: float, max_step: float, *, payload: bool = False) -> Expression:
    """Event-exact step ``x_next = step(x, u, p, t, dt)``.

    Args:
        oscillator: its structure and the parameters' identified values.
        dt: nominal step, s; the number of internal steps is fixed from it.
        max_step: longest internal step at the nominal ``dt``, s.
        payload: whether the last parameter is a further mass, by default none.

    Returns:
        casadi.Function. ``u`` is (2,): force at the start and at the end of the step, a straight line between them; a
        single number is held. ``p`` left out, or an element of it that is inf, takes the identified value
        (``with_defaults``); ``dt`` left out is the nominal step; ``t`` is the time at the start.
    """
    import casadi as ca

    structure = structure_of(oscillator, payload=payload)
    go, nz, np_ = _phase(structure), len(equations_of(structure).state_names), len(structure.parameters)
    x, force, given = ca.MX.sym("x", nz), ca.MX.sym("u", 2), ca.MX.sym("p", np_)
    clock, length = ca.MX.sym("t"), ca.MX.sym("dt")
    values = with_defaults(given, [*oscillator.values().values(), *([0.0] if structure.payload else [])])
    duration = ca.if_else(length > 0, length, dt)
    slope = (force[1] - force[0]) / duration
    count = max(1, math.ceil(dt / max_step - 1e-9))
    inner = duration / count
    current = x
    for n in range(count):
        at, rest = n * inner, inner
        for _ in range(PHASES):
            current, part = go(rest > 0, current, at, rest, inner, force[0], slope, clock, values)
            at, rest = at + part * rest, rest * (1 - part)
    inputs = [x, force, given, clock, length]
    return ca.Function("step", inputs, [current], ["x", "u", "p", "t", "dt"], ["x_next"])


@cache
def _phase(structure: Structure) -> Expression:
    """One phase of an internal step, up to its end or the next event: the same for every step of a structure.

    Returns:
        casadi.Function of whether there is anything left to do, state, time within the step, what is left of the
        internal step, its length, force and its slope, time, parameters; state and the part of ``remaining`` that was
        used.
    """
    import casadi as ca

    eq = equations_of(structure)
    stepper = _Stepper(eq)
    nz, np_ = eq.z.numel(), eq.p.numel()
    z, p = ca.SX.sym("z", nz), ca.SX.sym("p", np_)
    tau, remaining, h = ca.SX.sym("tau"), ca.SX.sym("left"), ca.SX.sym("h")
    start, rate, time = ca.SX.sym("start"), ca.SX.sym("rate"), ca.SX.sym("time")
    line = _Line(start, rate, time)
    arguments = [z, tau, remaining, h, start, rate, time, p]
    # Three levels, so that a step without an event costs one evaluation: done, straight on, up to the event.
    done = ca.Function("done", arguments, [z, ca.SX(1)])
    state, event = stepper.attempt(z, tau, remaining, line, p)
    if eq.kinds:
        attempt = ca.Function("attempt", arguments, [state, event])
        to_event = ca.Function("to_event", arguments, list(stepper.to_event(z, tau, remaining, h, line, p)))
        straight = ca.Function("straight", [state_in := ca.SX.sym("end", nz), *arguments], [state_in, ca.SX(1)])
        located = ca.Function("located", [ca.SX.sym("end", nz), *arguments], to_event.call(arguments))
        resolve = ca.Function.if_else("resolve", located, straight)
        symbols = [ca.MX.sym(f"a{i}", *argument.shape) for i, argument in enumerate(arguments)]
        end, flag = attempt.call(symbols)
        phase = ca.Function("phase", symbols, list(resolve(flag, end, *symbols)))
    else:
        phase = ca.Function("phase", arguments, [state, ca.SX(1)])
    return ca.Function.if_else("go", phase, done)


def exact_field(eq: Equations, z: Expression, u: Expression, p: Expression, t: Expression) -> Expression:
    """Right-hand side with the signs that the state shows, sticking included."""
    import casadi as ca

    stepper = _Stepper(eq)
    line = _Line(u, ca.SX(0), t)
    s, held = stepper.modes(z, ca.SX(0), line, p)
    return stepper.field(z, ca.SX(0), line, p, s, held)


def exact_output(
    eq: Equations, z: Expression, u: Expression, p: Expression, t: Expression, outputs: Expression = None
) -> Expression:
    """Outputs with the signs that the state shows; at rest each surface carries its share of the forces.

    ``outputs`` is an expression of the symbols of ``eq``; None: ``eq.y``.
    """
    import casadi as ca

    return _Stepper(eq, outputs).output(z, _Line(u, ca.SX(0), t), p)


def with_defaults(given: Expression, identified: list[float]) -> Expression:
    """Parameters (n,) from those given: the identified values where all are zero or, one by one, where one is inf.

    Zeros are what CasADi itself puts where an input is left out, also in functions that it derives (``jacobian``,
    ``factory``, ``mapaccum``) and to which no default of ours passes on; no oscillator has nothing but zeros. There the
    derivative by p is that at the identified values.
    """
    import casadi as ca

    none = given[0] == 0
    for i in range(1, given.numel()):
        none = ca.logic_and(none, given[i] == 0)
    values = ca.DM(identified)
    return ca.if_else(none, values + given, ca.if_else(given < ca.inf, given, values))
