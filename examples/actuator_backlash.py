"""The paper's stand with the backlash that its actuator has (Section 5) and its Equation 17 leaves out.

The recorded force acts on the moving part of the voice coil, position y, which drives the main mass, position x,
through a joint with a gap of ±`half_gap`. Inside the gap the two parts move apart from each other; beyond it a contact
spring and a contact damper push, and never pull (Nordin and Gutman 2002, Section 2):

    (mass - moving_mass) x'' = contact - springs, preload, viscous and dry friction of Equation 17
          moving_mass    y'' = F(t) - guide_friction y' - contact
    contact = contact_stiffness (d - half_gap) + contact_damping d',   d = y - x > half_gap,   where positive

and likewise on the other side. With the gap closed and rigid, the two parts together are Equation 17.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import mul
from typing import NamedTuple

import numpy as np

from .oscillator import Mode, Slider
from .taylor import trajectory

ORDER = 20  # the contact resonates at 218 Hz


class Joined(NamedTuple):
    """The mode of the main mass and of the joint: 0 apart, ±1 pushing, ±2 still compressed but not pushing."""

    main: Mode
    contact: int


class Stand:
    """The stand with actuator backlash as a system of `taylor`: two bodies, the main mass and the coil."""

    def __init__(self, parameters: Mapping[str, float], actuator: Mapping[str, float], dt: float) -> None:
        mass, coil = parameters["mass"], actuator["moving_mass"]
        main = mass - coil
        share = mass / main
        self.main, self.coil = main, coil
        self.half_gap, self.stiffness = actuator["half_gap"], actuator["contact_stiffness"]
        self.damping, self.guide = actuator["contact_damping"], actuator["guide_friction"]
        law = {
            "omega0": parameters["omega0"] * share**0.5,
            "viscous": parameters["viscous"] * share - self.guide / main,
            **{k: parameters[k] * share for k in ("cubic", "preload", "dry")},
        }
        self.slider = Slider(law, dt)

    def start(self, state: Sequence[float], force: float) -> Joined:
        """Give the mode of a state whose parts are apart."""
        x, v, y, _ = state
        if abs(y - x) >= self.half_gap:
            raise ValueError("the parts must start apart: |y0 - x0| below half_gap")
        return Joined(self.slider.start(x, v, 0.0), 0)

    def series(self, mode: Joined, state: Sequence[float], force: list[float], h: float) -> list[list[float]]:
        """Give the Taylor polynomials of x and y, each coefficient from those before."""
        law, hh = self.slider, h * h
        pushing = mode.contact in (-1, 1)
        moves = mode.main.way != 0
        offset = mode.contact * self.half_gap
        viscous, stiffness, cubic = law.viscous * h, law.stiffness * hh, law.cubic * hh
        guide, damper = self.guide / h, self.damping / h
        x, square = [state[0], state[1] * h], []
        y = [state[2], state[3] * h]
        for k in range(ORDER - 1):
            contact = 0.0
            if pushing:
                contact = self.stiffness * (y[k] - x[k]) + damper * (k + 1) * (y[k + 1] - x[k + 1])
                if k == 0:
                    contact -= self.stiffness * offset
            step = (k + 1) * (k + 2)
            if moves:
                back = x[k::-1]
                square.append(sum(map(mul, x, back)))
                term = -viscous * (k + 1) * x[k + 1] - stiffness * x[k] - cubic * sum(map(mul, square, back))
                term += hh * contact / self.main
                if k == 0:
                    term += hh * law.constant(mode.main)
                x.append(term / step)
            else:
                x.append(0.0)
            drive = (force[k] if k < len(force) else 0.0) - contact - guide * (k + 1) * y[k + 1]
            y.append(hh * drive / (self.coil * step))
        return [x, y]

    def guards(
        self, mode: Joined, series: list[list[float]], force: list[float], h: float
    ) -> list[tuple[str, int, list[float]]]:
        """Give what ends the mode: of the main mass, and of the contact."""
        x, y = series
        apart = [b - a for a, b in zip(x, y, strict=True)]
        if mode.contact == 0:
            right = [self.half_gap - apart[0], *(-d for d in apart[1:])]
            left = [self.half_gap + apart[0], *apart[1:]]
            return [*self.slider.guards(mode.main, x, [0.0] * len(x)), ("right", 1, right), ("left", 1, left)]
        side = 1 if mode.contact > 0 else -1
        damper = self.damping / h
        # The last coefficient is dropped: the series of y' ends one term before that of y.
        law = [self.stiffness * apart[k] + damper * (k + 1) * apart[k + 1] for k in range(len(apart) - 1)]
        law[0] -= self.stiffness * side * self.half_gap
        # The same polynomial, and name, as in the free gap, with the other sign.
        opens = (
            "right" if side > 0 else "left",
            -1,
            [self.half_gap - side * apart[0], *(-side * d for d in apart[1:])],
        )
        if abs(mode.contact) == 1:
            main = self.slider.guards(mode.main, x, [c / self.main for c in law])
            # An undamped contact pushes until the gap opens, a damped one ceases before.
            return [*main, ("contact", side, law) if self.damping else opens]
        return [*self.slider.guards(mode.main, x, [0.0] * len(x)), ("contact", -side, law), opens]

    def switch(self, mode: Joined, state: Sequence[float], force: float, fired: str) -> tuple[Joined, Sequence[float]]:
        """Give mode and state after an event."""
        main, contact = mode
        x, v, y, w = state
        if fired == "contact":
            side = 1 if contact > 0 else -1
            contact = 2 * side if abs(contact) == 1 else side
        elif fired in ("right", "left"):
            contact = 0 if contact else (1 if fired == "right" else -1)
        else:
            push = 0.0
            if abs(contact) == 1:
                push = (self.stiffness * (y - x - contact * self.half_gap) + self.damping * (w - v)) / self.main
            main, x, v = self.slider.switch(main, x, v, push, fired)
        return Joined(main, contact), (x, v, y, w)


def integrate_with_backlash(
    parameters: Mapping[str, float],
    actuator: Mapping[str, float],
    pieces: np.ndarray,
    dt: float,
    state: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
) -> np.ndarray:
    """Integrate the stand with actuator backlash; give x, x', y, y' at the ends of the steps, (steps + 1, 4), in SI.

    `parameters` of Equation 17; `actuator`: moving_mass kg, half_gap m, contact_stiffness N/m, contact_damping N.s/m,
    guide_friction N.s/m. `pieces` (steps, terms) N as in `taylor.trajectory`; `state` begins with the parts apart.
    """
    return trajectory(Stand(parameters, actuator, dt), pieces, dt, state)
