"""The cause of a residual above the noise: which part of which recording is inconsistent, and by which fault."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from ...errors import BadInput
from ...recording.recording import Recording
from ..fit.reported_result import Fit
from ..signals.limits import SEVERAL
from ..signals.odds import ABOVE_NOISE, is_noise
from .back_emf import back_emf
from .contradiction import Contradiction, contradiction, covering
from .fault_score import KINDS, OF_A_WHOLE
from .faults_found import faults_found
from .part import Part
from .part_kinds import kind_of_part
from .stranger_among import difference_in_words, of_one_rig, stranger_among
from .unlike_parts import shifts_of, unlike_in_words, unlike_parts


@dataclass(frozen=True, eq=False)
class Explanation:
    """Why a fit leaves more than noise.

    Attributes:
        fit: with errors that cover what the inconsistent part may have done to the parameters.
        faults: by the recordings' indices, what the measuring chain did.
        notes: one sentence each on what may be a fault or the rig's own.
    """

    fit: Fit
    faults: dict[int, str]
    notes: tuple[str, ...]


def explain_residual(
    fit: Fit,
    recordings: Sequence[Recording],
    *,
    asked: bool,
    alone: Callable[[Sequence[Recording]], Fit] | None,
) -> Explanation:
    """Find the fault or the inconsistent part behind the residual of a fit.

    Faults cost several fits. So their kinds are tried where the normal equations show that all the rest contradicts a
    part of the recordings, or where a user asks for them.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
        asked: whether kinds of faults are asked for in any case.
        alone: the fit of some of them from starts of their own; None where one may not be of another rig.
    """
    if not max(s.over_noise for s in fit.segments) > ABOVE_NOISE:
        return _of_parts(fit, recordings)
    alone = alone and _once(alone)
    squares, samples = np.array([(s.over_noise**2, s.segment.n) for s in fit.segments]).T
    by_chance = is_noise(squares, samples)
    if not by_chance and (bent := _of_parts(fit, recordings)).notes:
        return bent
    found = contradiction(fit, recordings)
    if found is None and alone is not None:
        found = _from_the_others(fit, recordings, alone)
    if found is None and not asked:
        return _of_parts(fit, recordings) if by_chance else Explanation(fit, {}, ())
    if found is not None and alone is not None and (braked := back_emf(fit, recordings, found)) is not None:
        return Explanation(covering(fit, (*found.shifts, braked.shift(fit.names))), braked.words, ())
    faults = _faults_in_words(fit, recordings, found, alone)
    if found is None:
        return Explanation(fit, faults, ())
    fit = covering(fit, found.shifts)
    if faults:
        or_else = _or_else(found, recordings)
        return Explanation(fit, {index: words + or_else for index, words in faults.items()}, ())
    words = in_words(found, recordings)
    name = found.part.recording
    return (
        Explanation(fit, {name: words}, ())
        if found.reached
        else Explanation(fit, {}, (f"{recordings[name].name}: {words}",))
    )


def _once(alone: Callable[[Sequence[Recording]], Fit]) -> Callable[[Sequence[Recording]], Fit]:
    """The same, but the fit of the same recordings is made once, whichever question asks for it."""
    known = cache(alone)
    return lambda recordings: known(tuple(recordings))


def _of_parts(fit: Fit, recordings: Sequence[Recording]) -> Explanation:
    """Parts that contradict each other where only noise is left, or one channel explains the residual."""
    found = unlike_parts(fit, recordings)
    if not found:
        return Explanation(fit, {}, ())
    return Explanation(covering(fit, shifts_of(found)), {}, (unlike_in_words(found, fit, recordings),))


def _from_the_others(
    fit: Fit, recordings: Sequence[Recording], alone: Callable[[Sequence[Recording]], Fit]
) -> Contradiction | None:
    """What is contradicted where all recordings but one agree to their noise, seen from their model.

    A faulty one may have misled the search so far that the normal equations say nothing there. Two that disagree
    do not say which of them is right.
    """
    known = fit.oscillator.parameters()
    for odd in _may_be_odd(fit, recordings, alone) if len(recordings) >= SEVERAL else ():
        theirs = of_one_rig([recording for index, recording in enumerate(recordings) if index != odd], alone)
        if theirs is None or theirs.oscillator.mass is None:
            continue
        values = {key: replace(p, value=theirs.oscillator.parameters()[key].value) for key, p in known.items()}
        found = contradiction(replace(fit, oscillator=fit.oscillator.with_parameters(values)), recordings)
        if found is not None:
            moved = np.array([values[key].value - known[key].value for key in fit.names])
            return replace(found, shifts=tuple(shift + moved for shift in found.shifts))
    return None


def _may_be_odd(
    fit: Fit, recordings: Sequence[Recording], alone: Callable[[Sequence[Recording]], Fit]
) -> Sequence[int]:
    """Places of the recordings whose others may agree: one that leaves more than noise by itself is among none such.

    Where physics is missing two that say so are enough, and those that show it most are asked first.
    """
    worst = dict.fromkeys(range(len(recordings)), 0.0)
    for stretch in fit.segments:
        index = stretch.segment.recording
        worst[index] = max(worst[index], stretch.over_noise)
    failing: list[int] = []
    for index in sorted(worst, key=lambda index: -worst[index]):
        try:
            own = alone([recordings[index]])
        except BadInput:
            continue  # too little to say anything by itself
        if max(stretch.over_noise for stretch in own.segments) > ABOVE_NOISE:
            failing.append(index)
        if len(failing) == 2:
            return ()
    return failing or range(len(recordings))


def _faults_in_words(
    fit: Fit,
    recordings: Sequence[Recording],
    found: Contradiction | None,
    alone: Callable[[Sequence[Recording]], Fit] | None,
) -> dict[int, str]:
    """By the recordings' indices, what the measuring chain did to one, or that it is of another rig."""
    suspect = None if found is None or found.other is not None or not found.part.whole else found.part.recording
    own = None if suspect is None or alone is None else of_one_rig([recordings[suspect]], alone)
    # what agrees with a rig of its own has no fault that begins somewhere, and no line or wave on it
    faults = faults_found(fit, recordings, found, KINDS if own is None else OF_A_WHOLE)
    if faults:
        return {fault.fault.recording: fault.words for fault in faults}
    if alone is not None and own is not None and suspect is not None:
        words = difference_in_words(suspect, own, recordings, alone, alike=found is not None and found.reached)
        if words is not None:
            return {suspect: words}
    if found is not None and (kind := kind_of_part(found, fit, recordings)) is not None:
        return {found.part.recording: kind}
    odd = None if alone is None or own is not None else stranger_among(recordings, alone)
    return {} if odd is None else {odd[0]: odd[1]}


def _or_else(found: Contradiction, recordings: Sequence[Recording]) -> str:
    """That another recording may be the one at fault, where all the rest agrees without it as well; else nothing."""
    other = found.other
    if other is None or other.recording == found.part.recording:
        return ""
    name = recordings[other.recording].name
    return f"; or {name} is the one that is not right{_place(other, ' ').rstrip()}: without it the rest agrees as well"


def in_words(found: Contradiction, recordings: Sequence[Recording]) -> str:
    """What is contradicted, where, and what may be the cause: a sentence of the part's recording."""
    part, other = found.part, found.other
    if other is None:
        rest = "all other recordings agree with" if part.whole else "all the rest agrees with"
        words = f"{_place(part)}it does not agree with the one model that {rest} to the noise"
    elif other.recording == part.recording:
        earlier, later = sorted((part, other), key=lambda p: p.begin)
        words = f"what it shows {_place(earlier)}and what it shows {_place(later)}contradict each other"
    else:
        words = (
            f"{_place(part)}it contradicts {recordings[other.recording].name}{_place(other, ' ').rstrip()}, and the "
            "rest agrees with either"
        )
    if found.reached:
        return (
            f"{words}; the rest moves as far and as little and is driven as hard, so no lack of physics does that: the "
            "measuring chain or the rig changed; look there, and use what is sound (--part FROM:TO)"
        )
    return (
        f"{words}; nothing else moves as far and as little and is driven as hard, so either the measuring chain or the "
        "rig changed, or physics is missing that shows there alone (dashpot diagnose asks for it); the standard errors "
        "cover what it does to the parameters"
    )


def _place(part: Part, before: str = "") -> str:
    """Where a part lies, with a blank behind it; nothing where it is all of its recording."""
    if part.whole:
        return ""
    if part.first == 0:
        return f"{before}until {part.end:.4g} s "
    if part.last == part.span.pieces:
        return f"{before}from {part.begin:.4g} s on "
    return f"{before}from {part.begin:.4g} to {part.end:.4g} s "
