"""A structure of the search as ``identify`` delivers it: fitted finely, with standard errors and provenance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..identify.faults.spread import with_spread
from ..identify.fit.hold import hold_of_recordings, with_hold
from ..identify.fit.reported_result import Fit, delivered
from ..identify.problem.data import Data, data_of
from ..identify.problem.structure import Fitted, renamed
from ..identify.provenance import with_provenance
from ..model import Oscillator
from ..model.library import find
from ..recording.fact import changed
from ..recording.recording import Recording
from .search.judgement import names_of


def finely(fitted: Fitted, cut_by: Oscillator, recordings: Sequence[Recording]) -> Oscillator:
    """A structure of a search as it would be delivered, but for what predictions say otherwise.

    Raises BadInput where a finer simulation does not run.
    """
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]
    data = data_of(recordings, cut_by, coarse=False)
    return delivered(fitted.model, data, shapes, initial=begun(fitted, data), doubted=False).oscillator


def begun(fitted: Fitted, data: Data) -> np.ndarray | None:
    """The initial states of a search; None where its recordings, their zeros taken off since, are cut elsewhere."""
    return fitted.initial if len(fitted.initial) == len(data.segments) else None


def with_errors(
    fitted: Fitted,
    cut_by: Oscillator,
    recordings: Sequence[Recording],
    memory: float,
    *,
    named: bool = False,
    hold_is_free: bool = False,
) -> tuple[Oscillator, list[str]]:
    """The model of a search as ``identify`` delivers it, with standard errors, validity and provenance; and notes.

    Args:
        fitted: of a search, whose simulations are coarser.
        cut_by: the model by whose frequency the recordings were cut.
        recordings: that it was fitted to.
        memory: how far it predicts, in cycles.
        named: whether it is delivered, and its errors hold what predictions say otherwise, or only compared with.
        hold_is_free: whether the recordings' hold was found beside a family that lacks something, and is asked anew.
    """
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]

    def answer(recordings: Sequence[Recording], known: Oscillator | None, *, doubted: bool) -> Fit:
        data = data_of(recordings, cut_by, coarse=False)
        initial = begun(fitted, data)
        return delivered(known or fitted.model, data, shapes, initial=initial, memory=memory, doubted=doubted)

    try:
        if hold_is_free:
            recordings = [changed(recording, hold=None) for recording in recordings]
        fit = answer(recordings, None, doubted=named)
        if hold_is_free:
            fit, recordings, _ = with_hold(fit, recordings, answer, doubted=named)
    except BadInput as problem:  # a finer simulation may turn over where a coarser did not
        plain = replace(fitted.model, hold=hold_of_recordings(recordings))
        return plain, [f"the errors of the parameters are not known: {problem}"]
    model = with_provenance(with_spread(fit, recordings)[0], recordings)
    model = replace(
        model,
        amplitude=fitted.model.amplitude or model.amplitude,
        frequency=fitted.model.frequency or model.frequency,
        hold=hold_of_recordings(recordings),
    )
    return model, list(fit.notes)


def named(fitted: Fitted, laws: Sequence[str]) -> Fitted:
    """The fit with every law that was added under the name that suits its values."""
    suiting = {term.effect: names_of(term, fitted.model)[0] for term in fitted.model.terms if term.effect in laws}
    for name in laws:
        if suiting[name] != name:
            fitted = renamed(fitted, name, find(suiting[name]))
    return fitted
