"""What each member and each law makes of a prescribed motion: columns that the force is a sum of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..identify.problem.equivalent import along_of
from ..identify.signals.registry import numerics
from ..model.element import INERTIA
from ..model.law import Law
from .motion import Imposed

TURN = numerics(
    0.05, "of an inner state's own time", why="a step of it: Heun's method then errs below a load cell's noise"
)
SEARCHED = numerics(
    0.15, "of an inner state's own time", why="the same of what is only compared: by nine times as much"
)
_MOST = numerics(128, "steps a sample", why="what changes faster than that is told by no sample")
_FEWEST = numerics(4, "steps a sample", why="of inner states that hardly change")


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


def of_law(law: Law, values: Mapping[str, float], motion: Imposed, origin: float, turn: float = TURN) -> np.ndarray:
    """(strengths, n) of a law whose other parameters have values by name, by each of its strengths.

    Inner states begin at what they follow. A contact is there, and pushes: only the first strength is not zero. Not
    finite where the law fails, or is faster than any sample tells.
    """
    strengths = [p.name for p in law.parameters if p.strength]
    known = dict(values) | dict(zip(strengths, [1.0, *[0.0] * len(strengths)], strict=False))
    along, path = along_of(law), motion.along(origin)
    with np.errstate(all="ignore"):
        parts = along.rate(known, path) * motion.dt / turn
        if not parts <= _MOST:
            return np.full((len(strengths), motion.n), np.nan)
        return along(known, path, motion.dt, parts=max(int(np.ceil(parts)), _FEWEST) if along.follows else None)
