"""Physics that is in no list of effects, so that the right answer is that something is left unexplained."""

from __future__ import annotations

import numpy as np

from .base import Base, log_uniform
from .dissipation import TOP


def frequency_switched_damping(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A controlled damper that adds 2 to 6 % of damping ratio once the vibration's frequency passes a threshold."""
    return {
        "switched_damping": strength * 2 * rng.uniform(0.02, 0.06) * base.omega,
        "switch_omega": rng.uniform(0.92, 1.08) * base.omega,
        "switch_width": rng.uniform(0.03, 0.08) * base.omega,
        "switch_memory": rng.uniform(5.0, 15.0) / base.omega,
    }


def parametric_modulation(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A stiffness that a slow shaft modulates by 3 to 12 %, with another phase in each record."""
    return {
        "modulation": strength * rng.uniform(0.03, 0.12),
        "modulation_omega": rng.uniform(0.15, 0.6) * base.omega,
    }


def pendulum_absorber(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A short tuned pendulum with 4 to 12 % of the mass, that swings through large angles."""
    return {
        "pendulum_mass": strength * rng.uniform(0.04, 0.12),
        "pendulum_length": rng.uniform(1.2, 3.0) * base.amplitude,
        "pendulum_omega": rng.uniform(0.85, 1.2) * base.omega,
        "pendulum_zeta": log_uniform(rng, 0.005, 0.02),
    }


def rattling_mass(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A loose part with 3 to 10 % of the mass that knocks about in a cage."""
    mass, omega, ratio = strength * rng.uniform(0.03, 0.10), rng.uniform(6.0, 12.0) * base.omega, rng.uniform(0.2, 0.5)
    return {
        "loose_mass": mass,
        "loose_gap": rng.uniform(0.1, 0.5) * base.amplitude,
        "loose_stiffness": mass * omega**2,
        "loose_damping": 2 * ratio * mass * omega,
    }


def speed_dependent_stiffness(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A spring that stiffens with speed, x v²: 5 to 25 % of the spring force at its peak."""
    peak = TOP * base.amplitude * base.speed**2
    return {"speed_stiffness": strength * rng.uniform(0.05, 0.25) * base.spring / peak}


def inertia_nonlinearity(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """10 to 35 % more mass moves at full amplitude (Crespo da Silva and Glynn 1978): (1 + a x²) x'' + a x v²."""
    return {"inertia": strength * rng.uniform(0.10, 0.35) / base.amplitude**2}


def damping_drift(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A viscous damping that doubles to quadruples within the strong sweep."""
    return {"damping_rate": strength * rng.uniform(1.0, 3.0) / base.length}


def friction_run_in(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A dry friction that builds up by 1 to 3 % of the spring force within each record."""
    return {
        "friction_gain": strength * rng.uniform(0.01, 0.03) * base.spring,
        "friction_time": rng.uniform(0.2, 0.5) * base.length,
    }


def blow_off_valve(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A damper that works only above 30 to 60 % of the peak speed."""
    return {
        "valve_damping": strength * 2 * rng.uniform(0.03, 0.08) * base.omega,
        "valve_speed": rng.uniform(0.3, 0.6) * base.speed,
    }


def internal_resonance(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A second mode near twice the natural frequency, driven by the square of x (Nayfeh and Mook 1979)."""
    return {
        "second_coupling": np.sqrt(strength * rng.uniform(0.05, 0.15)) * base.stiffness / base.amplitude,
        "second_omega": rng.uniform(1.85, 2.15) * base.omega,
        "second_zeta": log_uniform(rng, 0.005, 0.02),
    }


def force_factor(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A voice coil that loses 8 to 25 % of its force at full stroke (Klippel 2006)."""
    return {"force_factor": strength * rng.uniform(0.08, 0.25) / base.amplitude**2}


def sensor_play(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Play of 0.5 to 3 % of the amplitude in the linkage of the sensor."""
    return {"sensor_play": 1.0, "jenkins_reach": strength * rng.uniform(0.005, 0.03) * base.amplitude}


def fractional_damping(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """Five Maxwell branches over three decades, like a fractional derivative; together 10 to 30 % of the stiffness."""
    rates = np.geomspace(0.03, 30.0, 5) * base.omega
    weights = rates ** rng.uniform(0.3, 0.6)
    stiffness = strength * rng.uniform(0.10, 0.30) * base.stiffness * weights / weights.sum()
    branches = {f"maxwell_{i + 1}": float(value) for i, value in enumerate(stiffness)}
    return branches | {f"relaxation_{i + 1}": float(rate) for i, rate in enumerate(rates)}
