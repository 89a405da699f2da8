"""What each member and each law makes of a prescribed motion: columns that the force is a sum of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..identify.problem.equivalent import along_of
from ..identify.signals.registry import numerics
from ..model.element import INERTIA
from ..model.law import Law
from .motion import Imposed

_PARTS = numerics(16, "steps a sample", why="of inner states: Heun's method then errs below any load cell's noise")


def of_members(motion: Imposed, names: Sequence[str], origin: float) -> np.ndarray:
    """(names, n) of members with a strength of one; ``load`` is one throughout."""
    x, v = motion.displacement - origin, motion.velocity
    known = {
        INERTIA: motion.acceleration,
        "stiffness": x,
        "cubic": x**3,
        "preload": np.sign(x),
        "viscous": v,
        "dry": np.sign(v),
        "load": np.ones(motion.n),
    }
    return np.array([known[name] for name in names]).reshape(len(names), motion.n)


def of_law(law: Law, values: Mapping[str, float], motion: Imposed, origin: float) -> np.ndarray:
    """(strengths, n) of a law whose other parameters have values by name, by each of its strengths; not finite where it
    fails.

    Inner states begin at what they follow. A contact is there, and pushes: only the first strength is not zero.
    """
    strengths = [p.name for p in law.parameters if p.strength]
    known = dict(values) | dict(zip(strengths, [1.0, *[0.0] * len(strengths)], strict=False))
    along = along_of(law)
    with np.errstate(all="ignore"):
        return along(known, motion.along(origin), motion.dt, parts=_PARTS if along.follows else None)
