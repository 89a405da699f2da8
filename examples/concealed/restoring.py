"""Sizes of the restoring effects: share of the spring force at the working amplitude, onsets as parts of it."""

from __future__ import annotations

import numpy as np

from .base import Base, either_sign, log_uniform


def quadratic(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Asymmetric spring: x² makes 5 to 25 % of the spring force."""
    return {"quadratic": strength * either_sign(rng, 0.05, 0.25) * base.stiffness / base.amplitude}


def quintic(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A spring that stiffens late: x⁵ makes 5 to 25 % of the spring force."""
    return {"quintic": strength * rng.uniform(0.05, 0.25) * base.stiffness / base.amplitude**4}


def softening(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A second spring that saturates (tanh) or bends over (sine, as a pendulum or a magnet); 5 to 20 % of the force."""
    force = strength * rng.uniform(0.05, 0.20) * base.spring
    if variant == "tanh":
        length = rng.uniform(0.3, 0.8) * base.amplitude
        return {"tanh_stiffness": force / length, "tanh_length": length}
    length = base.amplitude / rng.uniform(1.2, 2.6)
    return {"sine_stiffness": force / length, "sine_length": length}


def clearance(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A second spring behind a gap of 30 to 75 % of the amplitude, with 5 to 25 % of the force at full amplitude."""
    gap = rng.uniform(0.3, 0.75) * base.amplitude
    stiffness = rng.uniform(0.05, 0.25) * base.spring / (base.amplitude - gap)
    return {"clearance_gap": gap, "clearance_stiffness": strength * stiffness}


def _stop(rng: np.random.Generator, base: Base, damped: bool, strength: float) -> tuple[float, float, float]:
    """Position, stiffness and damping of one stop: 15 to 150 % of the spring force at full amplitude."""
    at = rng.uniform(0.3, 0.75) * base.amplitude
    stiffness = log_uniform(rng, 0.15, 1.5) * base.spring / (base.amplitude - at)
    ratio = rng.uniform(0.05, 0.3)
    return at, strength * stiffness, strength * 2 * ratio * np.sqrt(stiffness) if damped else 0.0


def one_sided_stop(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A bump stop on one side, drawn; with contact damping or without."""
    at, stiffness, damping = _stop(rng, base, variant == "damped", strength)
    name = rng.choice(["up", "down"])
    return {f"{name}_at": at, f"{name}_stiffness": stiffness, f"{name}_damping": damping}


def two_sided_stop(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Stops on both sides: mirrored and damped, or the second 5 to 30 % farther away, half of these damped."""
    unequal = variant == "unequal"
    at, stiffness, damping = _stop(rng, base, not unequal or rng.uniform() < 0.5, strength)
    farther = rng.uniform(1.05, 1.3) if unequal else 1.0
    sides = rng.permutation(["up", "down"])
    parameters = {}
    for side, place in zip(sides, (at, at * farther), strict=True):
        parameters |= {f"{side}_at": place, f"{side}_stiffness": stiffness, f"{side}_damping": damping}
    return parameters


def constant_force(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A static load of 3 to 15 % of the spring force."""
    return {"static_load": strength * either_sign(rng, 0.03, 0.15) * base.spring}
