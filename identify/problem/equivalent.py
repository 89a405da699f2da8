"""The linear rig that a model is equivalent to at one amplitude: describing functions of Eq. 17 and of further laws."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np

from ...model.law import Law
from ...model.library import find
from ...simulate.along import Along
from ..signals.registry import numerics

_POINTS = numerics(256, "points a cycle", why="of the sine along which a law is evaluated")
_SETTLING = numerics(3, "cycles", why="in which its inner states settle before")


@cache
def along_of(law: Law) -> Along:
    """The law in C, built once."""
    return Along(law)


def equivalent(values: Mapping[str, float], amplitude: float, pace: float, time: float = 0.0) -> tuple[float, float]:
    """Stiffness (1/s²) and damping (1/s) per unit mass that a model shows a sine.

    Of Eq. 17 in closed form (Eqs. 6 and 7); of further laws the parts of their force in phase with displacement and
    velocity over a cycle of the sine (Krylov and Bogoliubov 1937).

    Args:
        values: of the model's parameters; those of laws as EFFECT.NAME.
        amplitude: of the displacement.
        pace: rad/s.
        time: s, for laws that change with time.
    """
    stiffness = values["omega0"] ** 2 + 0.75 * values["cubic"] * amplitude**2
    stiffness += 4 * values["preload"] / (np.pi * amplitude)
    damping = values["viscous"] + 4 * values["dry"] / (np.pi * pace * amplitude)
    laws: dict[str, dict[str, float]] = {}
    for key, value in values.items():
        effect, dot, name = key.rpartition(".")
        if dot:
            laws.setdefault(effect, {})[name] = value
    angle = 2 * np.pi * np.arange((_SETTLING + 1) * _POINTS + 1) / _POINTS
    displacement, velocity = amplitude * np.cos(angle), -amplitude * pace * np.sin(angle)
    motion = np.column_stack([displacement, velocity, np.full(angle.size, time), np.zeros(angle.size)])
    last = slice(_SETTLING * _POINTS, -1)
    for effect, own in laws.items():
        law = find(effect)
        if law.force is None or along_of(law).phases:  # a force that does not ask for the motion
            continue
        force = along_of(law).force(own, motion, float(angle[1]) / pace)
        if not np.all(np.isfinite(force)):
            continue
        stiffness += 2.0 * float(np.mean(force[last] * displacement[last])) / amplitude**2
        damping += 2.0 * float(np.mean(force[last] * velocity[last])) / (amplitude * pace) ** 2
    return stiffness, damping
