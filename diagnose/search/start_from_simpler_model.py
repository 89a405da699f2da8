"""From a start to where its simulation may follow the recordings: over predictions with longer and longer memory."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from ...errors import DashpotError
from ...identify.fit.from_prediction import EARLY_STEPS, memories
from ...identify.problem.data import Data
from ...identify.problem.segments import Segment
from ...identify.problem.settle import follows
from ...identify.problem.structure import Structure
from ...model import Oscillator


def led(model: Oscillator, data: Data, fixed: Sequence[str]) -> Oscillator:
    """A model some steps further at each memory, from a cycle to the length of the recordings.

    Args:
        model: structure and start values.
        data: what it is fitted to, whatever its memory.
        fixed: names of parameters that keep their values.
    """
    for memory in memories(data.segments):
        with suppress(DashpotError, np.linalg.LinAlgError):  # nothing is predicted as long as that
            model = Structure(model, replace(data, memory=memory), fixed).fit(most=EARLY_STEPS).model
    return model


def any_lost(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> bool:
    """Whether a simulation has lost the motion of one of the segments, noise aside.

    A rig that friction holds where the recorded one moves shows so: what it leaves depends on nothing, and no step
    leads from there.
    """
    return any(
        not follows(float(np.sqrt(np.mean(residual**2))), segment.response, segment.noise)
        for segment, residual in zip(segments, residuals, strict=True)
    )
