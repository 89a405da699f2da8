"""The base rig, drawn at random: x'' + viscous x' + dry sgn x' + omega0² x + cubic x³ + preload sgn x = F/m.

The ranges are those of test stands, suspensions and instruments on a shaker; shares are of the linear spring force at
the working amplitude.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

NICE = (
    1.0,
    1.2,
    1.25,
    1.4,
    1.5,
    1.6,
    1.8,
    2.0,
    2.2,
    2.5,
    2.8,
    3.0,
    3.2,
    3.6,
    4.0,
    4.5,
    5.0,
    5.6,
    6.0,
    7.0,
    7.5,
    8.0,
    9.0,
)
STRONGEST = 400.0  # m/s², about 40 g: more than that is no vibration test but a shock test


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform between those of `low` and `high`."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def either_sign(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number of either sign, uniform in size between `low` and `high`."""
    return float(rng.uniform(low, high) * rng.choice([-1.0, 1.0]))


def nice(value: float) -> float:
    """Give the number nearest to `value` that somebody would type in."""
    decade = 10.0 ** np.floor(np.log10(value))
    choices = np.array([*NICE, 10.0]) * decade
    return float(choices[np.argmin(np.abs(np.log(choices / value)))])


@dataclass(frozen=True)
class Base:
    """A base rig: its size, its parameters by the names of rig.h, and how it is recorded.

    `amplitude` m and `omega` rad/s are its working amplitude and natural frequency; `fs` Hz; `length` s, of the sweeps;
    `noise` m, standard deviation of the displacement sensor.
    """

    omega: float
    amplitude: float
    zeta: float
    parameters: dict[str, float]
    fs: float
    length: float
    noise: float

    @property
    def stiffness(self) -> float:
        """Stiffness per unit mass, 1/s²."""
        return self.omega**2

    @property
    def spring(self) -> float:
        """Linear spring force per unit mass at the working amplitude, m/s²."""
        return self.omega**2 * self.amplitude

    @property
    def speed(self) -> float:
        """Peak speed at the working amplitude, m/s."""
        return self.omega * self.amplitude


def draw_base(rng: np.random.Generator, cycles: tuple[float, float] = (300.0, 600.0)) -> Base:
    """Draw a base rig whose sweeps last as many natural cycles as drawn between those of `cycles`."""
    frequency = log_uniform(rng, 3.0, 60.0)
    omega = 2 * np.pi * frequency
    amplitude = min(log_uniform(rng, 0.5e-3, 20e-3), STRONGEST / omega**2)
    zeta = log_uniform(rng, 0.005, 0.04)
    spring = omega**2 * amplitude
    cubic, preload, dry = rng.uniform(-0.08, 0.30), rng.uniform(0.001, 0.02), rng.uniform(0.002, 0.02)
    absent = rng.uniform(size=3) < (0.1, 0.2, 0.2)
    per_cycle = rng.uniform(25.0, 40.0) if rng.uniform() < 0.08 else rng.uniform(40.0, 90.0)
    length = float(f"{rng.uniform(*cycles) / frequency:.2g}")
    parameters = {
        "mass": log_uniform(rng, 0.05, 20.0),
        "omega2": omega**2,
        "viscous": 2 * zeta * omega,
        "cubic": 0.0 if absent[0] else cubic * omega**2 / amplitude**2,
        "preload": 0.0 if absent[1] else preload * spring,
        "dry": 0.0 if absent[2] else dry * spring,
        "omega": omega,
        "amplitude": amplitude,
    }
    noise = log_uniform(rng, 0.001, 0.005) * amplitude
    return Base(omega, amplitude, zeta, parameters, nice(per_cycle * frequency), length, noise)
