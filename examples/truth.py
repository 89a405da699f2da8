"""The true parameters of the built-in stands: the paper's Equation 17 in SI (cubic: 0.46 x³ with x in mm)."""

from __future__ import annotations

from math import pi

TRUTH: dict[str, float] = {
    "mass": 0.27,  # kg
    "omega0": 2 * pi * 12.67,  # rad/s
    "cubic": 4.6e5,  # 1/(m2.s2)
    "preload": 0.02 / 0.27,  # m/s2
    "viscous": 5.0,  # 1/s
    "dry": 0.015,  # m/s2
}
