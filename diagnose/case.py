"""The first step of a diagnosis: what it is about, as one frozen value that the other steps read.

Recordings are checked and those that carry nothing are left out. The given family is fitted to the others, so that
zeros and drifts of their sensors can be taken off. Where the user holds nothing out, stretches of each recording are.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import BadInput
from ..identify.identification import belong_together
from ..identify.problem.data import Data
from ..model import Oscillator
from ..model.library import take_installed_laws
from ..recording.given import recordings_of
from ..recording.recording import Recording
from .family import Family, cut_for, family_of
from .measuring_chain import known_faults
from .measuring_chain import zeros as zeros_of
from .recordings import carries, same_quantity, split, why_unused
from .result import ChainFact

#: Called with what is being done and how much of all is done, 0 to 1.
Progress = Callable[[str, float], None]

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Case:
    """What a diagnosis is about.

    Attributes:
        model: as given; recordings are cut by its frequency.
        given: all recordings as they were given, those left out among them.
        recordings, holdout: to fit to and to judge by, as the family corrected them.
        uncut: those to fit to, before stretches of them were held out.
        in_pieces: whether nothing was held out by the user, so that stretches of each recording are.
        family: the best that the given family does.
        data, judged: the recordings cut into segments; ``judged`` is None where nothing could be held out.
        notes: what a user should know, in order.
        chain: what the measuring chain does.
    """

    model: Oscillator
    given: tuple[Recording, ...]
    recordings: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    uncut: tuple[Recording, ...]
    in_pieces: bool
    family: Family
    data: Data
    judged: Data | None
    notes: tuple[str, ...]
    chain: tuple[ChainFact, ...]

    def noted(self, *notes: str) -> Case:
        """The same with further notes."""
        return replace(self, notes=(*self.notes, *notes))


def prepare(
    model: Oscillator,
    recordings: Sequence[Recording] | Any,
    holdout: Sequence[Recording] | Any,
    progress: Progress,
) -> Case:
    """Check recordings, fit the given family to them, and say what is held out.

    Args:
        model: gives the family, and values to start from.
        recordings, holdout: to fit to and to judge by; also what ``recordings_of`` reads.
        progress: called with what is being done and how much of all is done.

    Raises:
        BadInput: where the recordings are not of this model's rig, or cannot carry a diagnosis.
    """
    notes = list(take_installed_laws())
    recordings, holdout = recordings_of(recordings), recordings_of(holdout)
    given = [*recordings, *holdout]
    belong_together(given)
    same_quantity(model, given)
    unused = [why_unused(r, model) for r in given if not carries(r, model)]
    notes += [f"{why}; it was left out" for why in unused]
    recordings, holdout = ([r for r in group if carries(r, model)] for group in (recordings, holdout))
    if not recordings:
        raise BadInput(
            f"no recording can carry a diagnosis ({'; '.join(unused)}); record a decay of at least ten cycles or a "
            "sweep through the resonance"
        )
    progress("best of the given family", 0.0)
    best = family_of(model, recordings, holdout)
    notes += best.notes
    chain = [*known_faults(model, given), *best.chain]
    whole, elsewhere, in_pieces = best.recordings, best.holdout, not best.holdout
    training, held = list(whole), list(elsewhere)
    if in_pieces:
        chain += zeros_of(whole, best.shown)
        training, held = split(whole, model)
        # what the family took for zero and drift may be what it lacks: each piece has a zero of its own beside that
        best = replace(best, free_zeros=True, drifts=(), shown={})
        notes.append(
            "no recording was held out, so stretches of each that can spare them are: judge with one of another level"
            if held
            else "nothing could be held out: what is named rests on the recordings that it was fitted to; judge with "
            "a recording of another level"
        )
    data = cut_for(best, training, model)
    if data.segments[0].slide:
        notes.append(
            "no spring holds this rig near its place: it is fitted in pieces of a cycle each; in the table, over whole "
            "recordings, what little the model lacks adds up"
        )
    # cut as the training was, whatever the fit made of the spring
    judged = cut_for(best, held, model, judged=True) if held else None
    for recording in training:
        _log.info("%s: fitted to", recording.name)
    for recording in held:
        _log.info("%s: held out", recording.name)
    return Case(
        model=model,
        given=tuple(given),
        recordings=tuple(training),
        holdout=tuple(held),
        uncut=whole,
        in_pieces=in_pieces,
        family=best,
        data=data,
        judged=judged,
        notes=tuple(notes),
        chain=tuple(chain),
    )
