"""What chance takes away: any smooth function of the motion explains a part of what any other one leaves.

Far from the noise a law is never exact, and one that is not there at all takes its part of the mismatch. How much that
may be depends on the motion alone: of a narrow range of amplitudes nearly all functions look alike. So functions of
displacement and velocity are drawn at random and held against what a model leaves as a law would be; "none of these"
may take as much away as all but the best twentieth of them. A law that leads a search has to beat one of them; a name
has to beat as many together as it has unknowns, parameters and initial states, more than what is held against it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...identify.problem.data import Data, equivalent_of
from ...identify.problem.linearised import Linearised, Sums
from ...identify.problem.normal_equations import pseudo_inverse
from ...identify.problem.structure import Fitted
from ...identify.signals.noise_spectrum import NoiseSpectrum
from ...identify.signals.registry import budget, numerics
from ..limits import GROUP, LEAST_DAMPING
from .weigh import linearised_at

_DRAWN = budget(30, "functions", why="whose largest twentieth is known to some hundredths of the power")
_WAVES = numerics(12, "cosines", why="of which a random smooth function is made: nearly a Gaussian process")
_ROUGH = numerics(0.7, "of the largest amplitude", why="the length over which it changes: that of a cubic or of a bend")
_MOST = numerics(0.99, "of the power", why="what is left is never nothing")


def by_chance(fitted: Fitted, data: Data, count: int) -> float:
    """Part of the power that a model leaves which random smooth forces of the motion take away, 0 to 1.

    Args:
        fitted: a model that leaves a mismatch.
        data: what it was fitted to.
        count: of forces together.
    """
    asked, rng = _drawn(fitted, data), np.random.default_rng(1)
    some = min(count, _DRAWN)
    shares = []
    for first in range(_DRAWN):
        others = rng.permutation(np.delete(np.arange(_DRAWN), first))[: some - 1]
        taken = np.array([first, *others], int)
        gradient = asked.gradient[taken]
        gained = gradient @ pseudo_inverse(asked.normal[np.ix_(taken, taken)]) @ gradient
        shares.append(gained / max(asked.power, np.finfo(float).tiny))
    return float(np.clip(np.quantile(shares, GROUP), 0.0, _MOST))


@lru_cache(maxsize=8)
def _drawn(fitted: Fitted, data: Data) -> Sums:
    """What a model leaves, along each of the forces that are drawn, less what its own parameters can imitate."""
    structure, state, slopes = linearised_at(fitted, data, fitted.free)
    problem, values = structure.problem, fitted.model.values()
    level = float(np.mean(np.concatenate(fitted.residuals) ** 2))
    flat = [NoiseSpectrum(np.full(r.size // 2 + 1, level), r.size) for r in fitted.residuals]
    here = Linearised.of(problem, state, fitted.residuals, flat, slopes)
    rng = np.random.default_rng(0)
    along = rng.normal(size=(_DRAWN, _WAVES, 2)) / _ROUGH
    phase, size = rng.uniform(0.0, 2.0 * np.pi, (_DRAWN, _WAVES)), rng.normal(size=(_DRAWN, _WAVES))
    columns = {}
    for i, segment in enumerate(data.segments):
        x, v = problem.states(i, state)[:, :2].T / data.scales.length
        motion = np.stack([x, v / segment.pace])
        stiffness, damping = equivalent_of(segment, values)
        damping = max(abs(damping), 2.0 * LEAST_DAMPING * segment.pace)
        omega = 2.0 * np.pi * np.fft.rfftfreq(2 * segment.n, segment.dt)
        passed = (1j * omega) ** segment.order / (stiffness - omega**2 + 1j * omega * damping)
        forces = np.array([s @ np.cos(w @ motion + p[:, None]) for w, p, s in zip(along, phase, size, strict=True)])
        made = np.fft.irfft(np.fft.rfft(forces, 2 * segment.n, axis=1) * passed, axis=1)[:, : segment.n]
        columns[i] = made / np.sqrt(level)
    return here.beside(columns).without(here.shared_rows)
