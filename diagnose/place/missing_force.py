"""The missing force beside what the named effects make of it, over time, displacement and velocity.

Both stand on the same ground: the family's own terms with the values of the *mended* model. A fit of the family alone
bends its terms around what is missing, so that a drag shows as what is left of it beside a wrong viscous damping;
on the mended values the smoother, which knows no law, must find the named force itself, or the name is wrong. Where
nothing was named there are no better values than the family's best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...errors import DashpotError
from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted
from ...identify.signals.registry import budget, shown
from ...model import Oscillator
from ...model.equations import equations
from ...model.oscillator import Term
from ...recording.smoothing import analytic_of
from ..result import LatentForce
from .model_force import term_force
from .smoother import Smoothed, Smoother

_RECORDINGS = shown(3, "recordings", why="as many as a page shows")
_LOOKED_AT = budget(6, "segments", why="those with the most beyond their noise are smoothed, to choose from")
_SHOWN = shown(4000, "samples", why="as many as a picture shows")


def latent_forces(before: Fitted, data: Data, named: Oscillator | None) -> tuple[LatentForce, ...]:
    """The missing force in the recordings, at most three, that show it best.

    Args:
        before: the best fit of the given family.
        data: what it was fitted to.
        named: the mended model; its terms that the family lacks are the named effects.

    Returns:
        One stretch a recording, that where the force is largest. ``named`` in them is None where nothing was named,
        or where an effect sits in the sensor and is no force. The standard deviation is the smoother's; the
        uncertainty of the family's own parameters is not in it.
    """
    family, effects = before.model, ()
    if named is not None:
        own = {term.effect for term in before.model.terms}
        effects = tuple(term for term in named.terms if term.effect not in own)
        family = replace(named, terms=tuple(term for term in named.terms if term.effect in own))
    candidates: list[tuple[float, int, LatentForce]] = []
    for i in _loudest_first(before.residuals, data.sensor)[:_LOOKED_AT]:
        try:
            smoother = Smoother(family, data, i)
            first, last = _stretch(smoother)
            smoothed = smoother.smooth(first, last, prior=smoother.most_likely(first, min(last, first + _SHOWN)))
        except (DashpotError, np.linalg.LinAlgError):
            continue
        law = _named(effects, family, smoother, smoothed, first, last)
        name = data.recordings[data.segments[i].recording].name
        clear = float(np.mean(smoothed.force**2) / max(float(np.mean(smoothed.std**2)), 1e-300))
        candidates.append((clear, data.segments[i].recording, _shown(name, smoothed, law)))
    chosen: dict[int, LatentForce] = {}
    for _, recording, force in sorted(candidates, key=lambda candidate: -candidate[0]):
        if recording not in chosen and len(chosen) < _RECORDINGS:
            chosen[recording] = force
    return tuple(chosen[recording] for recording in sorted(chosen))


def _loudest_first(residuals: Sequence[np.ndarray], noise: Sequence[float]) -> list[int]:
    """Places of residuals (n,) by how far they stand out of their noise; what runs away, or has no noise, is first."""
    sizes = [
        float(np.linalg.norm(r)) / level if level > 0 else np.inf for r, level in zip(residuals, noise, strict=True)
    ]
    return sorted(range(len(sizes)), key=lambda i: -sizes[i] if np.isfinite(sizes[i]) else -np.inf)


def _stretch(smoother: Smoother) -> tuple[int, int]:
    """Where the missing force is largest, found by a first look at the whole segment."""
    if smoother.n <= _SHOWN:
        return 0, smoother.n
    whole = smoother.smooth()
    power = np.concatenate([[0.0], np.cumsum(np.where(whole.moving, whole.force**2, 0.0))])
    first = int(np.argmax(power[_SHOWN:] - power[:-_SHOWN]))
    return first, first + _SHOWN


def _shown(name: str, smoothed: Smoothed, law: np.ndarray | None) -> LatentForce:
    return LatentForce(
        file=name,
        time=smoothed.time,
        displacement=smoothed.displacement,
        velocity=smoothed.velocity,
        force=smoothed.force,
        std=smoothed.std,
        named=law,
    )


def _named(
    effects: tuple[Term, ...], family: Oscillator, smoother: Smoother, smoothed: Smoothed, first: int, last: int
) -> np.ndarray | None:
    """(n,) what the effects make of the measured motion; None where there is none or one is no force."""
    if not effects or any(term.law.record is not None for term in effects):
        return None
    mass = 1.0 if family.mass is None else family.mass.value
    motion, step = smoother.along(mass)
    parts = round(smoother.dt / step)
    total = np.zeros(last - first)
    drive = motion[:, 3]
    for term in effects:
        if term.law.drive is not None:
            drive = term_force(term, np.column_stack([motion[:, :3], drive]), step)
            continue
        force = term_force(term, motion, step)[::parts][first:last]
        total += _in_phase(force, smoothed.force - total) if _free(term, family) else force
    return total + (motion[:, 3] - drive)[::parts][first:last] / mass


def _free(term: Term, family: Oscillator) -> bool:
    """Whether the force has a phase of its own in each recording."""
    return any(state.free for state in equations(replace(family, terms=(term,))).inner)


def _in_phase(force: np.ndarray, smoothed: np.ndarray) -> np.ndarray:
    """A periodic force with the phase that suits what the smoother found; its size is the law's."""
    analytic = analytic_of(force)
    turn = complex(np.vdot(analytic, smoothed))
    return np.real(analytic * turn / abs(turn)) if abs(turn) > 0 else force
