"""Sizes of the effects in actuator and sensor: lags by their phase at the natural frequency, limits by the peak force.

`dead_zone`, `hard_limit`, `smooth_limit` and `quadratic_level` are parts of the strong sweep's peak force; the caller
makes them newtons.
"""

from __future__ import annotations

import numpy as np

from .base import Base, either_sign, log_uniform


def _lag(rng: np.random.Generator, base: Base, strength: float) -> float:
    """Time, s, that turns the phase at the natural frequency by 2 to 10 degrees."""
    return strength * float(np.tan(np.radians(rng.uniform(2.0, 10.0)))) / base.omega


def actuator_lag(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """First-order lag between the recorded force and the mass."""
    return {"actuator_lag": _lag(rng, base, strength)}


def actuator_saturation(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Clipped at 50 to 85 % of the peak force, or bent like limit tanh(F/limit) with 0.7 to 1.5 of it."""
    if variant == "hard":
        return {"hard_limit": 1.0 - strength * (1.0 - rng.uniform(0.5, 0.85))}
    return {"smooth_limit": rng.uniform(0.7, 1.5) / np.sqrt(strength)}


def actuator_dead_zone(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """The first 5 to 20 % of the peak force do not arrive."""
    return {"dead_zone": strength * rng.uniform(0.05, 0.20)}


def actuator_quadratic(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A fifth to all of the force grows with its square; at the peak force nothing changes."""
    return {"quadratic_part": strength * rng.uniform(0.2, 1.0), "quadratic_level": 1.0}


def actuator_backlash(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """3 to 12 % of the moving mass are the actuator's and drive the rest through a gap of 0.5 to 3 % of the amplitude.

    On the contact's spring the actuator alone would bounce at 6 to 12 times the natural frequency, well damped.
    """
    mass, gap = rng.uniform(0.03, 0.12), strength * log_uniform(rng, 0.005, 0.03) * base.amplitude
    omega, ratio = rng.uniform(6.0, 12.0) * base.omega, rng.uniform(0.3, 0.6)
    return {
        "coil_mass": mass,
        "coil_gap": gap,
        "coil_stiffness": mass * omega**2,
        "coil_damping": 2 * ratio * mass * omega,
    }


def sensor_lag(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """First-order lag between the mass and the record."""
    return {"sensor_lag": _lag(rng, base, strength)}


def sensor_nonlinearity(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A characteristic that is off by 2 to 8 % at the working amplitude: square, cubic or saturating."""
    if variant == "square":
        return {"sensor_square": strength * either_sign(rng, 0.02, 0.08) / base.amplitude}
    if variant == "cubic":
        return {"sensor_cube": strength * either_sign(rng, 0.02, 0.08) / base.amplitude**2}
    return {"sensor_length": base.amplitude / np.sqrt(3 * strength * rng.uniform(0.02, 0.08))}


def sensor_offset(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A zero that is off by 1 to 6 % of the amplitude."""
    return {"sensor_offset": strength * either_sign(rng, 0.01, 0.06) * base.amplitude}


def time_delay(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A dead time of 2 to 10 degrees at the natural frequency, before the mass or after it."""
    delay = strength * float(np.radians(rng.uniform(2.0, 10.0))) / base.omega
    return {"input_delay" if variant == "input" else "output_delay": delay}
