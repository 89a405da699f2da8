"""What was said of recordings beside the given family, asked again beside the best structure.

How a force is held, and what of a rig differs between recordings, is found beside a family that may lack much: each may
only have stood in for that, or have been hidden by it. Beside the best structure both are asked once more. What is held
from sample to sample comes half a sample late, so that a lag within a sample is taken off before; the loss that goes
with it no lag explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import BadInput
from ..identify.faults.spread import ALIKE
from ..identify.fit.hold import hold_of_recordings, with_hold
from ..identify.fit.reported_result import Fit, delivered
from ..identify.problem.data import data_of
from ..model import Oscillator
from ..model.fit_state import LACKING
from ..model.terms import without_term
from ..recording.fact import changed
from ..recording.recording import Recording
from .case import Case
from .delivery import begun
from .search.found import Found
from .search.residual_test import leftovers


@dataclass(frozen=True)
class Change:
    """What a search is to begin again with.

    Attributes:
        hold: of the force.
        alike: whether nothing of the rig differs between its recordings.
    """

    hold: str | None = None
    alike: bool = False

    def of(self, recordings: Sequence[Recording]) -> list[Recording]:
        """The recordings with it."""
        made = list(recordings)
        if self.hold is not None:
            made = [changed(recording, hold=self.hold) for recording in made]
        return [changed(recording, differs=ALIKE) for recording in made] if self.alike else made

    def __str__(self) -> str:
        return (
            "as recordings of one rig, of which nothing differs" if self.alike else f"with a force of hold {self.hold}"
        )


def asked_again(case: Case, found: Found) -> Change | None:
    """What the recordings ask for beside the best structure of a search; None where that is as it was."""
    try:
        if _are_alike(case, found):
            return Change(alike=True)
        hold = _hold(case, found)
    except BadInput:  # nothing simulates there
        return None
    return None if hold in (None, "smooth") else Change(hold)


def _are_alike(case: Case, found: Found) -> bool:
    """Whether recordings that differ beside the family leave no more than before where they do not."""
    if not any(recording.differs not in ((), ALIKE) for recording in case.recordings):
        return False
    model = found.fitted.model
    apart, alike = (
        _fitted(case, found, recordings, model)
        for recordings in (case.recordings, Change(alike=True).of(case.recordings))
    )
    worst = [max(part.over_noise for part in fit.segments) for fit in (apart, alike)]
    return worst[1] <= max(worst[0], LACKING)


def _hold(case: Case, found: Found) -> str | None:
    """The hold that driven recordings ask for which were taken for smooth; None where there is no reason to ask."""
    driven = [recording for recording in case.recordings if recording.force is not None]
    said = any(recording.hold is not None for recording in case.given)
    if said or not driven or case.family.model.hold != "smooth":
        return None
    model, longest = found.fitted.model, max(recording.dt for recording in driven)
    for term in found.fitted.model.terms:
        if term.law.lags and abs(next(iter(term.parameters.values())).value) < longest:
            model = without_term(model, term.effect)
    left = leftovers(found.fitted, found.weighing.data)
    if len(model.terms) == len(found.fitted.model.terms) and not max(part.ratio for part in left) > LACKING:
        return None
    free = [changed(recording, hold=None) for recording in case.recordings]

    def answer(recordings: Sequence[Recording], known: Oscillator | None, *, doubted: bool) -> Fit:
        return _fitted(case, found, recordings, known or model, doubted=doubted)

    return hold_of_recordings(with_hold(answer(free, None, doubted=False), free, answer, doubted=False)[1])


def _fitted(
    case: Case, found: Found, recordings: Sequence[Recording], model: Oscillator, *, doubted: bool = False
) -> Fit:
    """A structure fitted finely to recordings, from where the search has left it."""
    shapes = [name for name in found.fitted.model.parameters() if name not in found.fitted.free]
    data = data_of(recordings, case.model, coarse=False)
    how = {"initial": begun(found.fitted, data), "memory": found.weighing.data.memory}
    return delivered(model, data, [name for name in shapes if name in model.parameters()], **how, doubted=doubted)
