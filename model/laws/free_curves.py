"""Curves that are learnt from the motion, as fine as it tells: of spring, damping, mass, of the drive and the sensor.

Each is made of hats, straight between knots that lie equally far apart over the reach of the recordings, integrated
once or twice: smooth, and a straight line or a constant one spacing beyond the last knot. What Eq. 17 has already, a
straight line through zero, of a spring a cubic besides, is in none of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..law import Expression, Force, Law, LawParameter, Motion, Path, Stored

#: Intervals of the knots between minus and plus the reach, from coarse to fine.
FINENESS: tuple[int, ...] = (6, 12)

#: The finer one of each.
_FINER: dict[int, int] = dict(pairwise(FINENESS))


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
        """The curve, or its ``more``-th integral from zero, at u, parts of the reach; its derivative for -1."""
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


def _heights(curve: Curve, what: str, unit: str) -> tuple[LawParameter, ...]:
    places = (2.0 * k / curve.intervals - 1.0 for k in range(len(curve.names)))
    return tuple(
        LawParameter(name, unit, f"{what} at {place:+.2f} of the reach", strength=True)
        for name, place in zip(curve.names, places, strict=True)
    )


def _names(count: int) -> list[str]:
    return [f"at-{k + 1}" for k in range(count)]


_REACH = LawParameter("reach", "X", "largest displacement of the recordings", 1e-12, probes=(1.0,), scale=True)
_SPEED = LawParameter("speed", "X/s", "largest speed of the recordings", 1e-12, probes=(1.0,), scale=True)
_FORCE = LawParameter("force", "Q", "largest force of the recordings", 1e-12, probes=(1.0,), scale=True)
_SIGNAL = LawParameter("signal", "Y", "largest signal of the recordings", 1e-12, probes=(1.0,), scale=True)
#: What is said of every learnt damping.
_OF_DAMPING = "The damping curve takes any smooth shape; the backbone stays."
#: The least mass of a learnt one, in parts of that of Eq. 17: a mass is positive.
_LEAST_MASS = 0.1


def spring(intervals: int) -> Law:
    """A spring over the displacement; where Eq. 17 has a cubic, that stands for the bend at the last knot."""
    curve = Curve(intervals, _names(intervals), 2)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["reach"] * curve.at(motion.x / p["reach"], p)

    def stored(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["reach"] ** 2 * curve.at(motion.x / p["reach"], p, more=1)

    return _learnt(
        "free/spring",
        curve,
        (*_heights(curve, "change of stiffness over the reach", "1/s2"), _REACH),
        "restoring",
        force=force,
        stored=stored,
        equation="f(x); f''",
        what="a spring force of a shape",
        curves="The backbone takes any smooth shape; with a stiffness that differs between the sides the middle of the "
        "motion moves with the amplitude.",
    )


def damping(intervals: int) -> Law:
    """A resistance over the velocity."""
    curve = Curve(intervals, _names(intervals + 1), 2)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return p["speed"] * curve.at(motion.v / p["speed"], p)

    return _learnt(
        "free/damping",
        curve,
        (*_heights(curve, "change of damping over the reach", "1/s"), _SPEED),
        "dissipation",
        force=force,
        equation="g(x'); g''",
        what="a resistance over the velocity",
        curves=_OF_DAMPING,
    )


def surface(intervals: int) -> Law:
    """A damping that depends on the displacement."""
    curve = Curve(intervals, _names(intervals + 1), 1)

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return motion.v * curve.at(motion.x / p["reach"], p)

    return _learnt(
        "free/surface",
        curve,
        (*_heights(curve, "slope of the damping", "1/s"), _REACH),
        "dissipation",
        force=force,
        equation="c(x) x'; c'",
        what="a damping over the displacement",
        curves=_OF_DAMPING,
    )


def inertia(intervals: int) -> Law:
    """A mass over the displacement, m(x) x'' + m'(x) x'^2 / 2 by Lagrange: what it takes it gives back.

    Where heights would make the whole mass less than a tenth of that of Eq. 17 it is held there.
    """
    curve = Curve(intervals, _names(intervals + 1), 1)

    def mass(motion: Motion, p: Mapping[str, Expression]) -> tuple[Expression, Expression]:
        """Beyond that of Eq. 17, and its slope."""
        import casadi as ca

        u, least = motion.x / p["reach"], (_LEAST_MASS - 1.0) * motion.mass
        beyond = curve.at(u, p)
        return ca.fmax(beyond, least), (beyond > least) * curve.at(u, p, more=-1) / p["reach"]

    def force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        beyond, slope = mass(motion, p)
        return beyond * motion.a + slope * motion.v**2 / 2

    def stored(motion: Motion, p: Mapping[str, Expression]) -> Expression:
        return mass(motion, p)[0] * motion.v**2 / 2

    return _learnt(
        "free/inertia",
        curve,
        (*_heights(curve, "slope of the mass over the reach, in parts of the mass", "1"), _REACH),
        "inertia",
        force=force,
        stored=stored,
        equation="m(x) x'' + m'(x) x'² / 2; m'",
        what="a moving mass that depends on the displacement",
        curves="The backbone takes any smooth shape, bent as by a spring; along the resonance the force that is needed "
        "tells them apart.",
    )


def drive(intervals: int) -> Law:
    """A static map of the recorded force to the force that reaches the mass."""
    curve = Curve(intervals, _names(intervals + 1), 2)

    def arrives(motion: Motion, p: Mapping[str, Expression], force: Expression) -> Expression:
        return force + p["force"] * curve.at(force / p["force"], p)

    return _learnt(
        "free/drive",
        curve,
        (*_heights(curve, "bend of the map over the reach", "1"), _FORCE),
        "excitation",
        drive=arrives,
        equation="F → F + b(F); b''",
        what="a drive whose force is bent over the recorded one",
        curves="None in free decay; driven, the response grows with the recorded force as the map says.",
    )


def sensor(intervals: int) -> Law:
    """A static map of the motion to what the sensor shows."""
    curve = Curve(intervals, _names(intervals + 1), 2)

    def shown(motion: Motion, p: Mapping[str, Expression], signal: Expression) -> Expression:
        return signal + p["signal"] * curve.at(signal / p["signal"], p)

    return _learnt(
        "free/sensor",
        curve,
        (*_heights(curve, "bend of the map over the reach", "1"), _SIGNAL),
        "measurement",
        record=shown,
        equation="record r → r + b(r); b''",
        what="a sensor whose record is bent over the motion",
        curves="Amplitudes are shown bent while frequencies are right.",
    )


def _learnt(
    effect: str,
    curve: Curve,
    parameters: tuple[LawParameter, ...],
    path: str,
    *,
    force: Force | None = None,
    stored: Stored | None = None,
    drive: Path | None = None,
    record: Path | None = None,
    equation: str,
    what: str,
    curves: str,
) -> Law:
    """A curve as a law; ``what`` it is in a few words, the last parameter its reach."""
    finer = _FINER.get(curve.intervals)
    heights = ", ".join(f"{{{name}}}" for name in curve.names)
    return Law(
        name=f"{effect}/{curve.intervals}",
        path=path,
        parameters=parameters,
        force=force,
        stored=stored,
        drive=drive,
        record=record,
        equation=f"{equation} straight between {heights}, over ±{{{parameters[-1].name}}}",
        sentence=f"{what[0].upper()}{what[1:]} that no law of the library has, learnt from the motion: how it differs "
        "from Eq. 17 is known, its cause is not.",
        phrase=f"{what} that no law of the library has",
        source="splines by integrals of hats on equal knots (de Boor 1978, chapters 4 and 10)",
        curves=curves,
        learnt=True,
        finer=None if finer is None else f"{effect}/{finer}",
    )


def heights(values: Mapping[str, float]) -> list[float]:
    """Heights at twice as many knots of the same curve: a hat is a sum of narrower ones, on its knots and between."""
    given = [value for name, value in values.items() if name.startswith("at-")]
    whole = given if len(given) % 2 else [*given, 0.0]  # that of a spring lacks its last one
    finer = [whole[0]]
    for left, right in pairwise(whole):
        finer += [0.5 * (left + right), right]
    return finer if len(given) % 2 else finer[:-1]


LAWS: tuple[Law, ...] = tuple(kind(n) for kind in (spring, damping, surface, inertia, drive, sensor) for n in FINENESS)
