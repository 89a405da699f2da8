"""The force that an element takes along a motion that is given: a cubic spline, which the engine follows exactly.

The acceleration of a cubic spline runs in straight lines, and an engine of fifth order integrates it without an error.
So an element is run as an oscillator is, with the acceleration for its force and the force for its response.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..model.dependence import strength_at
from .core import core_of, longest_step
from .force import straight_lines

if TYPE_CHECKING:
    from ..model.element import Element


def spline_of(displacement: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """(n,) velocity and acceleration of the cubic spline through (n,) samples of a displacement, at these."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(dt * np.arange(displacement.size), displacement)
    time = spline.x
    return spline(time, 1), spline(time, 2)


def force_along(
    element: Element,
    displacement: np.ndarray,
    dt: float,
    *,
    start: float = 0.0,
    inner: Sequence[float] = (),
    channels: Mapping[str, np.ndarray | float] | None = None,
) -> np.ndarray:
    """(n,) force along a motion.

    Args:
        element: with its values.
        displacement: (n,) of its samples, n at least 4, in the element's unit.
        dt: sample interval, s.
        start: time of the first sample, s.
        inner: inner states at the first sample, beyond what they follow; zero where none are given.
        channels: by name, a number or (n,) each; one that is left out has its reference value.

    Returns:
        NaN from where a law runs away.

    Raises:
        BadInput: where the rates of the laws are no numbers.
    """
    ways, known = element.dependences, element.parameters()
    channels = {name: np.asarray(values, float) for name, values in (channels or {}).items()}
    if not ways:
        return _run(element, displacement, dt, start, inner)
    # a force is linear in its strengths: what each of those makes is known once, and then grows with its channel
    none = {one.of: replace(known[one.of], value=0.0) for one in ways}
    plain = replace(element, dependences=()).with_parameters(none)
    force = _run(plain, displacement, dt, start, inner)
    rest = force.copy()
    for of in {one.of for one in ways}:
        strength = np.asarray(strength_at(ways, of, known[of].value, element.values(), channels), float)
        most = float(np.max(np.abs(strength)))
        if most > 0.0:
            alone = plain.with_parameters({of: replace(known[of], value=most)})
            force += (_run(alone, displacement, dt, start, inner) - rest) * (strength / most)
    return force


def _run(element: Element, displacement: np.ndarray, dt: float, start: float, inner: Sequence[float]) -> np.ndarray:
    """(n,) force of an element that depends on no channel."""
    velocity, acceleration = spline_of(displacement, dt)
    core = core_of(element)
    values = np.array([*element.values().values(), element.origin])
    swing = max(float(np.max(np.abs(displacement - element.origin))), np.finfo(float).tiny)
    pace = pace_of(displacement, velocity)
    initial = np.zeros(core.states)
    initial[:2] = displacement[0], velocity[0]
    initial[2 : 2 + len(inner)] = inner
    step = longest_step(element, values.tolist(), swing, pace)
    return core.record(values, initial, straight_lines(acceleration, dt), displacement.size, dt, step, start=start)


def pace_of(displacement: np.ndarray, velocity: np.ndarray) -> float:
    """Angular frequency in rad/s at which a motion mostly goes: of a sine its own (Rice 1944)."""
    moved = float(np.std(displacement))
    return float(np.sqrt(np.mean(velocity**2))) / moved if moved > 0.0 else 1.0
