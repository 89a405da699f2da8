"""Sizes of the effects with a memory of their own: hysteresis, a viscoelastic branch, a second mode."""

from __future__ import annotations

import numpy as np

from .base import Base, log_uniform


def hysteresis(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Rate-independent hysteresis: yields at 10 to 50 % of the amplitude, with 2 to 8 % of the spring force.

    Bouc-Wen: z' = v - beta |v| |z|^(n-1) z - gamma v |z|^n (Wen 1976); Dahl (1968): z' = v - |v| z / reach; Jenkins
    (1922): a spring behind a slider.
    """
    reach = rng.uniform(0.1, 0.5) * base.amplitude
    stiffness = strength * rng.uniform(0.02, 0.08) * base.spring / reach
    if variant == "dahl":
        return {"dahl_stiffness": stiffness, "dahl_reach": reach}
    if variant == "jenkins":
        return {"jenkins_stiffness": stiffness, "jenkins_reach": reach}
    power = float(rng.choice([1.0, 1.5, 2.0]))
    part = rng.uniform(0.5, 0.9)
    loss = reach**-power
    return {
        "bouc_stiffness": stiffness,
        "bouc_beta": part * loss,
        "bouc_gamma": (1 - part) * loss,
        "bouc_power": power,
    }


def viscoelastic(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A Maxwell branch with 5 to 25 % of the stiffness that relaxes within 0.3 to 3 / omega0."""
    stiffness = strength * rng.uniform(0.05, 0.25) * base.stiffness
    return {"maxwell_1": stiffness, "relaxation_1": base.omega / log_uniform(rng, 0.3, 3.0)}


def resonator(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Something sprung on the mass: 2 to 15 % of it, tuned to 0.6 to 1.8 times the natural frequency."""
    return {
        "resonator_mass": strength * rng.uniform(0.02, 0.15),
        "resonator_omega": log_uniform(rng, 0.6, 1.8) * base.omega,
        "resonator_zeta": log_uniform(rng, 0.005, 0.03),
    }
