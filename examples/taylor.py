"""Taylor-series integration of systems that are polynomial between switching surfaces.

Between two events the motion is the sum of its own Taylor series, whose coefficients follow from the equation of
motion by recurrence (Moore 1966; Corliss and Chang 1982). An event is the earliest root of a guard polynomial, found
by Descartes' rule in Bernstein form (Lane and Riesenfeld 1981), so that two crossings inside one step are not missed.
It shares no code and no method with the product, which judges itself against it.

Every polynomial is a list of coefficients, lowest first, in the dimensionless time s of the step at hand, 0 <= s <= 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from itertools import pairwise
from math import comb
from typing import Any, Protocol

import numpy as np

EVENTS_PER_STEP = 100_000  # a system that switches more often has a defect
TAIL = 1e-17  # the last two terms of a series, relative to its largest: below rounding


class System(Protocol):
    """What the integrator asks of a system; a mode names the polynomial law that holds until the next event."""

    def start(self, state: Sequence[float], force: float) -> Any:
        """Give the mode in which `state` = (position, velocity, position, ...) moves on under `force`."""
        ...

    def series(self, mode: Any, state: Sequence[float], force: list[float], h: float) -> list[list[float]]:
        """Give one polynomial for each position over a step of `h` seconds."""
        ...

    def guards(
        self, mode: Any, series: list[list[float]], force: list[float], h: float
    ) -> Iterable[tuple[str, int, list[float]]]:
        """Give (name, sign, polynomial): the mode holds while sign * polynomial > 0."""
        ...

    def switch(self, mode: Any, state: Sequence[float], force: float, fired: str) -> tuple[Any, Sequence[float]]:
        """Give the mode and the state (with what is zero set to exactly zero) after the guard `fired`."""
        ...


def trajectory(system: System, pieces: np.ndarray, dt: float, state: Sequence[float]) -> np.ndarray:
    """Integrate over consecutive steps of `dt` seconds.

    `pieces` (steps, terms) holds the force of each step as a polynomial in s. Returns the states at the
    ends of the steps, (steps + 1, 2 bodies): positions in m, velocities in m/s.
    Raises ArithmeticError when the events of a step do not end.
    """
    steps = np.asarray(pieces, dtype=float).tolist()
    mode = system.start(state, steps[0][0] if steps else 0.0)
    states = [tuple(state)]
    for force in steps:
        mode, state = _step(system, mode, state, force, dt)
        states.append(tuple(state))
    return np.array(states)


def _step(system: System, mode: Any, state: Sequence[float], force: list[float], h: float) -> tuple[Any, Any]:
    located = ""
    for _ in range(EVENTS_PER_STEP):
        series = system.series(mode, state, force, h)
        reach = _reach(series)
        part = h * reach
        near = force
        if reach < 1.0:
            series = [_stretch(c, reach) for c in series]
            near = _stretch(force, reach)
        end, fired = 1.0, ""
        for name, sign, guard in system.guards(mode, series, near, part):
            root = _leaves(guard, sign, starts_at_zero=name == located)
            if root is not None and root <= end:
                end, fired = root, name
        state = tuple(value for c in series for value in (_value(c, end), _slope(c, end) / part))
        if not fired and reach == 1.0:
            return mode, state
        done = reach * end
        force = _rest(force, done)
        h *= 1.0 - done
        located = fired
        if fired:
            mode, state = system.switch(mode, state, force[0], fired)
        if h <= 0.0:
            return mode, state
    raise ArithmeticError(f"more than {EVENTS_PER_STEP} events within one step; last at the guard {located!r}")


def _reach(series: list[list[float]]) -> float:
    """Give the fraction 2^-j of the step over which every series has converged to rounding."""
    reach = 1.0
    for c in series:
        largest = max(map(abs, c))
        a, b = abs(c[-1]) * reach ** (len(c) - 1), abs(c[-2]) * reach ** (len(c) - 2)
        while a + b > TAIL * largest:
            reach *= 0.5
            a *= 0.5 ** (len(c) - 1)
            b *= 0.5 ** (len(c) - 2)
            largest = max(abs(v) * reach**k for k, v in enumerate(c))
    return reach


def _stretch(c: list[float], factor: float) -> list[float]:
    return [v * factor**k for k, v in enumerate(c)]


def _rest(c: list[float], start: float) -> list[float]:
    """Give the polynomial on [start, 1] in a variable that again runs from 0 to 1."""
    c = list(c)
    for i in range(len(c) - 1):  # Horner's shift
        for k in range(len(c) - 2, i - 1, -1):
            c[k] += start * c[k + 1]
    return _stretch(c, 1.0 - start)


def _value(c: list[float], s: float) -> float:
    total = 0.0
    for v in reversed(c):
        total = total * s + v
    return total


def _slope(c: list[float], s: float) -> float:
    total = 0.0
    for k in range(len(c) - 1, 0, -1):
        total = total * s + k * c[k]
    return total


def _leaves(c: list[float], sign: int, starts_at_zero: bool) -> float | None:
    """Give the earliest s in [0, 1] at which sign * c stops being positive, not counting a zero it starts from."""
    first = 1 if starts_at_zero else 0
    while first < len(c) and c[first] == 0.0:
        first += 1
    if first:
        c = c[first:]  # divided by s: the same sign for s > 0, without the known root
    if not c:
        return None
    if sign * c[0] < 0.0:
        return 0.0
    if 2.0 * abs(c[0]) > sum(map(abs, c)):
        return None
    return first_root([sign * v for v in c])


def first_root(c: list[float]) -> float | None:
    """Give the earliest root in (0, 1] of a polynomial with c[0] > 0, or None.

    The number of sign changes of the Bernstein coefficients bounds the number of roots: none means none, one means
    exactly one; otherwise the interval is halved, the left half first (Lane and Riesenfeld 1981).
    """
    parts = [(0.0, 1.0, [sum(w * v for w, v in zip(row, c, strict=False)) for row in _bernstein(len(c) - 1)])]
    while parts:
        a, b, p = parts.pop()
        if p[0] <= 0.0:
            return a
        signs = [v > 0.0 for v in p if v != 0.0]
        changes = sum(u != v for u, v in pairwise(signs))
        if changes == 0:
            if p[-1] == 0.0:
                return b
        elif changes == 1 and p[-1] < 0.0:
            return _polish(c, a, b)
        elif b - a < 2.0**-50:
            if p[-1] <= 0.0:
                return b
        else:
            middle = 0.5 * (a + b)
            left, right = _halves(p)
            parts += [(middle, b, right), (a, middle, left)]
    return None


@cache
def _bernstein(n: int) -> list[list[float]]:
    return [[comb(j, i) / comb(n, i) for i in range(j + 1)] for j in range(n + 1)]


def _halves(p: list[float]) -> tuple[list[float], list[float]]:
    """Split a Bernstein form at its middle (de Casteljau)."""
    left, right = [], []
    while p:
        left.append(p[0])
        right.append(p[-1])
        p = [0.5 * (u + v) for u, v in pairwise(p)]
    return left, right[::-1]


def _polish(c: list[float], a: float, b: float) -> float:
    """Newton's method, kept inside the bracket [a, b] of the one root."""
    s = 0.5 * (a + b)
    for _ in range(100):
        value, slope = _value(c, s), _slope(c, s)
        if value > 0.0:
            a = s
        elif value < 0.0:
            b = s
        else:
            return s
        following = s - value / slope if slope else a
        if not a < following < b:
            following = 0.5 * (a + b)
        if following in (a, b, s):
            return s
        s = following
    return s
