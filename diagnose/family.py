"""The best that the given family can do: what every law is held against, and what the sensors show at zero."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import BadInput
from ..identify.faults.spread import differing, is_let_go, with_spread
from ..identify.faults.stranger_among import KEPT
from ..identify.fit.from_prediction import keeps_step, memories
from ..identify.fit.hold import held_as
from ..identify.fit.likeliest_modes import odds
from ..identify.fit.likelihood import maximum_likelihood
from ..identify.fit.mismatch import gain_of_mismatch
from ..identify.identification import LEADS_NOWHERE, Identification, identify
from ..identify.problem.data import Data, data_of
from ..identify.problem.offset import FoundOffset, Offset
from ..identify.problem.prediction import FREE
from ..identify.problem.structure import Fitted, Structure
from ..identify.signals.odds import DECISIVE, HALF_AGAIN
from ..model import Oscillator
from ..model.terms import linear, with_term, without_hold
from ..recording.fact import changed
from ..recording.recording import Recording
from .limits import OTHER_FREQUENCY, OTHER_MASS, POORLY_KNOWN
from .measuring_chain import agree, drifts_and_loads, hold_of
from .measuring_chain import drifts as drifts_of
from .measuring_chain import zeros as zeros_of
from .result import ChainFact
from .search.residual_test import Leftover, leftovers
from .search.search import best_of_family

_LOAD = "constant-force"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Family:
    """The family's best fit.

    Attributes:
        model: with the values found.
        memory: how far it predicts, in cycles; see ``identify.prediction``.
        recordings, holdout: less what their sensors show at zero, with the hold of their force.
        free_zeros: whether each recording's zero is free in every fit.
        drifts: of the training recordings' sensors, taken off and free in every fit: what a family took for a drift
            may be what it lacks.
        notes: what a user should know.
        chain: what the measuring chain does, but for the sensors' zeros.
        shown, shown_elsewhere: what was taken off from the response of training recordings and of those held out.
    """

    model: Oscillator
    memory: float
    recordings: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    free_zeros: bool
    drifts: tuple[Offset, ...]
    notes: tuple[str, ...]
    chain: tuple[ChainFact, ...] = ()
    shown: Mapping[int, float] = field(default_factory=dict)
    shown_elsewhere: Mapping[int, float] = field(default_factory=dict)


def family_of(model: Oscillator, recordings: Sequence[Recording], holdout: Sequence[Recording]) -> Family:
    """Fit the given family to the training recordings, from the model's values or, where these are of no use, anew.

    Raises:
        BadInput: where the recordings are not of the model's rig.
    """
    notes: list[str] = []
    chain: list[ChainFact] = []
    identification = _from(model, recordings)
    known = identified_from(model, recordings)
    anew = (
        identification is not None
        and not known
        and LEADS_NOWHERE in identification.notes
        and abs(math.log(model.omega0.value / identification.oscillator.omega0.value)) > math.log(OTHER_FREQUENCY)
    )
    # where its values explain little the search began at the recordings' too; only the laws it has beside, never anew
    if identification is None or (model.terms and not known and not _in_step(identification)):
        effects = [term.effect for term in model.terms]
        again = identify(recordings, name=model.name, effects=effects, doubted=False)
        if identification is None or _left(again) < _left(identification) - math.log(2.0):
            identification, anew = again, True
    assert identification is not None
    if anew:
        notes.append("the values in the model file lead nowhere near these recordings: all were found anew from them")
    identification, recordings, holdout = _as_they_differ(identification, recordings, holdout)
    notes += identification.differs
    best = replace(identification.oscillator, amplitude=model.amplitude, frequency=model.frequency)
    if any(mine.hold != given.hold for mine, given in zip(identification.recordings, recordings, strict=True)):
        recordings, holdout = identification.recordings, held_as(holdout, best.hold)
    if best.hold != "smooth":
        chain.append(hold_of(best.hold, found=best.hold != model.hold))
    if not known:
        notes += _same_rig(model, best, slide=identification.fit.segments[0].segment.slide)
    # what is missing adds up over time: the longer the memory, the more of it shows
    memory = (
        FREE if identification.fit.memory == FREE else max(memories([s.segment for s in identification.fit.segments]))
    )
    recordings, taken = _without_drift_and_force(recordings, identification.fit.offsets)
    chain += drifts_and_loads(recordings, taken)
    drifts = _drifts(recordings, identification.fit.offsets)
    shown = {o.recording: o.value for o in identification.fit.offsets if o.channel == "response"}
    if len(recordings) > 1 and (not shown or _is_loaded(identification)):
        return Family(best, memory, tuple(recordings), tuple(holdout), False, drifts, tuple(notes), tuple(chain))
    elsewhere = _offsets(best, holdout)
    return Family(
        best,
        memory,
        tuple(_less(r, shown.get(i, 0.0)) for i, r in enumerate(recordings)),
        tuple(_less(r, elsewhere.get(i, 0.0)) for i, r in enumerate(holdout)),
        True,
        drifts,
        tuple(notes),
        tuple(chain),
        shown,
        elsewhere,
    )


def _as_they_differ(
    identification: Identification, recordings: Sequence[Recording], holdout: Sequence[Recording]
) -> tuple[Identification, Sequence[Recording], Sequence[Recording]]:
    """The family's fit beside what differs between all recordings, and these with it: see ``differing``.

    Those that are held out are judged with it too: a rig whose frequency moved between two blows lacks no physics. Of
    driven ones it is asked where those that are not held out differ already: it takes a fit of all.
    """
    asked = any(recording.differs for recording in recordings)
    free = all(is_let_go(s.segment) for s in identification.fit.segments)
    if asked or not holdout or not (free or any(recording.differs for recording in identification.recordings)):
        return identification, _with_what_differs(recordings, identification.recordings), holdout
    every, fit = [*recordings, *holdout], identification.fit
    how = {"fixed": [name for name in fit.oscillator.parameters() if name not in fit.names], "doubted": False}
    try:
        alike = maximum_likelihood(fit.oscillator, every, **how, near=True)
        found = differing(alike, every)
        if found is None:
            return identification, _with_what_differs(recordings, identification.recordings), holdout
        each, mean = found
        apart = maximum_likelihood(mean, each, **how, near=True)
        if not odds(apart, alike) > DECISIVE:
            return identification, recordings, holdout
        words = with_spread(apart, each)[1]
    except BadInput:  # not all of them simulate
        return identification, recordings, holdout
    recordings, holdout = each[: len(recordings)], each[len(recordings) :]
    return replace(_from(mean, recordings) or identification, differs=words), recordings, holdout


def _with_what_differs(recordings: Sequence[Recording], fitted: Sequence[Recording]) -> list[Recording]:
    """Recordings with what was found to differ in them."""
    return [changed(given, differs=own.differs) for given, own in zip(recordings, fitted, strict=True)]


def identified_from(model: Oscillator, recordings: Sequence[Recording]) -> bool:
    """Whether the model file's values were found from these very recordings: then there are no others to find."""
    known = {entry.get("sha256") for entry in model.identified.recordings} - {None, ""}
    return bool(known) and {recording.sha256 for recording in recordings} <= known


def _from(model: Oscillator, recordings: Sequence[Recording]) -> Identification | None:
    if model.identified.recordings:  # the hold was asked for when it was identified
        recordings = held_as(recordings, model.hold)
    try:
        near = identified_from(model, recordings)
        return identify(recordings, name=model.name, start=model, doubted=False, near=near)
    except BadInput:  # it does not simulate from there
        return None


def _in_step(identification: Identification) -> bool:
    segments = identification.fit.segments
    return keeps_step([s.segment for s in segments], [s.segment.response - s.simulated for s in segments])


def _left(identification: Identification) -> float:
    return float(np.mean([np.log(max(s.nrmse, 1e-300)) for s in identification.fit.segments]))


def _is_loaded(identification: Identification) -> bool:
    """Whether a load explains decisively more than what the sensors may show at zero: the motion itself shows it.

    Where it explains no more, a law in the place of zeros would take what is missing. Where all ring down freely the
    zeros stay free, and a load is begun in their place (``by_zeros``): both may be there, and one alone tells badly.
    """
    if all(is_let_go(part.segment) for part in identification.fit.segments):
        return False
    fit, model = identification.fit, identification.oscillator
    found = {offset.recording: offset.value for offset in fit.offsets if offset.channel == "response"}
    if model.response.quantity != "displacement" or found.keys() < {s.segment.recording for s in fit.segments}:
        return False
    start = with_term(model, _LOAD, {"load": model.omega0.value**2 * float(np.mean([*found.values()]))})
    try:
        loaded = identify(identification.recordings, start=start, doubted=False, near=True).fit
    except BadInput:
        return False
    if [s.segment.start for s in fit.segments] != [s.segment.start for s in loaded.segments]:
        return False
    # the one that tells less may have lost the last swings
    shorter = [min(a.segment, b.segment, key=lambda s: s.n) for a, b in zip(fit.segments, loaded.segments, strict=True)]
    before, after = (
        [s.response - fitted.simulated[: s.n] for s, fitted in zip(shorter, some.segments, strict=True)]
        for some in (fit, loaded)
    )
    return bool(gain_of_mismatch(before, after, shorter)[0][0] > DECISIVE)


def _offsets(model: Oscillator, recordings: Sequence[Recording]) -> dict[int, float]:
    """What the sensors of recordings show at zero beside a model that stays as it is."""
    if not recordings:
        return {}
    fit = maximum_likelihood(model, recordings, tuple(model.parameters()))
    return {offset.recording: offset.value for offset in fit.offsets if offset.channel == "response"}


def _without_drift_and_force(
    recordings: Sequence[Recording], offsets: Sequence[FoundOffset]
) -> tuple[list[Recording], list[FoundOffset]]:
    """Recordings less the drifts of their sensors and, where these differ, the zeros of their load cells; what it was.

    The same in all is a load on the mass as well, and is looked for among laws (``constant-force``).
    """
    forces = [offset for offset in offsets if offset.channel == "force"]
    driven = sum(r.force is not None and bool(np.any(r.force)) for r in recordings)
    loaded = driven > 1 and agree(forces, driven)
    corrected, taken = list(recordings), []
    for offset in offsets:
        r = corrected[offset.recording]
        if offset.channel == "drift":
            line = offset.value * (np.asarray(r.time, float) - offset.middle)
            corrected[offset.recording] = changed(r, same_motion=True, response=np.asarray(r.response, float) - line)
            taken.append(offset)
        elif offset.channel == "force" and not loaded and r.force is not None:
            corrected[offset.recording] = changed(r, force=np.asarray(r.force, float) - offset.value)
            taken.append(offset)
    return corrected, taken


def _less(recording: Recording, shown: float) -> Recording:
    less = np.asarray(recording.response, float) - shown
    return changed(recording, same_motion=True, response=less) if shown else recording


def _drifts(recordings: Sequence[Recording], offsets: Sequence[FoundOffset]) -> tuple[Offset, ...]:
    """The offsets that a fit needs where drifts were taken off; their zero goes with them."""
    drifts = []
    for offset in offsets:
        if offset.channel == "drift":
            drifts.append(Offset.of(recordings, offset.recording, "response"))
            drift = Offset.of(recordings, offset.recording, "drift", middle=offset.middle)
            drifts.append(replace(drift, taken=offset.value))
    return tuple(drifts)


def cut_for(family: Family, recordings: Sequence[Recording], model: Oscillator, *, judged: bool = False) -> Data:
    """Recordings as every law is fitted to them or, held out, ``judged`` on them."""
    data = replace(data_of(recordings, model), memory=family.memory)
    used = sorted({segment.recording for segment in data.segments})
    offsets = () if judged else tuple(offset for offset in family.drifts if offset.recording in used)
    if family.free_zeros:
        there = {offset.recording for offset in offsets}
        zeros = (Offset.of(data.recordings, i, "response") for i in used if i not in there)
        offsets = (*zeros, *offsets)
    shown = family.shown_elsewhere if judged else family.shown
    offsets = tuple(
        replace(offset, taken=shown.get(offset.recording, 0.0)) if offset.channel == "response" else offset
        for offset in offsets
    )
    return replace(data, offsets=offsets)


def less_offsets(
    recordings: Sequence[Recording], shown: Mapping[int, float], data: Data, values: np.ndarray
) -> tuple[list[Recording], list[ChainFact]]:
    """Recordings less what the sensors of each were found to show beside a model, and what that is in all.

    Args:
        recordings: of which ``shown`` was taken off before.
        data: what they were cut to, with their offsets.
        values: of these, as fitted.
    """
    corrected, zeros, rates = list(recordings), dict(shown), {}
    for offset, value in zip(data.offsets, values, strict=True):
        if offset.channel == "response":
            zeros[offset.recording] = zeros.get(offset.recording, 0.0) + float(value)
        else:
            rates[offset.recording] = offset.taken + float(value)
        recording = corrected[offset.recording]
        line = value * offset.along(np.asarray(recording.time))
        less = np.asarray(recording.response, float) - line
        corrected[offset.recording] = changed(recording, same_motion=True, response=less)
    return corrected, zeros_of(recordings, zeros) + drifts_of(recordings, rates)


def first_fit(data: Data, holdout: Data | None, model: Oscillator) -> tuple[Fitted, Data, Data | None]:
    """The family on the training recordings: simulated or, where no simulation runs to its end, predicted.

    Also returned are both with the longest memory that does. Raises BadInput where none does.
    """
    for memory in (data.memory, *reversed(memories(data.segments))):
        near = replace(data, memory=memory)
        for start in (model, without_hold(model), linear(model)):
            try:
                fitted = best_of_family(start, near)
            except BadInput as problem:  # it does not simulate from there
                _log.info("the family, with a memory of %g cycles: %s", memory, problem)
                continue
            if fitted.finite:
                return fitted, near, None if holdout is None else replace(holdout, memory=memory)
    raise BadInput("no model of this family simulates along these recordings; check the units of force and response")


def _same_rig(given: Oscillator, identified: Oscillator, *, slide: bool) -> list[str]:
    """Notes where a model that does not claim to know its rig is far from what the recordings show.

    A slide, moved as its force moves it, has no natural frequency to compare.

    Raises:
        BadInput: where one that does know it is: the recordings are of another.
    """
    apart = []
    if not slide and _differ(identified.omega0.value, given.omega0.value, OTHER_FREQUENCY):
        apart.append("omega0")
    if (
        given.mass is not None
        and identified.mass is not None
        and _differ(identified.mass.value, given.mass.value, OTHER_MASS)
    ):
        apart.append("mass")
    if not apart:
        return []
    mass = "" if identified.mass is None else f" and {identified.mass.value:.4g} {identified.mass.unit}"
    given_mass = "" if given.mass is None else f" and {given.mass.value:.4g} {given.mass.unit}"
    figures = (
        f"they show {identified.omega0.value / (2 * math.pi):.4g} Hz{mass}, "
        f"the model has {given.omega0.value / (2 * math.pi):.4g} Hz{given_mass}"
    )
    if any(_is_known(given, name) for name in apart):
        raise BadInput(f"the recordings are not of the model's rig: {figures}; identify a model from them first")
    return [f"the recordings are far from the model file, which does not say that it knows its rig: {figures}"]


def _differ(value: float, other: float, factor: float) -> bool:
    ratio = value / other
    return ratio <= 0.0 or abs(math.log(ratio)) > math.log(factor)


def _is_known(model: Oscillator, name: str) -> bool:
    """Whether a model claims to know a parameter: by a small standard error, or as kept while the rest was identified.

    A value without either was written by hand or could not be identified.
    """
    parameter = model.parameters()[name]
    if parameter.std is not None:
        return parameter.std < POORLY_KNOWN * abs(parameter.value)
    return bool(model.identified.recordings) and name not in model.identified.parameters


def stranger(final: Fitted, data: Data, holdout: Data | None, left: Sequence[Leftover]) -> str | None:
    """A sentence where a model of their own explains the held-out recordings well, but this one does not.

    Args:
        final: the best structure on the training recordings.
        data, holdout: training recordings and those held out, cut into segments.
        left: what it leaves in each segment of both, those held out last.
    """
    ratios, training = [leftover.ratio for leftover in left], len(data.segments)
    if holdout is None:
        return None
    if max(ratios[:training]) > HALF_AGAIN or max(ratios[training:]) < HALF_AGAIN**2:
        return None
    worst: dict[str, float] = {}
    for leftover in left[training:]:
        worst[leftover.file] = max(leftover.ratio, worst.get(leftover.file, 0.0))
    if min(worst.values()) < HALF_AGAIN:  # another rig shows in each; one alone may jump where small changes decide
        return None
    own = Structure(final.model, holdout).fit(settle=True)
    again = [leftover.ratio for leftover in leftovers(own, holdout)]
    if not own.finite or 2 * max(again) > max(ratios[training:]):
        return None
    here, there = final.model, own.model
    if not _moved(here, there, slide=data.segments[0].slide):
        return None
    words = [f"{there.omega0.value / (2 * math.pi):.4g} Hz instead of {here.omega0.value / (2 * math.pi):.4g} Hz"]
    if here.mass is not None and there.mass is not None:
        words.append(f"{there.mass.value:.4g} {there.mass.unit} instead of {here.mass.value:.4g} {here.mass.unit}")
    names = ", ".join(recording.name for recording in holdout.recordings)
    return (
        f"the held-out recordings ({names}) agree with a model of their own ({', '.join(words)}) and not with the one "
        "of the training recordings: they are of another rig, or the rig was changed between; no effect is named"
    )


def _moved(here: Oscillator, there: Oscillator, *, slide: bool) -> bool:
    """Whether frequency or mass differ by more than a thousandth, about what a lab can keep constant."""
    ratios = [] if slide else [there.omega0.value / here.omega0.value]
    if here.mass is not None and there.mass is not None:
        ratios.append(there.mass.value / here.mass.value)
    return any(ratio <= 0.0 or abs(math.log(ratio)) > KEPT for ratio in ratios)
