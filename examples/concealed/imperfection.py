"""What an imperfection of a laboratory is, and what the rows of the tables are told of a recording.

One row a kind, in `dirt_of_the_rig`, `dirt_of_the_force` and `dirt_of_the_record`. A size is a pure number; its range
is what laboratories have.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .base import Base
from .engine import Response
from .recordings import Plan


@dataclass(frozen=True)
class Scene:
    """One recording of one rig, to be made imperfect.

    `values` are the rig's parameters there; `full` what the sensor shows at the working amplitude, m or m/s². What
    `common` draws is the same in all recordings of the rig, what `own` draws is not.
    """

    base: Base
    plan: Plan
    values: dict[str, float]
    held_out: bool
    full: float
    common: np.random.Generator
    own: np.random.Generator

    @property
    def t(self) -> np.ndarray:
        """Time of each sample, s."""
        return np.arange(self.plan.samples) / self.base.fs

    @property
    def seconds(self) -> float:
        """How long it lasts, s."""
        return self.plan.samples / self.base.fs

    @property
    def resonant(self) -> float:
        """Force, N, of a sine that keeps the base at its working amplitude at resonance."""
        return self.values["mass"] * 2 * self.base.zeta * self.base.spring

    @property
    def accelerometer(self) -> bool:
        """Whether the sensor shows acceleration."""
        return bool(self.values.get("accelerometer"))


@dataclass(frozen=True)
class Imperfection:
    """One kind of imperfection: what it `does`, the range of its size, the reason for both, and one of three functions.

    `rig(scene, size)` gives parameters of rig.h; `rest(scene, size)` a force on the mass that nobody records,
    (samples,) N; `record(scene, size, response)` what is recorded, with force and shown of the same length. `own`
    are the effects whose law is this imperfection's own, so that naming them is no mistake. `needs` says where it
    can be: "force" where one is recorded, "release" where the rig is let go by hand only, "displacement",
    "acceleration" or "camera" by sensor.
    """

    name: str
    does: str
    low: float
    high: float
    reason: str
    own: tuple[str, ...] = ()
    needs: str = ""
    rig: Callable[[Scene, float], dict[str, float]] | None = None
    rest: Callable[[Scene, float], np.ndarray] | None = None
    record: Callable[[Scene, float, Response], Response] | None = None
