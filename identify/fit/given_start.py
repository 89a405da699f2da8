"""Whether a start that somebody gives is one: a model of another rig, or in other units, leads nowhere for long."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...recording.recording import Recording
from ..problem.data import Data, data_of
from ..problem.structure import Structure
from ..start.limits import MEMORY
from .from_prediction import keeps_step


def leads(given: Oscillator, own: Oscillator, recordings: Sequence[Recording]) -> bool:
    """Whether a search may begin at a given model: over a cycle of the motion it predicts it, or as much as others do.

    A frequency that is a hundred times too high makes every step of a search a hundred times as long, and from there
    none leads back.

    Args:
        given: model that somebody gives.
        own: with the values that are estimated from the recordings.
        recordings: of one rig.
    """
    data = replace(data_of(recordings, own), memory=MEMORY)
    left = _left(given, data)
    return left is not None and (keeps_step(data.segments, left) or _power(left) <= _power(_left(own, data)))


def with_shared(model: Oscillator, other: Oscillator) -> Oscillator:
    """The model with the values of those parameters that another has as well; its laws keep their own."""
    known = model.parameters()
    shared = {name: p.value for name, p in other.parameters().items() if name in known}
    return model.with_parameters({name: replace(known[name], value=value) for name, value in shared.items()})


def _left(model: Oscillator, data: Data) -> tuple[np.ndarray, ...] | None:
    """What a prediction over a cycle leaves of each segment (n,); None where it does not run."""
    try:
        return Structure(model, data, tuple(model.parameters())).fit(most=0).residuals
    except BadInput:
        return None


def _power(left: Sequence[np.ndarray] | None) -> float:
    return np.inf if left is None else sum(float(np.sum(residual**2)) for residual in left)
