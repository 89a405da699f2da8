"""Equation 17 (Feldman, Bucher and Rotberg 2009), integrated exactly up to rounding: the reference of the project.

mass (x'' + viscous x' + dry sgn x' + omega0² x + cubic x³ + preload sgn x) = F(t), in SI.
sgn is Coulomb's and Filippov's: at x' = 0 it takes whatever value in [-1, 1] holds the mass still, if any does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import mul
from typing import NamedTuple

import numpy as np

from .taylor import trajectory

ORDER = 12  # at 1 kHz and 20 Hz the first term left out is 1e-20 of the first


class Mode(NamedTuple):
    """The values that sgn x and sgn x' keep until the next event; way 0 means held still."""

    side: int
    way: int


class Slider:
    """The mass on its springs and friction, whose sgn terms switch; `push` is an external force per unit mass, m/s²."""

    def __init__(self, law: Mapping[str, float], dt: float) -> None:
        self.stiffness = float(law["omega0"]) ** 2
        self.cubic, self.preload, self.viscous, self.dry = (
            float(law[k]) for k in ("cubic", "preload", "viscous", "dry")
        )
        if self.preload < 0 or self.dry < 0:
            raise ValueError("preload and dry must not be negative: the motion at x = 0 or x' = 0 would not be unique")
        self.smallest = 1e-8 * (self.preload + self.dry) * dt**2  # m, see `cross`

    def spring(self, x: float) -> float:
        """Give the smooth part of the restoring force per unit mass, m/s²."""
        return self.stiffness * x + self.cubic * x**3

    def grip(self, x: float) -> float:
        """Give the largest push beyond the springs, m/s², that leaves the mass at rest at x."""
        limit = self.dry + (self.preload if x == 0.0 else 0.0)
        if limit == 0.0:
            return -1.0
        # A grain above rounding, so that the acceleration after break-away has a certain sign.
        return limit + 1e-12 * (limit + self.preload + abs(self.spring(x)))

    def start(self, x: float, v: float, push: float) -> Mode:
        """Give the mode of any state."""
        if v == 0.0:
            return self.rest(x, push)
        way = 1 if v > 0 else -1
        return Mode(_sign(x) or way, way)

    def rest(self, x: float, push: float) -> Mode:
        """Give the mode after v has become zero: held, or off in the direction of the net force."""
        net = push - self.spring(x) - self.preload * _sign(x)
        if abs(net) <= self.grip(x):
            return Mode(_sign(x), 0)
        way = _sign(net) or 1  # zero only without dry friction, where the way does not matter
        return Mode(_sign(x) or way, way)

    def cross(self, v: float, push: float) -> tuple[Mode, float]:
        """Give mode and velocity after x has become zero.

        With preload > dry the mass comes to rest at the origin after infinitely many crossings in a finite time
        (Zeno). Once the next excursion, v²/2 over the deceleration, is below `smallest` (1e-13 of the rig's peak,
        and the time that all further ones would take is 1e-3 of a step), the mass is put to rest.
        """
        hold = self.preload + self.dry - abs(push)
        if v == 0.0 or (hold > 0.0 and v * v <= 2.0 * hold * self.smallest):
            return self.rest(0.0, push), 0.0
        way = 1 if v > 0 else -1
        return Mode(way, way), v

    def constant(self, mode: Mode) -> float:
        """Give the acceleration by preload and dry friction in a mode, m/s²."""
        return -self.preload * mode.side - self.dry * mode.way

    def guards(self, mode: Mode, x: list[float], push: list[float]) -> list[tuple[str, int, list[float]]]:
        """Give what ends a mode: a zero of x or of v, or break-away."""
        if mode.way == 0:
            grip = self.grip(x[0])
            net = push[0] - self.spring(x[0]) - self.preload * mode.side
            down = [-v for v in push[1:]]
            return [("forward", 1, [grip - net, *down]), ("backward", 1, [grip + net, *push[1:]])]
        guards = []
        if self.preload:
            guards.append(("x", mode.side, x))
        if self.dry:
            guards.append(("v", mode.way, [k * x[k] for k in range(1, len(x))]))
        return guards

    def switch(self, mode: Mode, x: float, v: float, push: float, fired: str) -> tuple[Mode, float, float]:
        """Give mode, x and v after one of `guards` fired."""
        if fired == "x":
            mode, v = self.cross(v, push)
            return mode, 0.0, v
        if fired == "v":
            return self.rest(x, push), x, 0.0
        way = 1 if fired == "forward" else -1
        return Mode(_sign(x) or way, way), x, 0.0


class Oscillator:
    """Equation 17 as a system of `taylor`: one body, driven by the force."""

    def __init__(self, parameters: Mapping[str, float], dt: float) -> None:
        self.mass = float(parameters["mass"])
        self.slider = Slider(parameters, dt)

    def start(self, state: Sequence[float], force: float) -> Mode:
        """Give the mode of a state."""
        return self.slider.start(state[0], state[1], force / self.mass)

    def series(self, mode: Mode, state: Sequence[float], force: list[float], h: float) -> list[list[float]]:
        """Give the Taylor polynomial of x: each coefficient from those before, x² and x³ as Cauchy products."""
        if mode.way == 0:
            return [[state[0]] + [0.0] * ORDER]
        law = self.slider
        hh = h * h
        drive, damping, stiffness, cubic = hh / self.mass, law.viscous * h, law.stiffness * hh, law.cubic * hh
        known = len(force)
        x, square = [state[0], state[1] * h], []
        for k in range(ORDER - 1):
            back = x[k::-1]
            square.append(sum(map(mul, x, back)))
            term = -damping * (k + 1) * x[k + 1] - stiffness * x[k] - cubic * sum(map(mul, square, back))
            if k < known:
                term += drive * force[k]
            if k == 0:
                term += hh * law.constant(mode)
            x.append(term / ((k + 1) * (k + 2)))
        return [x]

    def guards(
        self, mode: Mode, series: list[list[float]], force: list[float], h: float
    ) -> list[tuple[str, int, list[float]]]:
        """Give what ends the mode."""
        return self.slider.guards(mode, series[0], [f / self.mass for f in force])

    def switch(self, mode: Mode, state: Sequence[float], force: float, fired: str) -> tuple[Mode, Sequence[float]]:
        """Give mode and state after an event."""
        mode, x, v = self.slider.switch(mode, state[0], state[1], force / self.mass, fired)
        return mode, (x, v)


def integrate(
    parameters: Mapping[str, float], force: np.ndarray, dt: float, x0: float = 0.0, v0: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate Equation 17 under a force that is linear between its samples (first-order hold).

    `parameters`: mass, omega0, cubic, preload, viscous, dry in SI; `force` (n,) N, `dt` s, `x0` m, `v0` m/s. Returns
    x (n,) m and v (n,) m/s at the samples. Raises ValueError for a negative preload or dry friction.
    """
    return integrate_pieces(parameters, linear_pieces(force), dt, x0, v0)


def integrate_pieces(
    parameters: Mapping[str, float], pieces: np.ndarray, dt: float, x0: float = 0.0, v0: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate Equation 17 under a force given as a polynomial for each step, (n - 1, terms); else as `integrate`."""
    states = trajectory(Oscillator(parameters, dt), pieces, dt, (float(x0), float(v0)))
    return states[:, 0], states[:, 1]


def linear_pieces(force: np.ndarray) -> np.ndarray:
    """Give the polynomials, (n - 1, 2), of a force (n,) that is linear between its samples."""
    force = np.asarray(force, dtype=float)
    return np.column_stack([force[:-1], np.diff(force)])


def _sign(value: float) -> int:
    return int(value > 0) - int(value < 0)  # a comparison of NumPy's gives no number
