"""The problem whose answer a fit is, made again: what is asked of a fit afterwards begins there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...recording.recording import Recording
from ..fit.reported_result import Fit
from ..problem.data import data_of
from ..problem.offset import Offset
from ..problem.output_error import OutputError, State
from ..problem.structure import Structure


def fitted_problem(fit: Fit, recordings: Sequence[Recording]) -> tuple[OutputError, State]:
    """The problem of a fit, simulated as coarsely as models are compared, and its state.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
    """
    model = fit.oscillator
    data = data_of(recordings, model, coarse=True)
    fixed = [name for name in model.parameters() if name not in fit.names]
    offsets = [Offset.of(recordings, o.recording, o.channel, middle=o.middle) for o in fit.offsets]
    structure = Structure(model, data, fixed, offsets)
    problem = structure.problem.over([s.segment for s in fit.segments]).coarsely()
    values = np.array(list(model.values().values()))
    initial = np.array([s.initial for s in fit.segments])
    return problem, State(values, initial, np.array([found.value for found in fit.offsets]))
