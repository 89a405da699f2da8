"""One virtual rig: drawn at random, with its concealed effects, and again until it is fit for a test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .base import Base, draw_base
from .effects import EVERYTHING, OF_THE_BASE, PARTS_OF_FORCE, PHASES
from .engine import Response
from .noise import draw_noise
from .recordings import EXPERIMENTS, Experiment, Plan, Rig, amplitude, draw_plans, run, set_levels
from .suite import Spec

STRENGTH = {"nominal": 1.0, "small": 0.2}
VISIBLE = 3.0  # times the noise: the least rms difference that an effect makes in a training record
ATTEMPTS = 200
CHAOTIC = {"rattling-mass"}  # never comes out the same twice, and is wanted all the same
CAMERA = 0.35  # times as often as another sensor
BARELY = 1e-9  # relative change of the stiffness that must not change a record visibly: else it does not repeat

Conceal = Callable[[float, str], Rig]
"""Gives the rig with its effects at a strength, one of them left out by name."""


@dataclass(frozen=True)
class Trial:
    """How a rig is tried: the name of its experiment, and what its sensor shows: displacement or acceleration.

    A camera shows displacement, a third as often.
    """

    experiment: str = "shaker"
    quantity: str = "displacement"

    @property
    def plan(self) -> Experiment:
        """The experiment."""
        return EXPERIMENTS[self.experiment]


class NotSane(Exception):
    """A drawn rig that is not fit for a test; the next one is drawn."""


@dataclass(frozen=True)
class Virtual:
    """A virtual rig that is fit for a test.

    `plans` are its recordings with their force levels, `level` N the peak force of the strong sweep, `responses` what
    they give without noise, `phases` the random phases of each recording, rad. `entropy` seeds its sensors' noise;
    `dirt` has what was measured of its imperfections, where it has any.
    """

    spec: Spec
    scale: str
    trial: Trial
    base: Base
    rig: Rig
    plans: dict[str, Plan]
    level: float
    responses: dict[str, Response]
    noise: dict[str, str | float]
    phases: dict[str, dict[str, float]]
    entropy: list[int]
    redraws: int
    dirt: dict[str, Any] | None = None


def draw(
    spec: Spec,
    seed: int,
    scale: str = "nominal",
    cycles: tuple[float, float] = (300.0, 600.0),
    attempts: int = ATTEMPTS,
    trial: Trial = Trial(),
) -> Virtual:
    """Draw a rig, again until it is sane; raises RuntimeError where none of the `attempts` is.

    `scale` is nominal or small; `cycles` bounds the length of the sweeps in natural cycles. Whether the effect can be
    seen is judged at nominal strength, so that both scales give the same rigs.
    """
    for attempt in range(attempts):
        try:
            return _draw_once(spec, spec.entropy(seed, attempt), scale, cycles, attempt, trial)
        except NotSane:
            continue
    raise RuntimeError(f"none of {attempts} rigs with {spec} was fit for a test")


def _draw_once(
    spec: Spec, entropy: list[int], scale: str, cycles: tuple[float, float], redraws: int, trial: Trial
) -> Virtual:
    rngs = [np.random.default_rng([*entropy, stream]) for stream in range(4)]
    base, experiment = draw_base(rngs[0], cycles), trial.plan
    slower = CAMERA if trial.quantity == "camera" else 1.0
    base = replace(base, fs=base.fs * experiment.faster * slower)
    if trial.quantity == "acceleration":
        parameters = base.parameters | {"accelerometer": 1.0}
        base = replace(base, noise=base.noise * base.omega**2, parameters=parameters)
    plans = draw_plans(rngs[1], base, experiment)
    noise = draw_noise(rngs[3], spec.noise, base.noise)
    names = experiment.recordings
    phases = {name: {phase: float(rngs[3].uniform(0, 2 * np.pi)) for phase in PHASES.values()} for name in names}
    sizes, levels = (int(number) for number in rngs[2].integers(0, 2**63, 2))
    conceal = _concealer(spec, base, phases, sizes)
    nominal = conceal(1.0, "")
    rig, (set_plans, level) = nominal, _levels(levels, base, nominal, plans, experiment)
    responses = _responses(base, nominal, set_plans, level)
    _check(base, responses, experiment)
    for name in spec.effects:
        _check_visible(base, conceal(1.0, name), set_plans, level, responses, experiment)
    if STRENGTH[scale] != 1.0:
        rig = conceal(STRENGTH[scale], "")
        set_plans, level = _levels(levels, base, rig, plans, experiment)
        responses = _responses(base, rig, set_plans, level)
        _check(base, responses, experiment)
    if not CHAOTIC & set(spec.effects):
        _check_repeats(base, rig, set_plans, level, responses)
    return Virtual(spec, scale, trial, base, rig, set_plans, level, responses, noise, phases, entropy, redraws)


def _concealer(spec: Spec, base: Base, phases: dict[str, dict[str, float]], sizes: int) -> Conceal:
    def conceal(strength: float, left_out: str) -> Rig:
        rng = np.random.default_rng(sizes)  # the same sizes at every strength
        parts: dict[str, float] = {}
        for name, variant in zip(spec.effects, spec.variants, strict=True):
            drawn = EVERYTHING[name].draw(rng, base, variant, strength)
            parts |= {key: float(drawn[key]) for key in drawn if name != left_out or key in OF_THE_BASE}

        def rig(recording: str, level: float) -> dict[str, float]:
            values = base.parameters | {k: v * (level if k in PARTS_OF_FORCE else 1.0) for k, v in parts.items()}
            values |= {phase: phases[recording][phase] for size, phase in PHASES.items() if size in values}
            return values | {"force": level / values["mass"]}

        return rig

    return conceal


def _levels(
    seed: int, base: Base, rig: Rig, plans: dict[str, Plan], experiment: Experiment
) -> tuple[dict[str, Plan], float]:
    try:
        return set_levels(np.random.default_rng(seed), base, rig, plans, experiment)
    except RuntimeError as problem:
        raise NotSane(str(problem)) from problem


def _responses(base: Base, rig: Rig, plans: dict[str, Plan], level: float) -> dict[str, Response]:
    try:
        return {name: run(rig, base, name, plan, level) for name, plan in plans.items()}
    except RuntimeError as problem:
        raise NotSane(str(problem)) from problem


def _check(base: Base, responses: dict[str, Response], experiment: Experiment) -> None:
    """Finite, near the working amplitude, and moving in every record."""
    if not all(np.isfinite(response.shown).all() for response in responses.values()):
        raise NotSane("not finite")
    reached = {name: amplitude(response.x) / base.amplitude for name, response in responses.items()}
    if not 0.5 < reached[experiment.training[0]] < 2.0 or max(reached.values()) > 2.5:
        raise NotSane("far from the working amplitude")
    if min(reached.values()) < 0.1:
        raise NotSane("a record in which hardly anything moves")


def _check_visible(
    base: Base,
    without: Rig,
    plans: dict[str, Plan],
    level: float,
    responses: dict[str, Response],
    experiment: Experiment,
) -> None:
    for name in experiment.training:
        try:
            other = run(without, base, name, plans[name], level)
        except RuntimeError:
            return  # without it the rig would run away
        if np.sqrt(np.mean((other.shown - responses[name].shown) ** 2)) >= VISIBLE * base.noise:
            return
    raise NotSane("the effect is not visible")


def _check_repeats(base: Base, rig: Rig, plans: dict[str, Plan], level: float, responses: dict[str, Response]) -> None:
    """A record that an immeasurable change of the rig alters beyond the noise would not come out the same twice."""

    def nearly(recording: str, force: float) -> dict[str, float]:
        parameters = rig(recording, force)
        return parameters | {"omega2": parameters["omega2"] * (1 + BARELY)}

    for name, response in _responses(base, nearly, plans, level).items():
        if np.abs(response.shown - responses[name].shown).max() > 0.3 * base.noise:
            raise NotSane("the record does not repeat")
