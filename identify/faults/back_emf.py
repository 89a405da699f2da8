"""Whether the force of driven recordings is a voltage: they are braked more than free ones, and are else of one rig.

An electrodynamic shaker that is driven by a voltage brakes what it moves, by the square of its constant over the
resistance of its coil (back-EMF): with the voltage recorded as force the driven rig seems to have more viscous damping
than the same one has when it is let go with its coil open. A force that was measured knows no such difference.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...model import Oscillator
from ...recording.recording import Recording
from ..fit.likelihood import maximum_likelihood
from ..fit.reported_result import Fit
from ..signals.odds import BEYOND_ERRORS
from .fault import with_error
from .stranger_among import KEPT, Fitted, of_one_rig

#: What a lab cannot keep constant, as of ``KEPT``: a stiffness goes with the square of the frequency.
_CHANGED = 2.0 * KEPT


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


def back_emf(recordings: Sequence[Recording], fitted: Fitted) -> Braked | None:
    """What is said of the driven recordings; None where a measured force explains them.

    Args:
        recordings: driven ones and free ones, which contradict each other.
        fitted: the fit of the driven ones alone, from starts of their own.
    """
    driven = [index for index, recording in enumerate(recordings) if recording.force is not None]
    free = [index for index in range(len(recordings)) if index not in driven]
    if not driven or not free:
        return None
    forced = of_one_rig([recordings[index] for index in driven], fitted)
    let_go = None if forced is None else of_one_rig([recordings[index] for index in free], _beside(forced.oscillator))
    if forced is None or let_go is None or not (excess := braked(forced, let_go)):
        return None
    size, error, unit = excess
    words = (
        f"driven, it is braked by {with_error(size, error)} {unit} more than what is free, and agrees with that in all "
        "else: so does a voltage that is taken for a force, whose shaker brakes the rig (back-EMF), or a damper that "
        "is there only when it is driven; record the force itself, or the current"
    )
    return Braked(dict.fromkeys(driven, words), size)


def _beside(model: Oscillator) -> Fitted:
    """The fit of free recordings next to a model, whose damping is found first: friction that lets them swing once
    more or less makes a minimum of each, and from other starts the search may end in any.
    """

    def fitted(recordings: Sequence[Recording]) -> Fit:
        others = tuple(name for name in model.parameters() if name != "viscous")
        braked = maximum_likelihood(model, recordings, others, doubted=False, near=True)
        return maximum_likelihood(braked.oscillator, recordings, ("mass",), doubted=False, near=True)

    return fitted


def braked(forced: Fit, let_go: Fit) -> tuple[float, float, str] | None:
    """By how much more viscous the forced fit is, with its error and unit; None where that is not all that differs."""
    here, there = forced.oscillator.parameters(), let_go.oscillator.parameters()
    apart = {
        name: (p.value - there[name].value, math.hypot(p.std, there[name].std or math.inf))
        for name, p in here.items()
        if p.std and name in there
    }
    size, error = apart.pop("viscous", (0.0, 1.0))
    others = all(
        abs(off) <= max(BEYOND_ERRORS * std, _CHANGED * abs(here[name].value)) for name, (off, std) in apart.items()
    )
    return (size, error, here["viscous"].unit) if others and size > BEYOND_ERRORS * error else None
