"""One virtual rig: drawn, checked for sanity, simulated, recorded with noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .base import Base, draw_base
from .effects import EVERYTHING, OF_THE_BASE, PARTS_OF_FORCE, PHASES, twins
from .engine import Response
from .noise import draw_noise, measured
from .recordings import RECORDINGS, TRAINING, Plan, Rig, draw_plans, run, set_levels
from .suite import Spec

STRENGTH = {"nominal": 1.0, "small": 0.2}
FORCE_NOISE = 1e-3  # of the record's peak force
VISIBLE = 3.0  # times the noise: the least difference that an effect makes in a training record
ATTEMPTS = 200
BARELY = 1e-9  # relative change of the stiffness that must not change a record visibly: else it does not repeat


class NotSane(Exception):
    """A drawn rig that is not fit for a test; the next one is drawn."""


@dataclass(frozen=True)
class Recorded:
    """A virtual rig's recordings, (n, 3) each: time s, force N, displacement m; and its truth, as it is sealed."""

    tables: dict[str, np.ndarray]
    fs: float
    truth: dict[str, Any]


def draw(
    spec: Spec,
    seed: int,
    scale: str = "nominal",
    cycles: tuple[float, float] = (300.0, 600.0),
    attempts: int = ATTEMPTS,
) -> Recorded:
    """Draw a rig, again until it is sane, and record it; raises RuntimeError where none of the `attempts` is."""
    for attempt in range(attempts):
        try:
            return _draw_once(spec, spec.entropy(seed, attempt), scale, cycles, attempt)
        except NotSane:
            continue
    raise RuntimeError(f"none of {attempts} rigs with {spec} was fit for a test")


def _draw_once(spec: Spec, entropy: list[int], scale: str, cycles: tuple[float, float], redraws: int) -> Recorded:
    rngs = [np.random.default_rng([*entropy, stream]) for stream in range(4)]
    base = draw_base(rngs[0], cycles)
    plans = draw_plans(rngs[1], base)
    noise = draw_noise(rngs[3], spec.noise, base.noise)
    phases = {name: dict(zip(PHASES.values(), rngs[3].uniform(0, 2 * np.pi, 2), strict=True)) for name in RECORDINGS}
    seeds = rngs[2].integers(0, 2**63, 2)  # the sizes are the same at every strength

    def conceal(strength: float, left_out: str = "") -> Rig:
        """The rig with its effects at that strength; one of them may be left out."""
        rng = np.random.default_rng(seeds[0])
        parts: dict[str, float] = {}
        for name, variant in zip(spec.effects, spec.variants, strict=True):
            drawn = EVERYTHING[name].draw(rng, base, variant, strength)
            parts |= {key: float(drawn[key]) for key in drawn if name != left_out or key in OF_THE_BASE}

        def rig(recording: str, level: float) -> dict[str, float]:
            found = base.parameters | {k: v * (level if k in PARTS_OF_FORCE else 1.0) for k, v in parts.items()}
            found |= {phase: phases[recording][phase] for size, phase in PHASES.items() if size in found}
            return found | {"force": level / found["mass"]}

        return rig

    nominal = conceal(1.0)
    plans_set, level = _levels(seeds[1], base, nominal, plans)
    responses = _responses(base, nominal, plans_set, level)
    _check(base, responses)
    for name in spec.effects:
        _check_visible(base, conceal(1.0, name), plans_set, level, responses)
    rig = nominal
    if STRENGTH[scale] != 1.0:
        rig = conceal(STRENGTH[scale])
        plans_set, level = _levels(seeds[1], base, rig, plans)
        responses = _responses(base, rig, plans_set, level)
        _check(base, responses)
    if spec.kind != "open":
        _check_repeats(base, rig, plans_set, level, responses)
    tables, floors = {}, {}
    for name, response in responses.items():
        force = response.force + FORCE_NOISE * np.abs(response.force).max() * rngs[3].standard_normal(
            len(response.force)
        )
        shown = measured(rngs[3], noise, response.shown)
        tables[name] = np.column_stack([np.arange(len(force)) / base.fs, force, shown])
        floors[name] = float(np.sqrt(np.mean((shown - response.shown) ** 2)) / shown.std())
    parameters = {key: float(value) for key, value in rig("ringdown", level).items()}
    truth = {
        "kind": spec.kind,
        "effects": list(spec.effects),
        "variants": list(spec.variants),
        "twins": twins(spec.effects, parameters) if spec.kind == "single" else [],
        "scale": scale,
        "parameters": parameters,
        "natural_frequency_hz": base.omega / (2 * np.pi),
        "working_amplitude_m": base.amplitude,
        "fs_hz": base.fs,
        "noise": noise,
        "redraws": redraws,
        "recordings": {
            name: {
                "noise_floor": floors[name],
                "peak_force_N": float(np.abs(response.force).max()),
                "peak_displacement_m": float(np.abs(response.x).max()),
                "length_s": len(response.x) / base.fs,
                "drive": plans_set[name].drive.kind,
                "phases": phases[name],
            }
            for name, response in responses.items()
        },
    }
    return Recorded(tables, base.fs, truth)


def _levels(seed: int, base: Base, rig: Rig, plans: dict[str, Plan]) -> tuple[dict[str, Plan], float]:
    try:
        return set_levels(np.random.default_rng(seed), base, rig, plans)
    except RuntimeError as problem:
        raise NotSane(str(problem)) from problem


def _responses(base: Base, rig: Rig, plans: dict[str, Plan], level: float) -> dict[str, Response]:
    try:
        return {name: run(rig, base, name, plan, level) for name, plan in plans.items()}
    except RuntimeError as problem:
        raise NotSane(str(problem)) from problem


def _check(base: Base, responses: dict[str, Response]) -> None:
    """Finite, near the working amplitude, and moving in every record."""
    peaks = {name: float(np.abs(response.x).max()) for name, response in responses.items()}
    if not all(np.isfinite(response.shown).all() for response in responses.values()):
        raise NotSane("not finite")
    if not 0.5 < peaks["sweep_high"] / base.amplitude < 2.0 or max(peaks.values()) > 2.5 * base.amplitude:
        raise NotSane("far from the working amplitude")
    if min(peaks.values()) < 0.1 * base.amplitude:
        raise NotSane("a record in which hardly anything moves")


def _check_visible(base: Base, without: Rig, plans: dict[str, Plan], level: float, found: dict[str, Response]) -> None:
    for name in TRAINING:
        try:
            other = run(without, base, name, plans[name], level)
        except RuntimeError:
            return  # without it the rig would run away
        if np.sqrt(np.mean((other.shown - found[name].shown) ** 2)) >= VISIBLE * base.noise:
            return
    raise NotSane("the effect is not visible")


def _check_repeats(base: Base, rig: Rig, plans: dict[str, Plan], level: float, found: dict[str, Response]) -> None:
    """A record that an immeasurable change of the rig alters beyond the noise would not come out the same twice."""

    def nearly(recording: str, force: float) -> dict[str, float]:
        parameters = rig(recording, force)
        return parameters | {"omega2": parameters["omega2"] * (1 + BARELY)}

    for name, response in _responses(base, nearly, plans, level).items():
        if np.abs(response.shown - found[name].shown).max() > 0.3 * base.noise:
            raise NotSane("the record does not repeat")
