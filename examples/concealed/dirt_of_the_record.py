"""Imperfections of the sensor of motion, and of what its instrument makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .engine import Response
from .imperfection import Imperfection, Scene
from .linear import filtered


def _side(scene: Scene) -> float:
    return float(scene.common.choice([-1.0, 1.0]))


def _passed(
    scene: Scene, response: Response, transfer: Callable[[np.ndarray], np.ndarray], settles: float = 0.0
) -> Response:
    """What a linear instrument shows; a rig at rest shows no acceleration before it is released."""
    before = 0.0 if scene.accelerometer else float(response.shown[0])
    return replace(response, shown=filtered(response.shown, scene.base.fs, transfer, before, settles))


def _bent(scene: Scene, size: float, response: Response) -> Response:
    return replace(response, shown=response.shown * (1.0 + _side(scene) * size * response.shown / scene.full))


def _drift(scene: Scene, size: float, response: Response) -> Response:
    zero, slope, bow = scene.own.uniform(-1.0, 1.0, 3)
    part = scene.t / scene.seconds
    return replace(response, shown=response.shown + size * scene.full * (zero + slope * part + bow * part**2))


def _gain(scene: Scene, size: float, response: Response) -> Response:
    return replace(response, shown=response.shown * (1.0 + size * scene.own.uniform(-1.0, 1.0)))


def _jitter(scene: Scene, size: float, response: Response) -> Response:
    early = size * scene.own.standard_normal(len(response.shown))  # in samples
    return replace(response, shown=response.shown + early * np.gradient(response.shown))


def _anti_alias(scene: Scene, size: float, response: Response) -> Response:
    corner = scene.base.omega / size
    return _passed(scene, response, lambda s: corner**2 / (s**2 + np.sqrt(2) * corner * s + corner**2))


def _hum(scene: Scene, size: float, response: Response) -> Response:
    omega = scene.common.uniform(0.3, 5.0) * scene.base.omega
    tone = np.sin(omega * scene.t + scene.own.uniform(0.0, 2 * np.pi))
    return replace(response, shown=response.shown + size * scene.full * tone)


def _repeated(scene: Scene, size: float, response: Response) -> Response:
    shown = response.shown.copy()
    for i in np.flatnonzero(scene.own.uniform(size=len(shown)) < size):
        shown[i] = shown[max(i - 1, 0)]
    return replace(response, shown=shown)


def _lens(scene: Scene, size: float, response: Response) -> Response:
    part = response.shown / scene.full
    return replace(response, shown=response.shown * (1.0 - _side(scene) * size * part**2))


def _stand(scene: Scene, size: float, response: Response, lowest: float, highest: float) -> Response:
    """The stand on which the sensor is moves under what the rig's inertia does to the floor."""
    omega, zeta = scene.common.uniform(lowest, highest) * scene.base.omega, scene.common.uniform(0.02, 0.1)
    return _passed(scene, response, lambda s: 1.0 + size * s**2 / (s**2 + 2 * zeta * omega * s + omega**2))


def _soft_base(scene: Scene, size: float, response: Response) -> Response:
    return _stand(scene, size, response, 0.1, 0.3)


def _shaky_stand(scene: Scene, size: float, response: Response) -> Response:
    return _stand(scene, size, response, 2.5, 6.0)


def _mount(scene: Scene, size: float, response: Response) -> Response:
    omega, zeta = scene.base.omega / size, scene.common.uniform(0.02, 0.1)
    return _passed(scene, response, lambda s: omega**2 / (s**2 + 2 * zeta * omega * s + omega**2))


def _coupled(scene: Scene, size: float, response: Response) -> Response:
    corner = size * scene.base.omega
    return _passed(scene, response, lambda s: s / (s + corner), settles=10 / corner)


OF_THE_RECORD = (
    Imperfection(
        "bent-sensor",
        "the sensor's curve is off by this share at the working amplitude, square",
        0.001,
        0.02,
        "data sheets of optical and inductive sensors state 0.1 to 1 %, accelerometers 1 %",
        own=("sensor-nonlinearity",),
        record=_bent,
    ),
    Imperfection(
        "zero-and-drift",
        "each recording has its zero and a slow drift, up to this share of the amplitude",
        0.001,
        0.03,
        "amplifiers warm; whoever sets up a laser does not set its zero",
        own=("sensor-offset", "constant-force"),
        record=_drift,
    ),
    Imperfection(
        "gain-by-file",
        "the gain differs between recordings by up to this share",
        0.001,
        0.01,
        "ranges of an amplifier agree within 0.1 to 1 %; a camera is set up anew",
        record=_gain,
    ),
    Imperfection(
        "timing-jitter",
        "each sample is taken early or late, standard deviation in parts of a sample",
        0.005,
        0.05,
        "loops in software, exposure control",
        record=_jitter,
    ),
    Imperfection(
        "anti-alias-filter",
        "a Butterworth filter of second order in the motion alone; this is the natural frequency over its corner",
        0.01,
        0.08,
        "one channel is filtered and the other not",
        own=("time-delay", "sensor-lag"),
        needs="force",
        record=_anti_alias,
    ),
    Imperfection(
        "hum-in-the-sensor",
        "a tone in the record of the motion, with this share of the amplitude",
        0.0005,
        0.01,
        "mains and its harmonics",
        own=("tonal-disturbance",),
        record=_hum,
    ),
    Imperfection(
        "repeated-frames",
        "this share of the frames shows the one before",
        0.001,
        0.02,
        "a camera that does not keep its rate",
        needs="camera",
        record=_repeated,
    ),
    Imperfection(
        "lens",
        "a radial distortion of this share at the working amplitude",
        0.002,
        0.03,
        "lenses distort by 0.5 to 3 % at the edge of the picture (Zhang 2000)",
        own=("sensor-nonlinearity",),
        needs="camera",
        record=_lens,
    ),
    Imperfection(
        "soft-base",
        "rig and sensor's stand react through a base with this mass ratio, on mounts far below the natural frequency",
        0.001,
        0.02,
        "a seismic block has 50 to 1000 times the mass of the rig",
        own=("attached-resonator",),
        needs="displacement",
        record=_soft_base,
    ),
    Imperfection(
        "shaky-stand",
        "the sensor's stand sways with this share, resonant at 2.5 to 6 times the natural frequency",
        0.001,
        0.02,
        "a tripod or a bracket beside the rig",
        own=("attached-resonator",),
        needs="displacement",
        record=_shaky_stand,
    ),
    Imperfection(
        "mounted-resonance",
        "the accelerometer resonates on its wax or magnet; this is the natural frequency over its own",
        0.02,
        0.1,
        "a magnet's resonance lies at 1 to 7 kHz, a hand-held probe's below",
        needs="acceleration",
        record=_mount,
    ),
    Imperfection(
        "coupled-accelerometer",
        "the accelerometer has a high pass with this share of the natural frequency as its corner",
        0.001,
        0.03,
        "piezoelectric sensors have time constants of 0.5 to 10 s",
        needs="acceleration",
        record=_coupled,
    ),
)
