from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.export.verify import Backbone, RecordingCheck, Verification
from dashpot.identify import Identification, identify
from dashpot.model import Oscillator, Response
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force

STAND = {
    "mass": 0.27,
    "omega0": 2 * math.pi * 12.67,
    "viscous": 5.0,
    "dry": 0.015,
    "cubic": 4.6e5,
    "preload": 0.02 / 0.27,
}
FS = 500.0


def simulated(model: Oscillator, force: np.ndarray | None, n: int, start: float, top: float, seed: int) -> np.ndarray:
    """Response from a displacement `start`, with a ten-thousandth of `top` as noise."""
    core, values = core_of(model), np.array(list(model.values().values()))
    step = internal_step(model, model.values(), top)
    drive = None if force is None else smooth_force(force, 1 / FS, 40.0)
    x = core.record(values, np.array([start, 0.0]), drive, n, 1 / FS, step)
    return x + 1e-4 * top * np.random.default_rng(seed).standard_normal(n)


@cache
def stand(name: str = "stand") -> Identification:
    """A short sweep and a short decay of the paper's stand, identified."""
    model = Oscillator.from_values(STAND)
    t = np.arange(int(16 * FS)) / FS
    force = np.sin(2 * math.pi * (9.0 * t + 0.25 * t**2))
    sweep = simulated(model, force, t.size, 0.0, 9e-3, 1)
    decay = simulated(model, None, int(2.5 * FS), 6e-3, 6e-3, 2)
    recordings = (
        Recording("sweep.csv", FS, sweep, force, sha256="ab" * 32, notes=("A gap of one sample was closed.",)),
        Recording("decay.csv", FS, decay),
    )
    return identify(recordings, name=name)


@cache
def roll() -> Identification:
    """A decay of an angle, without a force: no mass."""
    values = {"omega0": 4.0, "cubic": 1.0, "preload": 0.0, "viscous": 0.12, "dry": 0.0}
    model = Oscillator.from_values(values, response=Response("displacement", "rad"))
    x = simulated(model, None, int(60 * FS), 0.3, 0.3, 3)[::10]
    return identify((Recording("roll.csv", FS / 10, x, unit="rad"),), name="roll")


@cache
def volts() -> Identification:
    """An electronic oscillator in volts, driven by noise: no sine level, no decay."""
    values = {"mass": 1e-4, "omega0": 80.0, "cubic": 2e3, "preload": 0.0, "viscous": 6.0, "dry": 0.0}
    model = Oscillator.from_values(values, response=Response("displacement", "V"), force_unit="V")
    n = int(12 * FS)
    spectrum = np.fft.rfft(np.random.default_rng(4).standard_normal(n))
    frequency = np.fft.rfftfreq(n, 1 / FS)
    force = np.fft.irfft(np.where((frequency > 2) & (frequency < 30), spectrum, 0), n)
    force *= 0.3 / np.std(force)
    x = simulated(model, force, n, 0.0, 1.0, 5)
    return identify((Recording("noise.csv", FS, x, force, unit="V", force_unit="V"),), name="box")


IDENTIFICATIONS: dict[str, Callable[[], Identification]] = {"stand": stand, "roll": roll, "volts": volts}


@pytest.fixture(scope="session")
def identifications() -> dict[str, Callable[[], Identification]]:
    """Identifications by name, made when first asked for."""
    return IDENTIFICATIONS


@pytest.fixture(scope="session")
def verified() -> Callable[..., Verification]:
    """What a verification of an identification looks like: the fit's own simulation in the FMU's place."""

    def make(found: Identification, *, passed: bool = True, held_out: str | None = None) -> Verification:
        checks = []
        for i, r in enumerate(found.recordings):
            simulated = np.zeros(r.n)
            for one in found.fit.segments:
                if one.segment.recording == i:
                    simulated[one.segment.start : one.segment.stop] = one.simulated
            pairs = tuple(
                (Backbone(c.method.upper(), c.amplitude, c.omega0 / 6.3),) * 2
                for c in found.hilbert.curves
                if c.recording == r.name
            )
            floor = 0.01 if passed else 0.001
            response = np.asarray(r.response)
            checks.append(RecordingCheck(r.name, 0.01, floor, 0.001, passed, r.time, response, simulated, pairs))
        if held_out is not None:
            checks[-1] = replace(checks[-1], file=held_out)
        return Verification("rig.fmu", tuple(checks))

    return make
