"""Sizes of the dissipative effects: force at the peak speed of the working amplitude over the spring force there."""

from __future__ import annotations

import numpy as np

from .base import Base, either_sign

TOP = 2 / (3 * np.sqrt(3))  # largest cos² sin: the peak of x² v over its factors' peaks


def quadratic_drag(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Drag of a fluid, v|v|: 1.5 to 8 % of the spring force."""
    return {"drag": strength * rng.uniform(0.015, 0.08) * base.spring / base.speed**2}


def cubic_damping(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Damping with v³: 1.5 to 8 % of the spring force."""
    return {"cubic_damping": strength * rng.uniform(0.015, 0.08) * base.spring / base.speed**3}


def displacement_dependent(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Damping with x² v, as of a piston or a pole shoe: 1.5 to 8 % of the spring force at its peak."""
    peak = TOP * base.amplitude**2 * base.speed
    return {"x2_damping": strength * rng.uniform(0.015, 0.08) * base.spring / peak}


def stribeck(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Friction that falls with speed (Armstrong-Hélouvry 1994): 1 to 4 % more, gone at 2 to 15 % of the peak speed."""
    return {
        "stribeck_excess": strength * rng.uniform(0.01, 0.04) * base.spring,
        "stribeck_speed": rng.uniform(0.02, 0.15) * base.speed,
        "stribeck_power": 1.0 if variant == "exponential" else 2.0,
    }


def asymmetric(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Friction that differs between the directions by half a percent to 6 %; the base keeps it from driving the rig."""
    if variant == "dry":
        difference = either_sign(rng, 0.005, 0.02) * base.spring
        least = rng.uniform(1.1, 2.0) * abs(difference)
        return {"direction_dry": strength * difference, "dry": max(base.parameters["dry"], least)}
    difference = either_sign(rng, 0.01, 0.06) * base.omega
    least = rng.uniform(1.1, 2.0) * abs(difference)
    return {"direction_viscous": strength * difference, "viscous": max(base.parameters["viscous"], least)}
