"""Two FMUs coupled by a spring, a master of thirty lines: how the force between them is told decides what comes out.

The master reads both ends of the spring, sets both forces, lets both rigs step, and never iterates. A force that is
held is half a step late, which is negative damping; a slope, or slope and curvature, takes that away.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..rig_fmu import RigFmu

#: How a force between two points is told.
WAYS = ("held", "extrapolated", "slope", "curvature")
#: A force in N at a time, s, from displacement and velocity of the rig that it acts on.
Actuator = Callable[[float, float, float], float]


@dataclass(frozen=True)
class Rig:
    """One rig of the two: its payload, kg, its displacement at the start, m, and what else pushes it."""

    payload: float = 0.0
    x0: float = 0.0
    actuator: Actuator | None = None


def coupled(
    fmu: Path, rigs: Sequence[Rig], stiffness: float, *, way: str = "slope", step: float = 1e-3, seconds: float = 2.0
) -> np.ndarray:
    """Displacements (n, 2), m, at the points of communication.

    Args:
        fmu: of FMI 2, of the rig that both are.
        rigs: two.
        stiffness: of the spring between them, N/m.
        way: one of ``WAYS``; the actuators' forces are held in each.
        step: of communication, s.
        seconds: to simulate.
    """
    start = {"extrapolation": 1.0} if way == "extrapolated" else {}
    both = [RigFmu(fmu, payload=rig.payload, x0=rig.x0, **start) for rig in rigs]
    motion = np.zeros((round(seconds / step) + 1, 2))
    for k in range(len(motion)):
        x, v, a = np.array([rig.get("displacement", "velocity", "acceleration") for rig in both]).T
        motion[k] = x
        slopes = [rig.rates("displacement")[0] for rig in both]
        for i, (rig, one) in enumerate(zip(both, rigs, strict=True)):
            force = stiffness * (x[1 - i] - x[i])
            if one.actuator is not None:
                force += one.actuator(k * step, x[i], v[i])
            orders = {"slope": 1, "curvature": 2}.get(way, 0)
            told = [stiffness * (slopes[1 - i] - slopes[i]), stiffness * (a[1 - i] - a[i])]
            rig.push(force, *told[:orders])
        for rig in both:
            rig.step(step)
    for rig in both:
        rig.end()
    return motion
