"""A structure of the search as ``identify`` delivers it: fitted finely, with standard errors and provenance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from ..errors import BadInput
from ..identify.faults.spread import with_spread
from ..identify.fit.hold import hold_of_recordings, with_hold
from ..identify.fit.reported_result import Fit, delivered
from ..identify.problem.data import data_of
from ..identify.problem.prediction import FREE
from ..identify.problem.structure import Fitted, renamed
from ..identify.provenance import with_provenance
from ..model import Oscillator
from ..model.library import find
from ..recording.fact import changed
from ..recording.recording import Recording
from .search.judgement import names_of


def refitted(
    fitted: Fitted,
    cut_by: Oscillator,
    recordings: Sequence[Recording],
    known: Oscillator | None = None,
    *,
    memory: float = FREE,
    doubted: bool = False,
    compared: bool = False,
) -> Fit:
    """A structure of a search, whose simulations are coarser, fitted finely to recordings from where it was left.

    Args:
        fitted: of a search.
        cut_by: the model by whose frequency the recordings are cut.
        recordings: to fit it to.
        known: the structure elsewhere, or less one of its laws; None: as it was left.
        memory: how far it predicts, in cycles.
        doubted: whether its errors hold what predictions say otherwise.
        compared: whether it is only compared with others, and its errors are those of the linearised response.

    Raises:
        BadInput: a finer simulation does not run.
    """
    model = known or fitted.model
    shapes = [name for name in model.parameters() if name not in fitted.free]
    data = data_of(recordings, cut_by, coarse=False)
    # those whose zeros were taken off since may be cut elsewhere
    initial = fitted.initial if len(fitted.initial) == len(data.segments) else None
    return delivered(model, data, shapes, initial=initial, memory=memory, doubted=doubted, compared=compared)


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
    answer = partial(refitted, fitted, cut_by, memory=memory, compared=not named)
    try:
        if hold_is_free:
            recordings = [changed(recording, hold=None) for recording in recordings]
        fit = answer(recordings, doubted=named)
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
