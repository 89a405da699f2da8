"""Imperfections of forces: those that nobody records, and what a load cell makes of those that are recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .engine import Response
from .imperfection import Imperfection, Scene
from .linear import filtered


def _coloured(scene: Scene, slope: float, lowest: float, highest: float) -> np.ndarray:
    """Random noise, (samples,), rms 1, whose power falls as f^-slope between two frequencies, Hz."""
    f = np.fft.rfftfreq(scene.plan.samples, 1 / scene.base.fs)
    lines = scene.own.standard_normal((2, len(f)))
    inside = (f >= lowest) & (f <= highest)
    inside[1] |= not inside.any()  # a recording too short for the band
    shape = np.where(inside, np.maximum(f, f[1]) ** (-slope / 2), 0.0)
    noise = np.fft.irfft((lines[0] + 1j * lines[1]) * shape, scene.plan.samples)
    return noise / np.sqrt(np.mean(noise**2))


def _pink(scene: Scene, size: float) -> np.ndarray:
    natural = scene.base.omega / (2 * np.pi)
    return size * scene.resonant * _coloured(scene, 1.0, 0.02 * natural, 0.4 * scene.base.fs)


def _hum(scene: Scene, size: float) -> np.ndarray:
    low = scene.common.uniform() < 0.4
    omega = scene.base.omega * (scene.common.uniform(0.3, 0.8) if low else scene.common.uniform(1.3, 4.0))
    return size * scene.resonant * np.sin(omega * scene.t + scene.own.uniform(0.0, 2 * np.pi))


def _knocks(scene: Scene, size: float) -> np.ndarray:
    lasts = 0.2 * np.pi / scene.base.omega  # a tenth of a cycle
    force = np.zeros(scene.plan.samples)
    for at in scene.own.uniform(0.05, 0.9, scene.own.integers(1, 5)) * scene.seconds:
        part = (scene.t - at) / lasts
        blow = np.where((part > 0) & (part < 1), np.sin(np.pi * part), 0.0)
        area = max(float(np.sum(blow)) / scene.base.fs, 0.5 * lasts)
        momentum = size * scene.own.uniform(0.3, 1.0) * scene.own.choice([-1.0, 1.0])
        force += momentum * scene.values["mass"] * scene.base.speed / area * blow
    return force


def _sway(scene: Scene, size: float) -> np.ndarray:
    natural = scene.base.omega / (2 * np.pi)
    slow = _coloured(scene, 2.0, 0.002 * natural, 0.1 * natural)
    return size * scene.values["mass"] * scene.base.spring * slow


def _slow_release(scene: Scene, size: float) -> np.ndarray:
    if scene.plan.x0 == 0.0:
        return np.zeros(scene.plan.samples)
    lasts = size * 2 * np.pi / scene.base.omega
    left = np.maximum(1.0 - scene.t / lasts, 0.0)
    return scene.values["mass"] * scene.base.stiffness * scene.plan.x0 * left


def _peak(response: Response) -> float:
    return float(np.abs(response.force).max()) or 1.0


def _fixture(scene: Scene, size: float, response: Response) -> Response:
    speed = np.gradient(response.x, 1 / scene.base.fs)
    weight = size * scene.values["mass"] * np.gradient(speed, 1 / scene.base.fs)
    return replace(response, force=response.force + weight)


def _curved_cell(scene: Scene, size: float, response: Response) -> Response:
    bend = size * scene.common.choice([-1.0, 1.0]) / _peak(response)
    return replace(response, force=response.force * (1.0 + bend * response.force))


def _charge(scene: Scene, size: float, response: Response) -> Response:
    corner = size * scene.base.omega
    leaked = filtered(response.force, scene.base.fs, lambda s: s / (s + corner), settles=10 / corner)
    return replace(response, force=leaked)


def _crosstalk(scene: Scene, size: float, response: Response) -> Response:
    part = size * scene.common.choice([-1.0, 1.0]) * scene.full / _peak(response)
    return replace(response, shown=response.shown + part * response.force)


OF_THE_FORCE = (
    Imperfection(
        "pink-force",
        "random force with power as 1/f, its rms this share of the force that resonance needs",
        0.003,
        0.05,
        "footsteps, pumps and wind reach every laboratory floor",
        rest=_pink,
    ),
    Imperfection(
        "hum-force",
        "a tone away from resonance, with this share of the force that resonance needs",
        0.003,
        0.05,
        "a fan or a pump on the same floor",
        own=("tonal-disturbance",),
        rest=_hum,
    ),
    Imperfection(
        "knocks",
        "one to four blows on the table a recording, each worth up to this share of the working speed",
        0.002,
        0.03,
        "somebody touches the table, a door shuts",
        rest=_knocks,
    ),
    Imperfection(
        "sway",
        "a slow random force below a tenth of the natural frequency, its rms this share of the spring force",
        0.0005,
        0.01,
        "a draught, a cable that is dragged along, a building in the wind",
        rest=_sway,
    ),
    Imperfection(
        "slow-release",
        "the hand lets go within this part of a cycle",
        0.01,
        0.15,
        "fingers take 10 to 30 ms",
        needs="release",
        rest=_slow_release,
    ),
    Imperfection(
        "fixture-behind-the-cell",
        "the load cell also weighs a fixture with this share of the mass",
        0.003,
        0.05,
        "what lies between the cell's crystal and the rig accelerates with it (Ewins 2000, mass cancellation)",
        needs="force",
        record=_fixture,
    ),
    Imperfection(
        "curved-load-cell",
        "the load cell's curve is off by this share at the recording's peak, square",
        0.001,
        0.02,
        "data sheets of load cells state 0.1 to 1 % of full scale",
        needs="force",
        record=_curved_cell,
    ),
    Imperfection(
        "charge-amplifier",
        "the recorded force has a high pass with this share of the natural frequency as its corner",
        0.0005,
        0.02,
        "charge leaks: time constants of 0.5 to 100 s",
        needs="force",
        record=_charge,
    ),
    Imperfection(
        "crosstalk",
        "this share of the force's full scale shows in the motion",
        0.0005,
        0.01,
        "converters state 40 to 80 dB between channels",
        needs="force",
        record=_crosstalk,
    ),
)
