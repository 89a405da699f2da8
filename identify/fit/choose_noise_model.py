"""What a fit is held against: a linear rig, and what chance makes of least squares."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from ...model import Oscillator
from ..problem.descent import search
from ..problem.output_error import OutputError, State
from ..problem.search_point import Outcome
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.odds import BY_CHANCE
from ..signals.registry import budget
from ..start.linear_fit import linear_fit

_STEPS = budget(
    8,
    "steps",
    why=(
        "from the closed form of the linear rig to its simulation; the force between samples is a little "
        "different there"
    ),
)
_LINEAR = ("mass", "omega0", "viscous")


def plain_cost(residuals: Sequence[np.ndarray]) -> float:
    """Negative log-likelihood of what is left in white noise of unknown level, one a segment; inf where not finite."""
    power = [float(np.mean(residual**2)) for residual in residuals]
    if not np.all(np.isfinite(power)):
        return np.inf
    tiny = np.finfo(float).tiny
    return sum(0.5 * r.size * float(np.log(max(p, tiny))) for r, p in zip(residuals, power, strict=True))


def linear_state(problem: OutputError, state: State, start: Oscillator) -> State | None:
    """The best linear rig as a point of a structure's search; None where the structure holds none.

    Args:
        problem: the structure's, with its free parameters.
        state: any point of it.
        start: the structure.
    """
    names = tuple(start.parameters())
    values, linear = state.values.copy(), []
    strengths = {f"{t.effect}.{p.name}" for t in start.terms for p in t.law.parameters if p.strength}
    if any(not any(p.strength for p in term.law.parameters) for term in start.terms):
        return None  # a law that never vanishes
    for place, name in enumerate(names):
        if name in ("cubic", "preload", "dry") or name in strengths:
            if place not in problem.free and values[place] != 0.0:
                return None
            values[place] = 0.0
    fit = linear_fit(problem.segments)
    if fit is None:
        return None
    for name in _LINEAR:
        known = getattr(fit, name)
        if name in names and (place := names.index(name)) in problem.free:
            linear.append(place)
            values[place] = values[place] if known is None else known
    if problem.bounds is not None:
        values = np.clip(values, *problem.bounds)
    initial = np.zeros_like(state.initial)
    for i, segment in enumerate(problem.segments):
        own = problem.free_states(segment)
        initial[i, 2:] = state.initial[i, 2:]
        initial[i, [k for k in (0, 1) if k in own]] = fit.initial[i, [k for k in (0, 1) if k in own]]
    shown = state.offsets.copy()
    for k, offset in enumerate(problem.offsets):
        own_offsets = [fit.offsets[i] for i, s in enumerate(problem.segments) if s.recording == offset.recording]
        if offset.channel == "response" and own_offsets:
            shown[k] = float(np.mean(own_offsets))
    point = State(values, initial, shown)
    if not np.isfinite(plain_cost(problem.residuals(point))):
        return None
    return search(_only(problem, linear), point, tolerance=0.1, most=_STEPS, informed=False).state


def _only(problem: OutputError, free: Sequence[int]) -> OutputError:
    """The same problem with fewer free parameters."""
    other = copy(problem)
    other.free = tuple(free)
    other.shared = len(other.free) + len(other.offsets)
    return other


def by_chance(problem: OutputError, plain: Outcome, remainders: Sequence[NoiseSpectrum]) -> float:
    """By how much the cost of a right model's own values may exceed that of least squares.

    What least squares takes from the noise is its part in the space of the derivatives; of noise with a spectrum that
    is a sum of squares, each times what the noise has there, here as a gamma variable of its mean and variance
    (Satterthwaite 1946).

    Args:
        problem: what was fitted.
        plain: its least squares.
        remainders: spectra of what they leave.
    """
    from scipy.special import chdtri

    mean = square = 0.0
    for rows, residual, spectrum in zip(
        problem.derivatives(plain.state, plain.residuals), plain.residuals, remainders, strict=True
    ):
        rows = rows[np.any(rows != 0.0, axis=1)]
        size = np.linalg.norm(rows, axis=1, keepdims=True)
        basis = np.linalg.qr((rows / size).T)[0].T
        coloured = spectrum.colour(basis)
        parts = coloured @ coloured.T / max(float(np.mean(residual**2)), np.finfo(float).tiny)
        mean += float(np.trace(parts))
        square += float(np.sum(parts**2))
    if not mean > 0.0:
        return 0.0
    return 0.5 * square / mean * float(chdtri(mean**2 / square, BY_CHANCE))
