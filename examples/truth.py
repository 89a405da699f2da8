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

# The joint between the voice coil and the mass, on the stand with backlash.
ACTUATOR: dict[str, float] = {
    "moving_mass": 0.03,  # kg, of the 0.27 kg: the coil and the lever that turns its rotation into translation
    "half_gap": 7.5e-5,  # m: a play of 0.15 mm, as of a lever on a pin that is not preloaded
    "contact_stiffness": 5e4,  # N/m: yields 20 µm at 1 N; with the two parts' reduced mass it resonates at 218 Hz
    "contact_damping": 20.0,  # N.s/m: 0.27 of critical, greased steel
    "guide_friction": 0.1,  # N.s/m, of the stand's 1.35 N.s/m
}
