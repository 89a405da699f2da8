"""The list of what can be concealed: name, path, variants, and the function that draws its sizes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import dissipation, environment, memory, restoring, transducers, unlisted, unwritten
from .base import Base

Draw = Callable[[np.random.Generator, Base, str, float], dict[str, float]]
#: Drawn as parts of the peak force of the strongest sweep.
PARTS_OF_FORCE = ("dead_zone", "hard_limit", "smooth_limit", "quadratic_level")
PHASES = {"tone": "tone_phase", "modulation": "modulation_phase"}  # drawn anew in each record
OF_THE_BASE = ("dry", "viscous")  # an effect may raise these; they stay where the effect is left out


@dataclass(frozen=True)
class Effect:
    """One effect: `draw(rng, base, variant, strength)` gives parameters of rig.h; strength 1 is nominal."""

    name: str
    path: str
    draw: Draw
    variants: tuple[str, ...] = ("",)


_LISTED = (
    Effect("quadratic-stiffness", "restoring", restoring.quadratic),
    Effect("quintic-stiffness", "restoring", restoring.quintic),
    Effect("softening-stiffness", "restoring", restoring.softening, ("tanh", "sine")),
    Effect("clearance", "restoring", restoring.clearance),
    Effect("one-sided-stop", "restoring", restoring.one_sided_stop, ("damped", "undamped")),
    Effect("two-sided-stop", "restoring", restoring.two_sided_stop, ("mirrored", "unequal")),
    Effect("constant-force", "restoring", restoring.constant_force),
    Effect("quadratic-drag", "dissipation", dissipation.quadratic_drag),
    Effect("cubic-damping", "dissipation", dissipation.cubic_damping),
    Effect("displacement-dependent-damping", "dissipation", dissipation.displacement_dependent),
    Effect("stribeck", "dissipation", dissipation.stribeck, ("exponential", "gaussian")),
    Effect("asymmetric-friction", "dissipation", dissipation.asymmetric, ("dry", "viscous")),
    Effect("hysteresis", "memory", memory.hysteresis, ("bouc-wen", "dahl", "jenkins")),
    Effect("viscoelastic", "memory", memory.viscoelastic),
    Effect("attached-resonator", "inertia", memory.resonator),
    Effect("actuator-lag", "excitation", transducers.actuator_lag),
    Effect("actuator-saturation", "excitation", transducers.actuator_saturation, ("hard", "smooth")),
    Effect("actuator-dead-zone", "excitation", transducers.actuator_dead_zone),
    Effect("actuator-backlash", "excitation", transducers.actuator_backlash),
    Effect("sensor-lag", "measurement", transducers.sensor_lag),
    Effect("sensor-nonlinearity", "measurement", transducers.sensor_nonlinearity, ("square", "cubic", "saturating")),
    Effect("sensor-offset", "measurement", transducers.sensor_offset),
    Effect("time-delay", "either", transducers.time_delay, ("input", "output")),
    Effect("stiffness-drift", "environment", environment.stiffness_drift, ("linear", "exponential")),
    Effect("tonal-disturbance", "environment", environment.tonal_disturbance),
)
EFFECTS = {effect.name: effect for effect in _LISTED}

_UNLISTED = (
    ("frequency-switched-damping", unlisted.frequency_switched_damping),
    ("parametric-modulation", unlisted.parametric_modulation),
    ("pendulum-absorber", unlisted.pendulum_absorber),
    ("rattling-mass", unlisted.rattling_mass),
    ("speed-dependent-stiffness", unlisted.speed_dependent_stiffness),
    ("inertia-nonlinearity", unlisted.inertia_nonlinearity),
    ("damping-drift", unlisted.damping_drift),
    ("friction-run-in", unlisted.friction_run_in),
    ("blow-off-valve", unlisted.blow_off_valve),
    ("internal-resonance", unlisted.internal_resonance),
    ("force-factor", unlisted.force_factor),
    ("sensor-play", unlisted.sensor_play),
    ("fractional-damping", unlisted.fractional_damping),
)
UNLISTED = {name: Effect(name, "open", draw) for name, draw in _UNLISTED}
#: Laws that are in no library, drawn at random: only what they depend on has a name.
UNWRITTEN = {
    effect.name: effect
    for effect in (
        Effect("unwritten-spring", "restoring", unwritten.spring),
        Effect("unwritten-resistance", "dissipation", unwritten.resistance),
        Effect("unwritten-damping-by-position", "dissipation", unwritten.damping_by_position),
    )
}
#: Laws that the library has had since the suite was settled: drawn where they are asked for, so that its rigs stay.
_LATER = (Effect("actuator-quadratic", "excitation", transducers.actuator_quadratic),)
LATER = {effect.name: effect for effect in _LATER}
SINGLE = EFFECTS | LATER
EVERYTHING = SINGLE | UNLISTED | UNWRITTEN


def twins(effects: tuple[str, ...], parameters: dict[str, float]) -> list[str]:
    """Name the other effects that give the very same equation, so that no recording can tell them apart.

    Dry friction that differs between the directions is a constant force beside ordinary friction; two mirrored springs
    behind a gap are undamped stops; on a rig that is linear but for damping an offset of the sensor is a static load.
    """
    names = []
    linear = parameters["cubic"] == 0.0 and parameters["preload"] == 0.0
    if parameters.get("direction_dry"):
        names.append("constant-force")
    if "constant-force" in effects:
        names.append("asymmetric-friction")
    if "clearance" in effects:
        names.append("two-sided-stop")
    if linear and "constant-force" in effects:
        names.append("sensor-offset")
    if linear and "sensor-offset" in effects:
        names += ["constant-force", "asymmetric-friction"]
    return names
