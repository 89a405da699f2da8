"""Imperfections of the rig itself, as parameters of its equation of motion, and of the clocks by which it is seen."""

from __future__ import annotations

from .imperfection import Imperfection, Scene


def _side(scene: Scene) -> float:
    return float(scene.common.choice([-1.0, 1.0]))


def _second_mode(scene: Scene, size: float) -> dict[str, float]:
    ratio, zeta = scene.common.uniform(4.0, 9.0), scene.common.uniform(0.005, 0.02)
    return {"resonator_mass": size, "resonator_omega": ratio * scene.base.omega, "resonator_zeta": zeta}


def _breathing(scene: Scene, size: float) -> dict[str, float]:
    omega = scene.common.uniform(0.02, 0.15) * scene.base.omega
    return {"modulation": size, "modulation_omega": omega, "modulation_phase": scene.own.uniform(0.0, 6.28)}


def _moving_mass(scene: Scene, size: float) -> dict[str, float]:
    return {"inertia": size / scene.base.amplitude**2}


def _presliding(scene: Scene, size: float) -> dict[str, float]:
    reach = scene.common.uniform(0.01, 0.05) * scene.base.amplitude
    return {"dahl_stiffness": size * scene.base.spring / reach, "dahl_reach": reach}


def _warming_spring(scene: Scene, size: float) -> dict[str, float]:
    return {"drift_gain": -size, "drift_time": scene.common.uniform(0.2, 0.6) * scene.base.length}


def _run_in(scene: Scene, size: float) -> dict[str, float]:
    time = scene.common.uniform(0.1, 0.5) * scene.base.length
    return {"friction_gain": size * scene.base.spring, "friction_time": time}


def _air(scene: Scene, size: float) -> dict[str, float]:
    return {"drag": size * scene.base.spring / scene.base.speed**2}


def _sagging(scene: Scene, size: float) -> dict[str, float]:
    return {"quadratic": _side(scene) * size * scene.base.stiffness / scene.base.amplitude}


def _creep(scene: Scene, size: float) -> dict[str, float]:
    relaxation = scene.common.uniform(0.01, 0.1) * scene.base.omega
    return {"maxwell_1": size * scene.base.stiffness, "relaxation_1": relaxation}


def _warming_damper(scene: Scene, size: float) -> dict[str, float]:
    return {"damping_rate": -size / max(scene.base.length, scene.seconds)}


def _force_factor(scene: Scene, size: float) -> dict[str, float]:
    return {"force_factor": size / scene.base.amplitude**2}


def _remounted(scene: Scene, size: float) -> dict[str, float]:
    stiffness, damping = scene.own.uniform(-1.0, 1.0, 2)
    return {
        "omega2": scene.values["omega2"] * (1.0 + size * stiffness),
        "viscous": scene.values["viscous"] * (1.0 + 10.0 * size * damping),
    }


def _play(scene: Scene, size: float) -> dict[str, float]:
    return {"sensor_play": 1.0, "jenkins_reach": size * scene.base.amplitude}


def _clock(scene: Scene, size: float) -> dict[str, float]:
    return {"sensor_clock": _side(scene) * size}


def _skew(scene: Scene, size: float) -> dict[str, float]:
    return {"output_delay": size / scene.base.fs}


def _caught(scene: Scene, size: float) -> dict[str, float]:
    if scene.held_out:
        return {}
    omega = scene.base.omega
    grip = scene.own.uniform(0.3, 1.0)
    return {
        "hand_at": (1.0 - size * scene.own.uniform(0.5, 1.0)) * scene.seconds,
        "hand_damping": 2 * grip * omega,
        "hand_stiffness": grip * omega**2,
        "hand_place": float(scene.own.normal(0.0, 0.02)) * scene.base.amplitude,
    }


OF_THE_RIG = (
    Imperfection(
        "second-mode",
        "a part with this share of the mass sways on it at 4 to 9 times the natural frequency",
        0.003,
        0.05,
        "cables, brackets and the mass itself are elastic; every structure has further modes (Ewins 2000, ch. 2)",
        own=("attached-resonator",),
        rig=_second_mode,
    ),
    Imperfection(
        "breathing-stiffness",
        "the stiffness swings slowly by this share, with another phase in each recording",
        0.0005,
        0.01,
        "a motor, a draught or air conditioning, periods of 7 to 50 cycles",
        own=("stiffness-drift",),
        rig=_breathing,
    ),
    Imperfection(
        "moving-mass",
        "this share of mass more moves at full amplitude",
        0.002,
        0.05,
        "a spring's own mass, a lever, a shortening pendulum (Crespo da Silva and Glynn 1978)",
        rig=_moving_mass,
    ),
    Imperfection(
        "pre-sliding",
        "a joint gives by 1 to 5 % of the amplitude before it slips, with this share of the spring force",
        0.0003,
        0.004,
        "asperities are elastic before they break (Dahl 1968; Al-Bender, Lampaert and Swevers 2005)",
        own=("hysteresis",),
        rig=_presliding,
    ),
    Imperfection(
        "warming-spring",
        "the stiffness falls by this share within the recording",
        0.0005,
        0.01,
        "Young's modulus of steel falls by 0.03 % a kelvin, rubber's by ten times that",
        own=("stiffness-drift",),
        rig=_warming_spring,
    ),
    Imperfection(
        "friction-wears-in",
        "dry friction grows by this share of the spring force within the recording",
        0.0002,
        0.004,
        "a guide that warms, a film of grease that is pressed out",
        rig=_run_in,
    ),
    Imperfection(
        "air-drag",
        "drag v|v| with this share of the spring force at peak speed",
        0.0003,
        0.008,
        "0.5 rho c A of a plate of 0.01 m² on a mass of 0.5 kg at 1 m/s is 0.3 % of such a spring's force",
        own=("quadratic-drag",),
        rig=_air,
    ),
    Imperfection(
        "sagging-spring",
        "the spring is stiffer on one side: x² with this share of its force",
        0.001,
        0.03,
        "a rig that hangs in its own weight does not swing about the middle of its spring's curve",
        own=("quadratic-stiffness",),
        rig=_sagging,
    ),
    Imperfection(
        "creeping-rubber",
        "this share of the stiffness relaxes within 1.6 to 16 cycles",
        0.001,
        0.02,
        "mounts, glue and wires creep",
        own=("viscoelastic",),
        rig=_creep,
    ),
    Imperfection(
        "warming-damper",
        "viscous damping falls by this share within the recording",
        0.02,
        0.3,
        "the viscosity of oil falls by 2 to 5 % a kelvin",
        rig=_warming_damper,
    ),
    Imperfection(
        "force-factor",
        "the shaker's coil loses this share of its force at full stroke, behind the load cell of its current",
        0.002,
        0.03,
        "the coil leaves the field of its magnet (Klippel 2006)",
        needs="force",
        rig=_force_factor,
    ),
    Imperfection(
        "remounted",
        "stiffness differs by up to this share between recordings, damping by up to ten times that",
        0.0002,
        0.004,
        "a rig taken apart, or another day: frequencies repeat within 0.1 to 2 %",
        own=("stiffness-drift",),
        rig=_remounted,
    ),
    Imperfection(
        "sensor-play",
        "the sensor's linkage has this play, in parts of the amplitude",
        0.0003,
        0.004,
        "a spring-loaded plunger follows within some micrometres",
        needs="displacement",
        rig=_play,
    ),
    Imperfection(
        "clock-of-motion",
        "the sensor's clock runs faster or slower than the force's by this share",
        3e-5,
        5e-4,
        "two instruments; quartz clocks are within 20 to 100 ppm, sound cards and cameras within 500",
        needs="force",
        rig=_clock,
    ),
    Imperfection(
        "skewed-channels",
        "the motion is sampled this part of a sample before the force",
        0.1,
        1.0,
        "a converter that scans its channels one after the other",
        own=("time-delay", "sensor-lag", "actuator-lag"),
        needs="force",
        rig=_skew,
    ),
    Imperfection(
        "caught",
        "a hand stops the rig in the last share of the recording; recordings held out go on",
        0.05,
        0.25,
        "who has seen enough stops it before the recorder",
        needs="release",
        rig=_caught,
    ),
)
