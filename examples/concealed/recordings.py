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


@dataclass(frozen=True)
class Plan:
    """One recording to make: its force, where the rig is released from rest, m, and the number of samples."""

    drive: Drive
    x0: float
    samples: int


Rig = Callable[[str, float], dict[str, float]]
"""A rig's parameters in the recording of that name, when the strong sweep has that peak force, N."""


def run(
    rig: Rig, base: Base, name: str, plan: Plan, level: float, rest: np.ndarray | None = None, **accuracy: float
) -> Response:
    """Simulate one recording of a rig; `level` N is the peak force of its strong sweep, `rest` as in `simulate`.

    Raises RuntimeError where it diverges.
    """
    return simulate(rig(name, level), plan.drive, plan.x0, base.fs, plan.samples, rest=rest, **accuracy)


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


def _plan(base: Base, drive: Drive) -> Plan:
    return Plan(drive, 0.0, round(drive.length * base.fs))


def _ringdown(base: Base) -> Plan:
    """Let go at the working amplitude."""
    decay = np.log(200.0) / (base.zeta * base.omega)  # to half a percent, if there were viscous damping alone
    frequency = base.omega / (2 * np.pi)
    ringdown = float(f"{np.clip(decay, 40 / frequency, min(150 / frequency, base.length)):.2g}")
    return Plan(Drive("none"), base.amplitude, round(ringdown * base.fs))


def _shaker(rng: np.random.Generator, base: Base) -> list[Plan]:
    """Two sweeps, a decay; a multisine and another sweep held out."""
    high = _sweep(rng, base, base.length)
    if rng.uniform() < 0.3:
        high = _backwards(high)
    if rng.uniform() < 0.5:
        held = _backwards(high)
    else:
        held = replace(_sweep(rng, base, base.length), length=float(f"{rng.uniform(0.5, 0.75) * base.length:.2g}"))
    drives = high, high, _multisine(rng, base, base.length), held
    strong, weak, multisine, sweep = (_plan(base, drive) for drive in drives)
    return [strong, weak, _ringdown(base), multisine, sweep]


def _random(rng: np.random.Generator, base: Base, length: float) -> Drive:
    """Random force: so many lines at random in a band that it does not repeat and is nearly Gaussian; its rms is 1."""
    frequency = base.omega / (2 * np.pi)
    count = 150
    lines = np.sort(rng.uniform(rng.uniform(0.2, 0.4), rng.uniform(1.8, 2.6), count)) * frequency
    sizes = rng.uniform(0.3, 1.0, count)
    sizes *= np.sqrt(2 / np.sum(sizes**2))
    table = np.column_stack([lines, sizes, rng.uniform(0.0, 2 * np.pi, count)])
    return Drive("multisine", 1.0, length=length, ramp=rng.uniform(2.0, 5.0) / frequency, lines=table)


def _shaken_at_random(rng: np.random.Generator, base: Base) -> list[Plan]:
    """Random force at two levels, a decay; random force and a sweep held out."""
    drives = [_random(rng, base, base.length) for _ in range(3)] + [_sweep(rng, base, base.length)]
    strong, weak, other, sweep = (_plan(base, drive) for drive in drives)
    return [strong, weak, _ringdown(base), other, sweep]


def _steps(rng: np.random.Generator, base: Base, length: float) -> Drive:
    """A sine whose frequency is stepped through the resonance, its phase continuous; straight between the samples."""
    frequency = base.omega / (2 * np.pi)
    lines = np.linspace(rng.uniform(0.55, 0.75), rng.uniform(1.3, 1.7), int(rng.integers(12, 25))) * frequency
    if rng.uniform() < 0.4:
        lines = lines[::-1]
    samples = round(length * base.fs)
    step = np.minimum(np.arange(samples) * len(lines) // samples, len(lines) - 1)
    phase = 2 * np.pi * np.cumsum(lines[step]) / base.fs
    force = np.sin(phase - phase[0])
    table = np.column_stack([force, np.diff(force, append=0.0)])
    return Drive("straight", 1.0, length=length, ramp=rng.uniform(2.0, 5.0) / frequency, lines=table)


def _stepped(rng: np.random.Generator, base: Base) -> list[Plan]:
    """Stepped sines at two levels, a decay; a stepped sine and a sweep held out."""
    drives = [_steps(rng, base, base.length) for _ in range(3)] + [_sweep(rng, base, base.length)]
    strong, weak, other, sweep = (_plan(base, drive) for drive in drives)
    return [strong, weak, _ringdown(base), other, sweep]


def _stops(base: Base, part: float) -> float:
    """When dry friction stops the base that is let go at a part of its amplitude, s: who sees that ends the recording.

    The envelope falls by zeta omega A + 2 dry/(pi omega) a second.
    """
    dry, rate = base.parameters["dry"], base.zeta * base.omega
    if dry == 0.0:
        return np.inf
    return float(np.log1p(rate * base.amplitude * part * np.pi * base.omega / (2 * dry)) / rate)


def _decays(rng: np.random.Generator, base: Base) -> list[Plan]:
    """Let go five times, farther or less far, from either side; nothing else drives it."""
    parts = [1.0, *(rng.uniform(low, high) for low, high in ((0.35, 0.5), (0.6, 0.75), (0.75, 0.95), (0.3, 0.5)))]
    sides = rng.choice([-1.0, 1.0], len(parts))
    plans = []
    for part, side in zip(parts, sides, strict=True):
        plan = _ringdown(base)
        samples = round(np.clip(1.5 * _stops(base, part) * base.fs, 0.25 * plan.samples, plan.samples))
        plans.append(Plan(plan.drive, base.amplitude * part * side, samples))
    return plans


def _hits(rng: np.random.Generator, base: Base, count: int, weakest: float) -> Drive:
    """Blows of a hammer with the ring-down after each, the strongest of part 1; first the rig is at rest."""
    frequency = base.omega / (2 * np.pi)
    rings = float(np.clip(np.log(30.0) / (base.zeta * base.omega), 25 / frequency, 80 / frequency))
    waits = rings * rng.uniform(0.8, 1.4, count)
    begins = rng.uniform(2.0, 6.0) / frequency + np.concatenate([[0.0], np.cumsum(waits)[:-1]])
    parts = rng.uniform(weakest, 1.0, count)
    lasts = rng.uniform(10.0, 16.0) / base.fs * rng.uniform(0.95, 1.05, count)
    table = np.column_stack([begins, parts / np.max(parts), lasts])
    return Drive("hits", 1.0, length=float(begins[-1] + waits[-1]), lines=table)


def _hammer(rng: np.random.Generator, base: Base) -> list[Plan]:
    """Strong hits, weak ones, and of all sizes; others held out."""
    drives = [_hits(rng, base, int(rng.integers(3, 6)), weakest) for weakest in (0.7, 0.7, 0.2, 0.4, 0.7)]
    return [_plan(base, drive) for drive in drives]


@dataclass(frozen=True)
class Experiment:
    """How a rig is tried.

    `training` names the recordings to learn from: at the working amplitude, weaker, a third; `held_out` those to judge
    by. `draw` gives their plans in that order, with forces of level 1 that are still to be set; `faster` than for
    sweeps they are sampled.
    """

    training: tuple[str, ...]
    held_out: tuple[str, ...]
    draw: Callable[[np.random.Generator, Base], list[Plan]]
    faster: float = 1.0

    @property
    def recordings(self) -> tuple[str, ...]:
        """All names."""
        return self.training + self.held_out


EXPERIMENTS = {
    "shaker": Experiment(("sweep_high", "sweep_low", "ringdown"), ("holdout_multisine", "holdout_sweep"), _shaker),
    "random": Experiment(
        ("random_high", "random_low", "ringdown"), ("holdout_random", "holdout_sweep"), _shaken_at_random
    ),
    "stepped": Experiment(("stepped_high", "stepped_low", "ringdown"), ("holdout_stepped", "holdout_sweep"), _stepped),
    "decays": Experiment(
        ("release_high", "release_low", "release_between"), ("holdout_release", "holdout_small_release"), _decays
    ),
    # a blow lasts a tenth of a cycle, and its shape must be seen
    "hammer": Experiment(("hits_high", "hits_low", "hits_mixed"), ("holdout_hits", "holdout_high"), _hammer, 3.0),
}


def draw_plans(rng: np.random.Generator, base: Base, experiment: Experiment) -> dict[str, Plan]:
    """Draw the recordings of a rig, with forces of level 1 that are still to be set."""
    return dict(zip(experiment.recordings, experiment.draw(rng, base), strict=True))


def at_level(plan: Plan, peak: float) -> Plan:
    """Give the recording with a force of that peak, N (rms for a multisine)."""
    return replace(plan, drive=replace(plan.drive, peak=peak))


def amplitude(x: np.ndarray) -> float:
    """Half the peak-to-peak displacement, m: a static load is no vibration."""
    return float(np.ptp(x)) / 2


def _first_guess(base: Base, drive: Drive) -> float:
    """About the force, N, that reaches the working amplitude: by the damping at resonance, or by a hit's momentum."""
    p = base.parameters
    if drive.kind == "hits":  # a sin² has half the area of its box
        return p["mass"] * base.speed / (0.5 * drive.lines[0, 2])
    return p["mass"] * (2 * base.zeta * base.spring + 4 / np.pi * p["dry"]) * 1.5


def set_levels(
    rng: np.random.Generator, base: Base, rig: Rig, plans: dict[str, Plan], experiment: Experiment
) -> tuple[dict[str, Plan], float]:
    """Turn the level until the strong recording reaches the working amplitude; give the recordings and its peak, N."""
    low, multisine, held = rng.uniform(0.28, 0.40), rng.uniform(0.45, 0.85), rng.uniform(0.5, 0.8)
    strong, weak, third, other, last = experiment.recordings

    def reached(name: str, peak: float, level: float) -> float:
        return amplitude(run(rig, base, name, at_level(plans[name], peak), level).x)

    force = _first_guess(base, plans[strong].drive)
    if plans[strong].drive.kind == "none":
        return plans, force
    for _ in range(8):
        peak = reached(strong, force, force)
        if abs(peak / base.amplitude - 1) < 0.05:
            break
        force *= float(np.clip(base.amplitude / max(peak, 1e-9 * base.amplitude), 0.4, 2.5)) ** 0.9
    while low < 0.7:
        if reached(weak, low * force, force) > 0.1 * base.amplitude:
            break
        low *= 1.25
    rms = 0.7 * force
    for _ in range(4):
        peak = reached(other, rms, force)
        if abs(peak / (multisine * base.amplitude) - 1) < 0.1:
            break
        rms *= float(np.clip(multisine * base.amplitude / max(peak, 1e-9 * base.amplitude), 0.4, 2.5)) ** 0.9
    between = 0.0 if plans[third].drive.kind == "none" else 0.8 * force
    # the force of a sweep is no measure of random force, nor the other way round
    random = plans[strong].drive.kind == "multisine"
    sweep = held * (_first_guess(base, plans[last].drive) if random else force)
    forces = {strong: force, weak: low * force, third: between, other: rms, last: sweep}
    return {name: at_level(plan, forces[name]) for name, plan in plans.items()}, force
