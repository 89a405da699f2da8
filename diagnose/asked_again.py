"""What was said of recordings beside the given family, asked again beside the best structure.

How a force is held, and what of a rig differs between recordings, is found beside a family that may lack much: each may
only have stood in for that, or have been hidden by it. Beside the best structure both are asked once more. What is held
from sample to sample comes half a sample late, so that a lag within a sample is taken off before; the loss that goes
with it no lag explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from ..errors import BadInput
from ..identify.faults.spread import alike
from ..identify.fit.hold import hold_of_recordings, with_hold
from ..identify.fit.likeliest_modes import odds
from ..identify.fit.reported_result import Fit
from ..identify.signals.odds import DECISIVE
from ..model import Oscillator
from ..model.fit_state import LACKING
from ..model.oscillator import HOLDS
from ..model.terms import without_term
from ..recording.fact import changed
from ..recording.recording import Recording
from .case import Case
from .delivery import refitted
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
        if self.hold is not None:
            recordings = [changed(recording, hold=self.hold) for recording in recordings]
        return alike(recordings) if self.alike else list(recordings)

    def __str__(self) -> str:
        held = "" if self.hold is None else f"with a force that is {HOLDS[self.hold]}"
        return "as recordings of a rig in which nothing differs" if self.alike else held


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
    """Whether recordings that differ beside the family leave no more at their worst where none does.

    Where only noise is left so, the odds decide. Beside a structure that lacks much these would say of any two
    recordings that they differ.
    """
    if not any(size for recording in case.recordings for _, size in recording.differs):
        return False
    fit = partial(refitted, found.fitted, case.model, memory=found.weighing.data.memory, compared=True)
    apart, same = fit(case.recordings), fit(alike(case.recordings))
    left, left_so = (max(part.over_noise for part in one.segments) for one in (apart, same))
    return left_so <= left if left_so > LACKING else not odds(apart, same) > DECISIVE


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
    fit = partial(refitted, found.fitted, case.model, memory=found.weighing.data.memory, compared=True)

    def answer(recordings: Sequence[Recording], known: Oscillator | None, *, doubted: bool) -> Fit:
        return fit(recordings, known or model, doubted=doubted)

    return hold_of_recordings(with_hold(fit(free, model), free, answer, doubted=False)[1])
