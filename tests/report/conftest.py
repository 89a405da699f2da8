from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.result import (
    Considered,
    Diagnosis,
    Effect,
    Experiment,
    LatentForce,
    Location,
    RecordFit,
)
from dashpot.identify import Identification, identify
from dashpot.model import Oscillator, Parameter, Response, oscillator_with
from dashpot.model.laws import LIBRARY
from dashpot.model.oscillator import Provenance, Range
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force
from dashpot.verify.verification import Backbone, RecordingCheck, Verification

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

    def make(identification: Identification, *, passed: bool = True, held_out: str | None = None) -> Verification:
        checks = []
        for i, r in enumerate(identification.recordings):
            simulated = np.zeros(r.n)
            for fitted in identification.fit.segments:
                if fitted.segment.recording == i:
                    simulated[fitted.segment.start : fitted.segment.stop] = fitted.simulated
            pairs = tuple(
                (Backbone(c.method.upper(), c.amplitude, c.omega0 / 6.3),) * 2
                for c in identification.hilbert.curves
                if c.recording == r.name
            )
            floor = 0.01 if passed else 0.001
            response, shown = np.asarray(r.response), Response(r.quantity, r.unit)
            checks.append(RecordingCheck(r.name, 0.01, floor, 0.001, passed, r.time, response, simulated, pairs, shown))
        if held_out is not None:
            checks[-1] = replace(checks[-1], file=held_out)
        return Verification("rig.fmu", tuple(checks))

    return make


# Diagnoses made by hand --------------------------------------------------------------------------------------------

BENCH_FS = 400.0
BENCH_OMEGA = 2 * math.pi * 12.0
GIVEN = {"mass": 0.3, "omega0": BENCH_OMEGA, "viscous": 5.0, "dry": 0.02, "cubic": 4e5, "preload": 0.05}


def record(file: str, *, holdout: bool = False, seconds: float = 20.0, forced: bool = True, size: float = 5e-3):
    """A swell of a sine; the model before is a fifth too large in its middle, the one after right to the noise."""
    t = np.arange(int(seconds * BENCH_FS)) / BENCH_FS
    swell = np.exp(-(((t - seconds / 2) / (seconds / 6)) ** 2)) if forced else np.exp(-t / (seconds / 6))
    true = size * swell * np.cos(BENCH_OMEGA * t)
    noise = 0.01 * size * np.random.default_rng(3).standard_normal(t.size)
    force = np.cos(BENCH_OMEGA * t) if forced else None
    return RecordFit(
        file, holdout, 0.21, 0.021, 0.0204, t, true + noise, true * (1 + 0.2 * swell), true, force, Response()
    )


def sure(model: Oscillator, share: float = 1e-3) -> Oscillator:
    """The same oscillator with standard errors."""
    errors = {n: Parameter(p.value, share * abs(p.value), p.unit) for n, p in model.parameters().items()}
    return model.with_parameters(errors)


def mended(before: Oscillator, law: str) -> Oscillator:
    """``before`` with a law of the library, with plain numbers, and a better viscous damping."""
    numbers = {p.name: min(max(0.5 if p.unit != "X" else 2e-3, p.lower), p.upper) for p in LIBRARY[law].parameters}
    values = {k: v for k, v in before.values().items() if "." not in k} | {f"{law}.{k}": v for k, v in numbers.items()}
    values["viscous"] *= 0.9
    oscillator = oscillator_with(
        values, name=before.name, response=before.response, force_unit=before.force_unit, effects=(law,)
    )
    return replace(
        sure(oscillator),
        amplitude=before.amplitude,
        frequency=before.frequency,
        identified=Provenance(({"file": "sweep.csv", "kind": "sweep", "sha256": "ab" * 32},), "ml", "dashpot 0.1.0"),
    )


def given(quantity: str = "displacement", unit: str = "m", *, mass: bool = True) -> Oscillator:
    """The model that was given, in any unit."""
    values = GIVEN if mass else {k: v for k, v in GIVEN.items() if k != "mass"}
    model = Oscillator.from_values(values, name="bench", response=Response(quantity, unit))
    inner = model.response.displacement_unit
    return replace(sure(model), amplitude=Range(2e-4, 6e-3, inner), frequency=Range(8, 16, "Hz"))


def latent(fit: RecordFit) -> LatentForce:
    """A force of the speed, with some scatter."""
    v = np.gradient(fit.measured, fit.time)
    force = 2 * v * np.abs(v)
    off = 0.02 * np.sin(np.arange(v.size))
    return LatentForce(fit.file, fit.time, fit.measured, v, force + off, np.full(v.size, 0.02), force)


def missing(law: str = "quadratic-drag", before: Oscillator | None = None) -> Diagnosis:
    """A diagnosis that named an effect."""
    before = before or given()
    forced = before.mass is not None
    model = mended(before, law)
    records = (
        record("sweep.csv", forced=forced),
        record("decay.csv", forced=False, seconds=6.0),
        record("multisine.csv", holdout=True, forced=forced),
    )
    records = tuple(replace(r, response=before.response) for r in records)
    effect = Effect(
        LIBRARY[law].effect,
        law,
        LIBRARY[law].path,
        model.terms[0].parameters,
        ("cubic-damping",),
        "a record at three times the amplitude",
    )
    place = Location(
        "dissipation",
        "Too little damping above 4 mm",
        (-5e-3, 5e-3),
        (-0.3, 0.3),
        (4e-3, 6e-3),
        (11.0, 13.0),
        (8.0, 12.0),
        ("sweep.csv",),
        {1: 0.9, 3: 0.1},
    )
    considered = (
        Considered("stribeck", None, 3.25, "not supported"),
        Considered("hysteresis", 0.19, -12.0, "leaves nine times the noise"),
        Considered("cubic-damping", 0.022, -900.0, "as good, but not better"),
        Considered("viscoelastic", math.nan, math.nan, "its fit did not come to rest"),
    )
    t = np.arange(4000) / BENCH_FS
    plan = Experiment(
        "Play a sweep from 8 to 16 Hz at 2.5 N",
        "sweep",
        2.5,
        (8.0, 16.0),
        10.0,
        (("quadratic-drag", "stribeck", 4.0), ("quadratic-drag", "cubic-damping", 12.0)),
        2.5 * np.sin(2 * math.pi * (8 * t + 0.4 * t**2)),
        BENCH_FS,
    )
    return Diagnosis(
        "missing-physics",
        "The damping lacks a force that grows with the square of the speed",
        (effect,),
        place,
        before,
        model,
        records,
        considered,
        plan,
        None,
        (latent(records[0]),),
        ("A gap of one sample was closed",),
    )


def consistent() -> Diagnosis:
    """Nothing is missing: no effect, no place, no force, no plan."""
    diagnosis = missing()
    records = tuple(replace(r, before=r.after, nrmse_before=r.nrmse_after) for r in diagnosis.records)
    return replace(
        diagnosis,
        verdict="consistent",
        sentence="The model explains the recordings to their noise",
        effects=(),
        location=None,
        model=diagnosis.before,
        records=records,
        experiment=None,
        latent=(),
        notes=(),
    )


def unexplained() -> Diagnosis:
    """Something is missing, and no law of the library is it."""
    diagnosis = missing()
    records = tuple(replace(r, after=r.before, nrmse_after=r.nrmse_before) for r in diagnosis.records)
    return replace(
        diagnosis,
        verdict="unexplained",
        sentence="No law of the library explains what is left",
        effects=(),
        model=diagnosis.before,
        records=records,
        remainder="Ten times the noise is left in multisine.csv",
        latent=(replace(diagnosis.latent[0], named=None),),
    )


def nothing_known() -> Diagnosis:
    """Numbers that are not there wherever one can be missing."""
    diagnosis = missing()
    lost = diagnosis.records[0].before.copy()
    lost[500:] = np.nan
    gone = replace(diagnosis.records[0], before=lost, nrmse_before=math.nan, noise_floor=math.nan)
    wild = replace(
        diagnosis.records[1], before=diagnosis.records[1].before * 1e200, nrmse_before=math.inf, noise_floor=0.0
    )
    empty = replace(diagnosis.records[2], before=np.full(lost.size, np.nan), after=np.full(lost.size, np.nan))
    none = (math.nan, math.nan)
    place = Location("odd", "", none, none, (0.0, 0.0), none, none, (), {})
    poor = {
        name: Parameter(p.value, None if name == "dry" else math.nan, p.unit)
        for name, p in diagnosis.model.parameters().items()
    }
    poor["cubic"] = Parameter(math.nan, 1.0, poor["cubic"].unit)
    poor["preload"] = Parameter(0.0, 0.0, poor["preload"].unit)
    unknown = {"strength": Parameter(math.nan, None, "1"), "other": Parameter(1.0, math.inf, "1")}
    effect = replace(diagnosis.effects[0], law="my-own-law", effect="my-own-law", parameters=unknown)
    force = replace(diagnosis.latent[0], std=np.full(lost.size, np.nan), named=np.full(lost.size, np.nan))
    silent = replace(diagnosis.latent[0], force=np.full(lost.size, np.nan))
    plan = Experiment("", "multisine", math.nan, none, math.nan, (("a", "b", math.nan),), np.zeros(100), math.nan)
    return replace(
        diagnosis,
        effects=(effect,),
        location=place,
        model=replace(
            diagnosis.before.with_parameters({k: v for k, v in poor.items() if "." not in k}),
            amplitude=None,
            frequency=None,
        ),
        before=replace(diagnosis.before, amplitude=None),
        records=(gone, wild, empty),
        latent=(force, silent),
        experiment=plan,
        remainder="",
    )


@pytest.fixture(scope="session")
def hand_made() -> SimpleNamespace:
    """What makes diagnoses by hand, and one of each verdict."""
    verdicts = {"missing-physics": missing, "consistent": consistent, "unexplained": unexplained}
    return SimpleNamespace(
        record=record, given=given, latent=latent, missing=missing, nothing_known=nothing_known, verdicts=verdicts
    )
