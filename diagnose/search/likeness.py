"""Which laws act like those that were found: the others, put on the very motion that these make.

On the motion of a fitted model there is neither noise nor mismatch. With one of its laws taken out, or several at once,
what another law makes of the rest there says how nearly it could stand in their place, and with which values of
everything: the best start for that other structure, from which a few steps lead to its own maximum. Two laws that
together stand for a third are found out here: neither of them alone acts like it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from ...identify.problem.data import Data
from ...identify.problem.equivalent import along_of
from ...identify.problem.initial_motion import initial_states
from ...identify.problem.offset import zeros_along
from ...identify.problem.prediction import FREE
from ...identify.problem.structure import Fitted, Structure, without_states
from ...model.law import Law
from ...model.library import find
from ...model.terms import without_term
from ...recording.fact import changed
from .starts import Proposal, by_motion


def alike(fitted: Fitted, data: Data, laws: Collection[str], others: Sequence[Law]) -> list[Proposal]:
    """Laws in the place of those that a fitted model has, the one that acts most like them first.

    Args:
        fitted: to ``data``.
        data: training recordings.
        laws: which of the model's are exchanged, all for one.
        others: what may stand in their place.
    """
    smaller = fitted
    for law in laws:
        smaller = replace(smaller, model=without_term(smaller.model, law), initial=without_states(smaller, law))
    if smaller.initial.shape != fitted.initial.shape:  # their own states made part of the motion's beginning
        shown = [float(np.mean(zeros_along(data.offsets, fitted.offsets, s)[0])) for s in data.segments]
        smaller.initial[:, :2] = initial_states(data.segments, shown)
    sensors = any(find(law).record is not None for law in laws)
    seen = not sensors and any(segment.order for segment in data.segments) and data.memory == FREE
    proposals = by_motion(smaller, (_as_moved if seen else _as_simulated)(fitted, data), others)
    return sorted(proposals, key=lambda proposal: -proposal.gain)


def moves_along(law: Law) -> bool:
    """Whether a law may act like another: not what has a phase of its own, nor what must be sought from many places."""
    return not law.rugged and not along_of(law).phases


def _as_moved(fitted: Fitted, data: Data) -> Data:
    """The recordings as displacements of the model: what integrating an acceleration loses is known here.

    Blows and the jumps of friction are most of what an accelerometer shows, and little of the motion.
    """
    structure = Structure(fitted.model, data)
    state = structure.state(fitted.initial, fitted.offsets)
    moved = [np.zeros(recording.n) for recording in data.recordings]
    for i, segment in enumerate(data.segments):
        moved[segment.recording][segment.start : segment.stop] = structure.problem.states(i, state)[:, 0]
    unit, pairs = fitted.model.response.displacement_unit, zip(data.recordings, moved, strict=True)
    recordings = [changed(r, response=x, quantity="displacement", unit=unit) for r, x in pairs]
    noise = tuple(sigma / s.pace**s.order for sigma, s in zip(data.sensor, data.segments, strict=True))
    return replace(data, recordings=tuple(recordings), sensor=noise)


def _as_simulated(fitted: Fitted, data: Data) -> Data:
    """The recordings as the model makes them, the sensors' zeros and noise taken off."""
    responses = [np.array(recording.response, float) for recording in data.recordings]
    for segment, residual in zip(data.segments, fitted.residuals, strict=True):
        shown, _ = zeros_along(data.offsets, fitted.offsets, segment)
        responses[segment.recording][segment.start : segment.stop] = segment.response - residual - shown
    recordings = [changed(r, response=response) for r, response in zip(data.recordings, responses, strict=True)]
    return replace(data, recordings=tuple(recordings))
