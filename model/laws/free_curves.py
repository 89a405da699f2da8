"""Curves that are learnt from the motion, as fine as it tells: a spring, a damping over the speed and over the place.

Each is made of hats, straight between knots that lie equally far apart over the reach of the recordings, integrated
once or twice: smooth, and a straight line or a constant one spacing beyond the last knot. What Eq. 17 has already, a
straight line through zero, of a spring a cubic besides, is in none of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..law import Expression, Law, LawParameter, Motion

#: Intervals of the knots between minus and plus the reach, from coarse to fine.
FINENESS = (6, 12)

#: The finer one of each.
_FINER = dict(pairwise(FINENESS))

_SOURCE = "splines by integrals of hats on equal knots (de Boor 1978, chapters 4 and 10)"
_CAUSE = "how it differs from Eq. 17 is known, its cause is not."


@dataclass(frozen=True)
class Curve:
    """Hats on equal knots, integrated from zero.

    Attributes:
        intervals: between minus and plus the reach.
        names: of the hats' heights, from minus the reach on; the last one may lack.
        times: how often the hats are integrated.
    """

    intervals: int
    names: Sequence[str]
    times: int

    def at(self, u: Expression, p: Mapping[str, Expression], more: int = 0) -> Expression:
        """The curve, or its ``more``-th integral from zero, at u, parts of the reach."""
        import casadi as ca

        step, order = 2.0 / self.intervals, self.times + more
        weights: dict[int, Expression] = {}
        for k, name in enumerate(self.names):
            for beside, weight in ((k - 1, 1.0), (k, -2.0), (k + 1, 1.0)):
                weights[beside] = weights.get(beside, 0.0) + weight * p[name] / (2.0 * step)
        total: Expression = 0.0
        for k, weight in weights.items():
            # |u - a| integrated n times is (u - a)^n |u - a| / (n + 1)!, less its own polynomial at u = 0
            place = step * k - 1.0
            side = 1.0 if place < 0.0 else -1.0
            own = [side * math.comb(order + 1, n) * (-place) ** (order + 1 - n) for n in range(order)]
            polynomial = sum(c * u**n for n, c in enumerate(own) if c)
            total += weight * ((u - place) ** order * ca.fabs(u - place) - polynomial) / math.factorial(order + 1)
        return total


def _heights(count: int, intervals: int, what: str, unit: str) -> tuple[LawParameter, ...]:
    return tuple(
        LawParameter(f"at-{k + 1}", unit, f"{what} at {2.0 * k / intervals - 1.0:+.2f} of the reach", strength=True)
        for k in range(count)
    )


def _names(count: int) -> list[str]:
    return [f"at-{k + 1}" for k in range(count)]


def _listed(count: int) -> str:
    return f"straight between {', '.join(f'{{{name}}}' for name in _names(count))}"


_REACH = LawParameter("reach", "X", "largest displacement of the recordings", 1e-12, probes=(1.0,), scale=True)
_SPEED = LawParameter("speed", "X/s", "largest speed of the recordings", 1e-12, probes=(1.0,), scale=True)


def spring(intervals: int) -> Law:
    """A spring over the displacement; where Eq. 17 has a cubic, that stands for the bend at the last knot."""
    curve = Curve(intervals, _names(intervals), 2)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["reach"] * curve.at(motion.x / p["reach"], p)

    def stored(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["reach"] ** 2 * curve.at(motion.x / p["reach"], p, more=1)

    return Law(
        name=f"free/spring/{intervals}",
        path="restoring",
        parameters=(*_heights(intervals, intervals, "change of stiffness over the reach", "1/s2"), _REACH),
        force=force,
        stored=stored,
        equation=f"f(x); f'' {_listed(intervals)}, over ±{{reach}}",
        sentence=f"A spring force of any smooth shape, learnt from the motion: {_CAUSE}",
        phrase="a spring force of a shape that no law of the library has",
        source=_SOURCE,
        curves="The backbone takes any smooth shape; with a stiffness that differs between the sides the middle of the "
        "motion moves with the amplitude.",
        learnt=True,
        finer=_finer("free/spring", intervals),
    )


def damping(intervals: int) -> Law:
    """A resistance over the velocity."""
    curve = Curve(intervals, _names(intervals + 1), 2)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["speed"] * curve.at(motion.v / p["speed"], p)

    return Law(
        name=f"free/damping/{intervals}",
        path="dissipation",
        parameters=(*_heights(intervals + 1, intervals, "change of damping over the reach", "1/s"), _SPEED),
        force=force,
        equation=f"g(x'); g'' {_listed(intervals + 1)}, over ±{{speed}}",
        sentence=f"A resistance of any smooth course over the velocity, learnt from the motion: {_CAUSE}",
        phrase="a resistance over the velocity that no law of the library has",
        source=_SOURCE,
        curves="The damping curve takes any smooth shape; the backbone stays.",
        learnt=True,
        finer=_finer("free/damping", intervals),
    )


def surface(intervals: int) -> Law:
    """A damping that depends on the displacement."""
    curve = Curve(intervals, _names(intervals + 1), 1)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return motion.v * curve.at(motion.x / p["reach"], p)

    return Law(
        name=f"free/surface/{intervals}",
        path="dissipation",
        parameters=(*_heights(intervals + 1, intervals, "slope of the damping", "1/s"), _REACH),
        force=force,
        equation=f"c(x) x'; c' {_listed(intervals + 1)}, over ±{{reach}}",
        sentence=f"A damping of any smooth course over the displacement, learnt from the motion: {_CAUSE}",
        phrase="a damping over the displacement that no law of the library has",
        source=_SOURCE,
        curves="The damping curve takes any smooth shape; the backbone stays.",
        learnt=True,
        finer=_finer("free/surface", intervals),
    )


def _finer(effect: str, intervals: int) -> str | None:
    return f"{effect}/{_FINER[intervals]}" if intervals in _FINER else None


def heights(values: Mapping[str, float]) -> list[float]:
    """Heights at twice as many knots of the same curve: a hat is a sum of narrower ones, on its knots and between."""
    given = [value for name, value in values.items() if name.startswith("at-")]
    whole = given if len(given) % 2 else [*given, 0.0]  # that of a spring lacks its last one
    finer = [whole[0]]
    for left, right in pairwise(whole):
        finer += [0.5 * (left + right), right]
    return finer if len(given) % 2 else finer[:-1]


LAWS: tuple[Law, ...] = tuple(kind(n) for kind in (spring, damping, surface) for n in FINENESS)
