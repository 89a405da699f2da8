"""Whether the force of driven recordings is a voltage: they are braked more than free ones, and are else of one rig.

An electrodynamic shaker that is driven by a voltage brakes what it moves, by the square of its constant over the
resistance of its coil (back-EMF): with the voltage recorded as force the driven rig seems to have more viscous damping
than the same one has when it is let go with its coil open. A force that was measured knows no such difference.

So it is asked by one linearisation whether a step leaves much less with another viscous damping of what is driven than
without. Only then that is fitted, of each driven recording by itself, which must agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...recording.recording import Recording
from ..fit.reported_result import Fit
from ..fit.reweighted_fit import over_noise
from ..problem.data import noise_at
from ..problem.descent import search
from ..problem.linearised import Linearised
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.odds import ABOVE_NOISE, BEYOND_ERRORS
from ..signals.registry import budget
from .contradiction import Contradiction
from .fault import with_error
from .fault_score import with_sizes
from .fitted_problem import fitted_problem
from .limits import HALVED
from .spread import Deviation

_STEPS = budget(20, "steps", why="a search takes ten to twenty")


@dataclass(frozen=True)
class Braked:
    """Driven recordings that are braked more than free ones.

    Attributes:
        words: by the indices of the driven recordings.
        size: by how much more viscous they are.
    """

    words: dict[int, str]
    size: float

    def shift(self, names: Sequence[str]) -> np.ndarray:
        """(free,) by how much the parameters of these names may be off: nobody knows which damping is the rig's."""
        return np.array([self.size if name == "viscous" else 0.0 for name in names])


def back_emf(fit: Fit, recordings: Sequence[Recording], found: Contradiction) -> Braked | None:
    """What is said of the driven recordings; None where a measured force explains them.

    Args:
        fit: of these recordings.
        recordings: as they were fitted, driven ones and free ones.
        found: which part of them the rest contradicts: the search begins at what the rest says.
    """
    problem, _ = fitted_problem(fit, recordings)
    driven = sorted({segment.recording for segment in problem.segments if segment.force is not None})
    if not driven or all(segment.force is not None for segment in problem.segments) or "viscous" not in fit.names:
        return None
    state = found.state
    residuals = problem.residuals(state)
    flat = zip(problem.segments, found.levels, strict=True)
    noise = [NoiseSpectrum(np.full(segment.n // 2 + 1, level**2), segment.n) for segment, level in flat]
    linearised = Linearised.of(problem, state, residuals, noise)
    place = fit.names.index("viscous")
    columns = {i: linearised.columns[i][[place]] for i, s in enumerate(problem.segments) if s.force is not None}
    beside = linearised.beside(columns)
    step, plain = beside.step(), linearised.shared
    excess, without = beside.left(step) - beside.samples, plain.left(plain.step()) - plain.samples
    if not (step[-1] > 0.0 and excess < HALVED * without):
        return None
    braked = problem.with_faults([Deviation(i, parameter="viscous", typical=float(step[-1])) for i in driven])
    state = search(braked, with_sizes(braked, state), tolerance=0.1, most=_STEPS, informed=False).state
    residuals = braked.residuals(state)
    if not max(over_noise(braked, residuals, state, fit.oscillator, recordings)) <= ABOVE_NOISE:
        return None
    known = noise_at(braked, residuals, state, fit.oscillator)
    sums = Linearised.of(braked, state, residuals, known).shared
    sums = sums.without(slice(0, len(sums.gradient) - len(driven)))
    sizes, errors = state.offsets[-len(driven) :], sums.errors()
    # of one shaker
    error = float(np.sum(sums.normal)) ** -0.5
    size = float(np.sum(sums.normal @ sizes)) * error**2
    if np.any(np.abs(sizes - size) > BEYOND_ERRORS * errors) or not size > BEYOND_ERRORS * error:
        return None
    words = (
        f"driven, it is braked by {with_error(size, error)} {fit.oscillator.viscous.unit} more than what is free, and "
        "agrees with that in all else: so does a voltage that is taken for a force, whose shaker brakes the rig "
        "(back-EMF), or a damper that is there only when it is driven; record the force itself, or the current"
    )
    return Braked(dict.fromkeys(driven, words), size)
