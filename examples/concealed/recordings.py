"""The five recordings of a rig, and the force levels that bring it to its working amplitude.

As an engineer would, the shaker's level is turned until the strong sweep reaches the working amplitude; the weak one
has about a third of that force, more only where friction would hold the rig.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .base import Base
from .engine import Drive, Response, simulate

TRAINING = ("sweep_high", "sweep_low", "ringdown")
HELD_OUT = ("holdout_multisine", "holdout_sweep")
RECORDINGS = TRAINING + HELD_OUT


@dataclass(frozen=True)
class Plan:
    """One recording to make: its force, where the rig is released from rest, m, and the number of samples."""

    drive: Drive
    x0: float
    samples: int


Rig = Callable[[str, float], dict[str, float]]
"""A rig's parameters in the recording of that name, when the strong sweep has that peak force, N."""


def run(rig: Rig, base: Base, name: str, plan: Plan, level: float, **accuracy: float) -> Response:
    """Simulate one recording of a rig; `level` N is the peak force of its strong sweep.

    Raises RuntimeError where it diverges.
    """
    return simulate(rig(name, level), plan.drive, plan.x0, base.fs, plan.samples, **accuracy)


def _sweep(rng: np.random.Generator, base: Base, length: float) -> Drive:
    """A sweep over the resonance without its level, upwards."""
    frequency = base.omega / (2 * np.pi)
    start, end = float(f"{rng.uniform(0.45, 0.7) * frequency:.3g}"), float(f"{rng.uniform(1.4, 1.9) * frequency:.3g}")
    kind = "linear" if rng.uniform() < 0.6 else "logarithmic"
    return Drive(kind, 1.0, start, end, length, rng.uniform(2.0, 5.0) / frequency)


def _backwards(drive: Drive) -> Drive:
    return replace(drive, start=drive.end, end=drive.start)


def _multisine(rng: np.random.Generator, base: Base, length: float) -> Drive:
    """Lines of equal amplitude and random phase, whose sum has an rms of 1."""
    frequency = base.omega / (2 * np.pi)
    period = length / rng.integers(2, 5)
    lowest, highest = rng.uniform(0.5, 0.75) * frequency, rng.uniform(1.3, 1.6) * frequency
    lines = np.unique(np.round(np.linspace(lowest, highest, rng.integers(30, 81)) * period)) / period
    phases = rng.uniform(0.0, 2 * np.pi, len(lines))
    table = np.column_stack([lines, np.full(len(lines), np.sqrt(2 / len(lines))), phases])
    return Drive("multisine", 1.0, length=length, ramp=rng.uniform(2.0, 5.0) / frequency, lines=table)


def draw_plans(rng: np.random.Generator, base: Base) -> dict[str, Plan]:
    """Draw the recordings of a rig, with forces of level 1 that are still to be set."""
    high = _sweep(rng, base, base.length)
    if rng.uniform() < 0.3:
        high = _backwards(high)
    decay = np.log(200.0) / (base.zeta * base.omega)  # to half a percent, if there were viscous damping alone
    frequency = base.omega / (2 * np.pi)
    ringdown = float(f"{np.clip(decay, 40 / frequency, min(150 / frequency, base.length)):.2g}")
    if rng.uniform() < 0.5:
        held = _backwards(high)
    else:
        held = replace(_sweep(rng, base, base.length), length=float(f"{rng.uniform(0.5, 0.75) * base.length:.2g}"))

    def plan(drive: Drive) -> Plan:
        return Plan(drive, 0.0, round(drive.length * base.fs))

    return {
        "sweep_high": plan(high),
        "sweep_low": plan(high),
        "ringdown": Plan(Drive("none"), base.amplitude, round(ringdown * base.fs)),
        "holdout_multisine": plan(_multisine(rng, base, base.length)),
        "holdout_sweep": plan(held),
    }


def at_level(plan: Plan, peak: float) -> Plan:
    """Give the recording with a force of that peak, N (rms for a multisine)."""
    return replace(plan, drive=replace(plan.drive, peak=peak))


def amplitude(x: np.ndarray) -> float:
    """Half the peak-to-peak displacement, m: a static load is no vibration."""
    return float(np.ptp(x)) / 2


def set_levels(rng: np.random.Generator, base: Base, rig: Rig, plans: dict[str, Plan]) -> tuple[dict[str, Plan], float]:
    """Turn the level until the strong sweep reaches the working amplitude; give the recordings and its peak, N."""
    low, multisine, held = rng.uniform(0.28, 0.40), rng.uniform(0.45, 0.85), rng.uniform(0.5, 0.8)
    p = base.parameters

    def reached(name: str, peak: float, level: float) -> float:
        return amplitude(run(rig, base, name, at_level(plans[name], peak), level).x)

    force = p["mass"] * (2 * base.zeta * base.spring + 4 / np.pi * p["dry"]) * 1.5
    for _ in range(8):
        peak = reached("sweep_high", force, force)
        if abs(peak / base.amplitude - 1) < 0.05:
            break
        force *= float(np.clip(base.amplitude / max(peak, 1e-9 * base.amplitude), 0.4, 2.5)) ** 0.9
    while low < 0.7:
        if reached("sweep_low", low * force, force) > 0.1 * base.amplitude:
            break
        low *= 1.25
    rms = 0.7 * force
    for _ in range(4):
        peak = reached("holdout_multisine", rms, force)
        if abs(peak / (multisine * base.amplitude) - 1) < 0.1:
            break
        rms *= float(np.clip(multisine * base.amplitude / max(peak, 1e-9 * base.amplitude), 0.4, 2.5)) ** 0.9
    forces = {"sweep_high": force, "sweep_low": low * force, "ringdown": 0.0}
    forces |= {"holdout_multisine": rms, "holdout_sweep": held * force}
    return {name: at_level(plan, forces[name]) for name, plan in plans.items()}, force
