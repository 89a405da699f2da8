"""Dirty rigs: one concealed effect or none, and two to four imperfections, so that even the exact law leaves much.

What the exact law leaves is measured, and the sizes of the imperfections are scaled, within their ranges, until it is 3
to 50 times the noise. An effect takes away at least as much power as it leaves: what is smaller nobody can name.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .base import log_uniform
from .dirt_of_the_force import OF_THE_FORCE
from .dirt_of_the_record import OF_THE_RECORD
from .dirt_of_the_rig import OF_THE_RIG
from .effects import EFFECTS
from .engine import Response
from .exact_law import Dirty, ExactLaw, Left, exact_law, held_out, left, without_effect
from .imperfection import Imperfection, Scene
from .recordings import run
from .suite import NONE, Spec
from .virtual import Trial, Virtual, draw

IMPERFECTIONS = {row.name: row for row in (*OF_THE_RIG, *OF_THE_FORCE, *OF_THE_RECORD)}
LEAST, MOST = 3.0, 50.0  # times the noise: what the exact law leaves
TRIES = 4  # rigs drawn with an effect, before it is another
SCALINGS = 4  # of the sizes of imperfections
DIRTS = 3  # times that imperfections are drawn for a rig, before another is
SHARE = 0.5  # of the power that the base leaves: what the effect explains, at least
CYCLES = (120.0, 300.0)  # natural cycles of the sweeps
#: Every experiment with every sensor that one would use there.
TRIALS = tuple(
    Trial(experiment, sensor)
    for experiment, sensors in {
        "decays": ("displacement", "acceleration", "camera"),
        "shaker": ("displacement", "acceleration", "camera"),
        "hammer": ("displacement", "acceleration"),
        "random": ("displacement", "acceleration"),
        "stepped": ("displacement", "acceleration", "camera"),
    }.items()
    for sensor in sensors
)
#: A zero of the sensor is free in every fit, so that it is no effect; where nothing drives the rig, neither are these.
NEVER, NOT_IN_DECAYS = {"sensor-offset"}, {"sensor-lag", "time-delay"}


class TooClean(Exception):
    """A rig that these imperfections do not bring into the range."""


@dataclass(frozen=True)
class Piece:
    """One imperfection of a rig: its row, its size, and what seeds the rest of it."""

    row: Imperfection
    size: float
    seed: int

    def scaled(self, factor: float) -> Piece:
        """The same with another size, within the range of its kind."""
        return replace(self, size=float(np.clip(self.size * factor, self.row.low, self.row.high)))


def _trial(seed: int, number: int) -> Trial:
    """Every experiment and sensor in turn."""
    order = np.random.default_rng([seed, 11, number // len(TRIALS)]).permutation(len(TRIALS))
    return TRIALS[order[number % len(TRIALS)]]


def candidate(seed: int, number: int, attempt: int) -> tuple[Spec, Trial]:
    """Give the rig to draw: every experiment in turn, every fourth with nothing but dirt, effects in turn.

    After `TRIES` attempts in vain it is the next effect.
    """
    trial = _trial(seed, number)
    rng = np.random.default_rng([seed, 12, number, attempt])
    noises = ["quantised"] if trial.quantity == "camera" else ["white", "white", "ar1", "pink", "quantised"]
    noise = str(rng.choice(noises))
    if number % 4 == 3:
        return Spec(NONE, (), (), noise, 1000 * number + attempt), trial
    undriven = trial.experiment == "decays"
    shown = [e.name for e in EFFECTS.values() if e.name not in NEVER]
    if undriven:
        shown = [name for name in shown if EFFECTS[name].path != "excitation" and name not in NOT_IN_DECAYS]
    before = sum((_trial(seed, i).experiment == "decays") == undriven for i in range(number) if i % 4 != 3)
    turn = before + attempt // TRIES
    names = np.random.default_rng([seed, 13, undriven, turn // len(shown)]).permutation(shown)
    effect = EFFECTS[str(names[turn % len(shown)])]
    variant = str(rng.choice(effect.variants))
    return Spec("single", (effect.name,), (variant,), noise, 1000 * number + attempt), trial


def draw_dirty(seed: int, number: int, cycles: tuple[float, float] = CYCLES, attempts: int = 200) -> Virtual:
    """Draw the dirty rig of that number, again until it is fit for a test.

    Raises RuntimeError where none of the `attempts` is.
    """
    for attempt in range(attempts):
        spec, trial = candidate(seed, number, attempt)
        try:
            clean = draw(spec, seed, cycles=cycles, attempts=10, trial=trial)
            return soil(clean, redraws=attempt)
        except (TooClean, RuntimeError):
            continue
    raise RuntimeError(f"none of {attempts} rigs was fit to be the dirty rig {number} of seed {seed}")


def _scene(virtual: Virtual, record: str, values: dict[str, float], piece: Piece) -> Scene:
    base = virtual.base
    full = base.amplitude * (base.stiffness if virtual.trial.quantity == "acceleration" else 1.0)
    own = np.random.default_rng([piece.seed, zlib.crc32(record.encode())])
    common = np.random.default_rng(piece.seed)
    return Scene(base, virtual.plans[record], values, record in virtual.trial.plan.held_out, full, common, own)


def dirty_recording(virtual: Virtual, record: str, pieces: tuple[Piece, ...]) -> Dirty:
    """Make one recording with these imperfections; raises RuntimeError where the rig runs away."""
    plan, base = virtual.plans[record], virtual.base
    values = virtual.rig(record, virtual.level)
    rest = np.zeros(plan.samples)
    for piece in pieces:
        scene = _scene(virtual, record, values, piece)
        if piece.row.rig:
            values = values | piece.row.rig(scene, piece.size)
        if piece.row.rest:
            rest = rest + piece.row.rest(scene, piece.size)
    response = run(lambda *_: values, base, record, plan, virtual.level, rest if rest.any() else None)
    clean = virtual.responses[record].force
    response = replace(response, force=clean.copy())  # its own clock is the force's
    for piece in pieces:
        if piece.row.record:
            response = piece.row.record(_scene(virtual, record, values, piece), piece.size, response)
    if not np.isfinite(response.shown).all():
        raise RuntimeError("not finite")
    astray = response.force - clean
    free = min(int(values["hand_at"] * base.fs), plan.samples) if values.get("hand_damping") else plan.samples
    return Dirty(response, astray if astray.any() else None, free)


def _fits(virtual: Virtual, row: Imperfection, parameters: set[str], seed: int) -> set[str] | None:
    """The parameters of rig.h that an imperfection takes, or None where it cannot be in this rig."""
    spec, trial = virtual.spec, virtual.trial
    undriven = trial.experiment == "decays"
    here = {
        "": True,
        "force": not undriven,
        "release": undriven,
        "displacement": trial.quantity != "acceleration",
        "acceleration": trial.quantity == "acceleration",
        "camera": trial.quantity == "camera",
    }
    if not here[row.needs] or set(spec.effects) & set(row.own):
        return None
    if not row.rig:
        return set()
    record = trial.plan.training[0]
    values = virtual.rig(record, virtual.level)
    takes = set(row.rig(_scene(virtual, record, values, Piece(row, row.low, seed)), row.low)) - set(
        virtual.base.parameters
    )
    return None if takes & parameters else takes


def _pieces(virtual: Virtual, rng: np.random.Generator) -> tuple[Piece, ...]:
    """Draw two to four imperfections that this rig can have side by side."""
    used = set(virtual.rig(virtual.trial.plan.training[0], virtual.level))
    wanted, pieces = int(rng.integers(2, 5)), []
    for name in rng.permutation(list(IMPERFECTIONS)):
        row, seed = IMPERFECTIONS[str(name)], int(rng.integers(0, 2**62))
        size = log_uniform(rng, row.low, row.high)
        takes = _fits(virtual, row, used, seed)
        if takes is not None and len(pieces) < wanted:
            used |= takes
            pieces.append(Piece(row, size, seed))
    return tuple(pieces)


def _scaled(
    virtual: Virtual, law: ExactLaw, pieces: tuple[Piece, ...], target: float
) -> tuple[tuple[Piece, ...], dict[str, Dirty], Left]:
    """Scale the imperfections until the exact law leaves `target` times the noise, or at least is within the range."""
    training, ratio = virtual.trial.plan.training, np.inf
    for scaling in range(SCALINGS):
        recordings = {name: dirty_recording(virtual, name, pieces) for name in training}
        found = left(law, recordings, virtual.base.noise)
        ratio = found.rms / virtual.base.noise
        others = tuple(piece.scaled(target / ratio) for piece in pieces)
        near = abs(np.log(ratio / target)) < np.log(2.0) or others == pieces or scaling == SCALINGS - 1
        if LEAST <= ratio <= MOST and near:
            return pieces, recordings, found
        if others == pieces:
            break
        pieces = others
    raise TooClean(f"the exact law leaves {ratio:.1f} times the noise")


def _clean(virtual: Virtual) -> dict[str, Dirty]:
    training = virtual.trial.plan.training
    return {name: Dirty(virtual.responses[name], None, virtual.plans[name].samples) for name in training}


def _left(law: ExactLaw, recordings: dict[str, Dirty]) -> float:
    """What a law leaves, in parts of the noise; without bounds where it runs away."""
    try:
        return left(law, recordings, law.virtual.base.noise).rms / law.virtual.base.noise
    except RuntimeError:
        return np.inf


def soil(virtual: Virtual, redraws: int = 0) -> Virtual:
    """Give the rig with imperfections drawn for it; what was measured of them is its `dirt`.

    Raises TooClean where they do not bring it into the range, or hide the effect; RuntimeError where it runs away.
    """
    rng = np.random.default_rng([*virtual.entropy, 5])
    base, most = None, MOST
    if virtual.spec.effects:
        base = exact_law(virtual, without_effect(virtual))
        most = min(MOST, _left(base, _clean(virtual)))
        if most < 1.5 * LEAST:
            raise TooClean(f"without the effect the base leaves {most:.1f} times the noise")
    law, problem = exact_law(virtual, virtual.rig), TooClean("")
    for _ in range(DIRTS):
        target = log_uniform(rng, LEAST, most)
        try:
            pieces, recordings, found = _scaled(virtual, law, _pieces(virtual, rng), target)
        except TooClean as too:
            problem = too
            continue
        ratio, share = found.rms / virtual.base.noise, None
        if base:
            share = 1.0 - (ratio / _left(base, recordings)) ** 2
        if share is None or share >= SHARE:
            return _soiled(virtual, law, pieces, recordings, found, share, rng, redraws)
        problem = TooClean(f"the effect explains {100 * share:.0f} % of what the base leaves")
    raise problem


def _soiled(
    virtual: Virtual,
    law: ExactLaw,
    pieces: tuple[Piece, ...],
    recordings: dict[str, Dirty],
    found: Left,
    share: float | None,
    rng: np.random.Generator,
    redraws: int,
) -> Virtual:
    """The recordings held out are made with the same imperfections, and what the exact law leaves there is measured."""
    held = {name: dirty_recording(virtual, name, pieces) for name in virtual.trial.plan.held_out}
    reachable = {name: held_out(law, found, name, one) for name, one in held.items()}
    dirt: dict[str, Any] = {
        "imperfections": [{"name": p.row.name, "size": p.size, "does": p.row.does} for p in pieces],
        "own": sorted({name for p in pieces for name in p.row.own}),
        "left_over_noise": found.rms / virtual.base.noise,
        "share": share,
        "reachable": reachable,
        "held": {name: _holds(virtual, rng) for name in virtual.plans},
    }
    responses = {name: _held(virtual, one, dirt["held"][name]) for name, one in (recordings | held).items()}
    return replace(virtual, responses=responses, dirt=dirt, redraws=redraws)


def _holds(virtual: Virtual, rng: np.random.Generator) -> int:
    """For how many samples a hand holds the rig before it lets go: in decays for three to twelve cycles."""
    if virtual.trial.experiment != "decays":
        return 0
    return int(rng.uniform(3.0, 12.0) * 2 * np.pi / virtual.base.omega * virtual.base.fs)


def _held(virtual: Virtual, dirty: Dirty, count: int) -> Response:
    response = dirty.response
    if not count:
        return response
    at_rest = 0.0 if virtual.trial.quantity == "acceleration" else float(response.shown[0])
    before = Response(np.zeros(count), np.full(count, response.x[0]), np.full(count, at_rest), 0, 0)
    force, x, shown = (
        np.concatenate([getattr(before, key), getattr(response, key)]) for key in ("force", "x", "shown")
    )
    return Response(force, x, shown, response.steps, response.events)
