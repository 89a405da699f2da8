"""How large what is in an element becomes along a motion of the recorded size: surfaces, states, its steps."""

from __future__ import annotations

import math

import numpy as np

from ..errors import BadInput
from ..model import units
from ..model.dependence import Dependence
from ..model.element import Element
from ..model.equations import Equations
from ..simulate.core import core_of, longest_step
from ..simulate.force import straight_lines
from ..simulate.imposed import spline_of
from .smoothing import RELATIVE_WIDTH, MotionSize, Surface, texts, unit_of

#: Longest internal step, s, where the laws have no rates along a motion of the recorded size.
_STILL = 1e-3
#: Names of variables that are there in any export.
_TAKEN = ("displacement", "velocity", "acceleration", "F", "energy", "dissipated_power", "origin", "time", "max_step")
#: The sine that is looked at: cycles, points of each, and every which of them surfaces are looked at.
_CYCLES, _POINTS, _EVERY = 3, 400, 10


def values_of(element: Element) -> list[float]:
    """Plain values of all parameters of its equations; the last are the origin and the channels' references."""
    return [*element.values().values(), element.origin, *(one.reference for one in element.channels.values())]


def channel_words(element: Element) -> dict[str, tuple[Dependence, str]]:
    """The channels as exports have them, by a name that no parameter has: unit, reference, and what it is in words."""
    made = {}
    for name, one in element.channels.items():
        of = ", ".join(dict.fromkeys(other.of for other in element.dependences if other.channel == name))
        covered = f"recorded from {one.low:.6g} to {one.high:.6g} {one.unit}"
        words = f"{name.replace('_', ' ')}, on which {of} depends; {covered}, beyond which it is a guess"
        made[f"{name}_channel" if name in {*element.members, *_TAKEN} else name] = one, words
    return made


def state_units(element: Element, eq: Equations) -> list[str]:
    """Unit of each state: displacement, velocity, inner ones."""
    inner = [units.compose(state.unit, element.unit, element.force_unit) for state in eq.inner]
    return [element.unit, units.compose("X/s", element.unit), *inner]


def reach_of(element: Element) -> float:
    """Largest displacement from the origin that was recorded; 1 in its own unit where nobody says."""
    return 1.0 if element.amplitude is None else element.amplitude.max


def pace_of(element: Element) -> float:
    """Angular frequency, rad/s, of the fastest motion that was recorded: its speed over its amplitude."""
    if element.amplitude is None or element.speed is None or not element.amplitude.max > 0.0:
        return 2.0 * math.pi
    return max(element.speed.max / element.amplitude.max, 1e-9)


def max_step(element: Element) -> float:
    """Longest internal step, s."""
    try:
        return longest_step(element, values_of(element), reach_of(element), pace_of(element))
    except BadInput:
        return _STILL


def motion_size(element: Element, eq: Equations) -> MotionSize:
    """How large surfaces and states become along a sine of the recorded size and pace."""
    import casadi as ca

    reach, pace = reach_of(element), pace_of(element)
    values, core = np.array(values_of(element)), core_of(element)
    dt = 2.0 * math.pi / pace / _POINTS
    motion = element.origin + reach * np.sin(pace * dt * np.arange(_CYCLES * _POINTS))
    velocity, acceleration = spline_of(motion, dt)
    initial = np.zeros(core.states)
    initial[:2] = motion[0], velocity[0]
    force = straight_lines(acceleration, dt)
    states = core.record(values, initial, force, motion.size, dt, max_step(element), states=True)
    through = np.zeros(0)
    if eq.kinds:
        value = ca.Function("surfaces", [eq.z, eq.t, eq.u, eq.p], [eq.surfaces])
        each = np.array([np.array(value(z, 0.0, 0.0, values)).ravel() for z in states[::_EVERY]])
        through = np.maximum(np.max(np.abs(each), axis=0), np.finfo(float).tiny)
    acceleration_unit = units.compose("X/s2", element.unit)
    given = [*state_units(element, eq), "s", acceleration_unit]
    given += [*(p.unit for p in element.parameters().values()), element.unit]
    given += [one.unit for one in element.channels.values()]
    surfaces = [
        Surface(text, RELATIVE_WIDTH * float(size), unit_of(eq, eq.surfaces[i], given))
        for i, (text, size) in enumerate(zip(texts(eq, "a"), through, strict=True))
    ]
    reached = [float(size) for size in np.max(np.abs(states[:, 2:]), axis=0)]
    own = [size if math.isfinite(size) and size > 0.0 else 1.0 for size in reached]
    return MotionSize(tuple(surfaces), (reach, reach * pace, *own))
