"""Sizes of the effects of the surroundings: a spring that warms up, a machine next door."""

from __future__ import annotations

import numpy as np

from .base import Base, either_sign


def stiffness_drift(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """The stiffness changes by 2 to 8 % within the strong sweep, anew in each record: linearly or to a new value."""
    gain = strength * either_sign(rng, 0.02, 0.08)
    if variant == "linear":
        return {"drift_rate": gain / base.length}
    return {"drift_gain": gain, "drift_time": rng.uniform(0.2, 0.6) * base.length}


def tonal_disturbance(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A hum of 0.5 to 3 % of the spring force, in the band, away from its centre; each record has another phase."""
    ratio = rng.uniform(0.55, 0.8) if rng.uniform() < 0.5 else rng.uniform(1.25, 1.7)
    return {"tone": strength * rng.uniform(0.005, 0.03) * base.spring, "tone_omega": ratio * base.omega}
