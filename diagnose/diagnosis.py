"""Model against recordings: what is missing, where, what it is, the mended model, what to record next."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.fit.hold import hold_of_recordings, with_hold
from ..identify.fit.reported_result import Fit, delivered
from ..identify.identification import belong_together
from ..identify.problem.data import Data, data_of
from ..identify.problem.prediction import FREE
from ..identify.problem.structure import Fitted, renamed
from ..identify.provenance import with_provenance
from ..model import Oscillator
from ..model.law import Law
from ..model.library import KNOWN, find, take_installed_laws
from ..recording.fact import changed
from ..recording.given import recordings_of
from ..recording.recording import Recording
from .changed_rig import changed_rig
from .experiment.next_experiment import next_experiment
from .experiment.separated_by import separated_by
from .family import cut_for, family_of, first_fit, identified_from, less_offsets, stranger
from .in_one_run import told_best_in_one_run
from .insignificant_laws import of_unknown_size, without_needless
from .measuring_chain import hold_of, known_faults
from .measuring_chain import zeros as zeros_of
from .place.locate import locate
from .place.missing_force import latent_forces
from .plainer import with_plainer_laws
from .recordings import carries, same_quantity, split, why_unused
from .refit_on_all import FITTED_TO_ALL, fitted_to_all
from .repair_trial import exported, follows_any, no_finding, record_fits, unmended
from .result import SURE, Considered, Diagnosis, Effect
from .search.candidate import STAGES, Candidate, key
from .search.judgement import leaves_mismatch, names_of, only_a_name, standing, why_not
from .search.residual_test import leftovers, nearer
from .search.residual_test import sentence as remainder_sentence
from .search.search import Search
from .search.weigh import forget
from .search.weigh import judged as judged_by
from .verdict import explained_share, sentence_of, verdict_of

#: The law of a sensor that sits elsewhere all the time.
_SENSOR_OFFSET = "sensor-offset"


def diagnose(
    model: Oscillator,
    recordings: Sequence[Recording] | Any,
    holdout: Sequence[Recording] | Any = (),
    *,
    fmu: Path | None = None,
    progress: Callable[[str, float], None] = lambda _what, _part: None,
) -> Diagnosis:
    """Find what physics a model lacks that recordings show.

    Args:
        model: gives the family: Eq. 17 and whatever terms it has; its values are where the fit starts.
        recordings: to fit to; here and in ``holdout`` also what ``recordings_of`` reads.
        holdout: of another level or kind, to judge by; where there are none, stretches of each recording that can
            spare them are held out.
        fmu: where to write the mended model as an FMU; a temporary place where None.
        progress: called with what is being done and how much of all is done, 0 to 1.

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
    recordings, holdout = list(best.recordings), list(best.holdout)
    pieces, uncut = not holdout, recordings
    if pieces:
        chain += zeros_of(recordings, best.shown)
        recordings, holdout = split(recordings, model)
        # what the family took for zero and drift may be what it lacks: each piece has a zero of its own beside that
        best = replace(best, free_zeros=True, drifts=(), shown={})
        notes.append(
            "no recording was held out, so stretches of each that can spare them are: judge with one of another level"
            if holdout
            else "nothing could be held out: what is named rests on the recordings that it was fitted to; judge with "
            "a recording of another level"
        )
    data = cut_for(best, recordings, model)
    if data.segments[0].slide:
        notes.append(
            "no spring holds this rig near its place: it is fitted in pieces of a cycle each; in the table, over whole "
            "recordings, what little the model lacks adds up"
        )
    # cut as the training was, whatever the fit made of the spring
    judged = cut_for(best, holdout, model, judged=True) if holdout else None
    laws = [law for law in KNOWN.values() if best.zeros_are_shared or law.effect != _SENSOR_OFFSET]
    search = Search(data, judged, laws, progress=lambda what, part: progress(what, 0.05 + 0.8 * part))
    family = first_fit(search, best.model)
    memory = search.data.memory
    selected = search.from_family(family)
    family = search.candidates[()].fit or family
    if search.data.memory == FREE and len(selected.laws) > 1 and not leaves_mismatch(selected, search.parts):
        progress("whether all laws are needed", 0.85)
        selected = without_needless(selected, search, lambda fitted: _finely(fitted, model, recordings))
    selected = with_plainer_laws(selected, search)
    if pieces and len(selected.laws) > 1:
        selected = told_best_in_one_run(selected, search, replace(cut_for(best, uncut, model), memory=FREE))
    forget()
    fitted = selected.fit or family
    # what is left is said of simulations: a prediction leaves less
    data = replace(search.data, memory=FREE)
    held = None if search.holdout is None else replace(search.holdout, memory=FREE)
    final = fitted if search.data.memory == FREE else judged_by(fitted.model, data)
    family_free = family if memory == FREE else judged_by(family.model, data)
    left, before_left = leftovers(final, data), leftovers(family_free, data)
    recordings, zeros = less_offsets(recordings, best.shown, data, final.offsets)
    if best.drifts:  # as the best structure says, and no longer the family
        chain = [fact for fact in chain if fact.what != "drift"]
    chain += [] if pieces else zeros
    if held is not None:
        told = judged_by(fitted.model, held)
        holdout, zeros = less_offsets(holdout, best.shown_elsewhere, held, told.offsets)
        chain += [] if pieces else zeros
        left += leftovers(told, held)
        before_left += leftovers(judged_by(family.model, held), held)
    other_rig = stranger(fitted, search, left, len(data.segments))
    if other_rig:
        notes.append(other_rig)
    progress("standard errors", 0.86)
    before, after = _delivered(family, model, recordings, memory, []), None
    named = _named(fitted, selected.laws)
    if selected.laws and not other_rig:
        # beside what still lacks something the hold would be asked for in vain once more
        free = all(recording.hold is None for recording in given) and not remainder_sentence(left)
        after = _delivered(named, model, recordings, search.data.memory, notes, named=True, hold_is_free=free)
        if after.hold != before.hold:  # which was found beside what the family lacks
            recordings, holdout, uncut = (
                [changed(r, hold=after.hold) for r in group] for group in (recordings, holdout, uncut)
            )
            chain = [fact for fact in chain if fact.what != "hold"] + [hold_of(after.hold, found=True)]
        # the search may have ended where a stretch is lost that the delivered fit follows
        told = [leftovers(judged_by(after, part), part) for part in (data, held) if part is not None]
        left = nearer(left, sum(told, ()))
    progress("the mended model on every recording, as an FMU on those held out", 0.9)
    with TemporaryDirectory() as folder:
        artefact = exported(after, Path(folder) / "model.fmu") if after is not None else None
        records = record_fits(before, after, recordings, holdout=False)
        records += record_fits(before, after, holdout, holdout=True, fmu=artefact)
        if after is not None and (why := no_finding(records, explained_share(before_left, left))):
            # however much more probable than the others
            after, records = None, [unmended(record) for record in records]
            notes.append(f"the most probable structure ({' + '.join(selected.laws)}) {why}: no effect is named")
        elif after is not None:
            if pieces and holdout:
                progress("the mended model, fitted to what was held out too", 0.93)
                fixed = [name for name in after.parameters() if name not in named.free]
                if whole := fitted_to_all(after, uncut, fixed):
                    after, artefact = whole, exported(whole, Path(folder) / "all.fmu")
                    notes.insert(0, FITTED_TO_ALL)
            if artefact is not None and fmu is not None:
                shutil.move(artefact, fmu)
    if after is not None:
        known = {term.effect for term in model.terms}
        notes += of_unknown_size(after, tuple(term.effect for term in after.terms if term.effect not in known))
    rugged = [law for law in selected.laws if find(law).rugged]
    if after is not None and rugged and remainder_sentence(left):
        notes.append(
            f"the likelihood of {' + '.join(rugged)} has many side valleys and this fit rests in one of them, above "
            "the noise: its parameters may be off by far more than their errors"
        )
    if after is None:
        left = before_left
        if not other_rig and not follows_any([record for record in records if record.holdout]):
            notes += filter(None, [changed_rig(recordings, holdout)])
    remainder = remainder_sentence(left)
    effects: tuple[Effect, ...] = ()
    kept = before
    if after is not None:
        effects = _effects(selected, search, after)
    elif pieces:  # a fit to a part of what there is is held against the rest, and no reason to leave that of all
        kept = model if identified_from(model, given) else best.model
    verdict = verdict_of(effects, remainder, records)
    progress("where, and what to record next", 0.95)
    location = None if verdict == "consistent" else locate(family_free, data)
    latent = () if verdict == "consistent" else latent_forces(family_free, data, after)
    experiment = next_experiment(_survivors(selected, search, after or before), data)
    effects = tuple(
        replace(e, separated_by=separated_by(e.effect, e.indistinguishable_from, experiment)) for e in effects
    )
    progress("done", 1.0)
    return Diagnosis(
        verdict=verdict,
        sentence=sentence_of(verdict, effects, remainder, records, before_left, left),
        effects=effects,
        location=location,
        before=before,
        model=after or kept,
        records=tuple(records),
        considered=tuple(_considered(selected, search)),
        experiment=experiment,
        remainder=remainder,
        latent=latent,
        notes=tuple(notes),
        chain=tuple(chain),
    )


def _survivors(selected: Candidate, search: Search, best: Oscillator) -> dict[str, Oscillator]:
    """The model and its closest rivals, by name."""
    models = {(best.terms[-1].effect if best.terms else "Eq. 17"): best}
    # one that has all of the best's laws and more says nothing else of the rig
    others = [c for c in search.candidates.values() if c.stage == "judged" and c.laws]
    others = [c for c in others if not set(c.laws) >= set(selected.laws) or not selected.laws]
    for candidate in sorted(others, key=lambda c: -c.value)[:3]:
        name = next((law for law in candidate.laws if law not in selected.laws), "less")
        if candidate.fit is not None:
            models.setdefault(name, candidate.fit.model)
    return models


def _finely(fitted: Fitted, cut_by: Oscillator, recordings: Sequence[Recording]) -> Oscillator:
    """A structure of a search as it would be delivered, but for what predictions say otherwise."""
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]
    data = data_of(recordings, cut_by, coarse=False)
    return delivered(fitted.model, data, shapes, initial=fitted.initial, doubted=False).oscillator


def _delivered(
    fitted: Fitted,
    cut_by: Oscillator,
    recordings: Sequence[Recording],
    memory: float,
    notes: list[str],
    *,
    named: bool = False,
    hold_is_free: bool = False,
) -> Oscillator:
    """The model of a search as ``identify`` delivers it, with standard errors, validity and provenance.

    Args:
        fitted: of a search, whose simulations are coarser.
        cut_by: the model by whose frequency the recordings were cut.
        recordings: that it was fitted to.
        memory: how far it predicts.
        notes: what a user should know; added to.
        named: whether it is delivered, and its errors hold what predictions say otherwise, or only compared with.
        hold_is_free: whether the recordings' hold was found beside a family that lacks something, and is asked anew.
    """
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]

    def answer(recordings: Sequence[Recording], known: Oscillator | None, *, doubted: bool) -> Fit:
        data = data_of(recordings, cut_by, coarse=False)
        return delivered(known or fitted.model, data, shapes, initial=fitted.initial, memory=memory, doubted=doubted)

    try:
        if hold_is_free:
            recordings = [changed(recording, hold=None) for recording in recordings]
        fit = answer(recordings, None, doubted=named)
        if hold_is_free:
            fit, recordings, _ = with_hold(fit, recordings, answer, doubted=named)
    except BadInput as problem:  # a finer simulation may turn over where a coarser did not
        notes.append(f"the errors of the parameters are not known: {problem}")
        return replace(fitted.model, hold=hold_of_recordings(recordings))
    notes += [note for note in fit.notes if note not in notes]
    model = with_provenance(fit, recordings)
    return replace(
        model,
        amplitude=fitted.model.amplitude or model.amplitude,
        frequency=fitted.model.frequency or model.frequency,
        hold=hold_of_recordings(recordings),
    )


def _named(fitted: Fitted, laws: Sequence[str]) -> Fitted:
    """The fit with every law that was added under the name that suits its values."""
    suiting = {term.effect: names_of(term, fitted.model)[0] for term in fitted.model.terms if term.effect in laws}
    for name in laws:
        if suiting[name] != name:
            fitted = renamed(fitted, name, find(suiting[name]))
    return fitted


def _effects(selected: Candidate, search: Search, model: Oscillator) -> tuple[Effect, ...]:
    """What is named, the most probable first; of those that are sure the one without which most is lost."""
    effects, lost = [], {}
    assert selected.fit is not None
    for name in selected.laws:
        (fitted,) = [term for term in selected.fit.model.terms if term.effect == name]
        names = names_of(fitted, selected.fit.model)
        (term,) = [term for term in model.terms if term.effect == names[0]]
        stands = standing(name, selected, list(search.candidates.values()), search.parts)
        law = find(names[0])
        rivals = dict.fromkeys(find(other).effect for other in (*names[1:], *stands.rivals))
        rivals.pop(law.effect, None)
        effects.append(Effect(law.effect, law.name, law.path, dict(term.parameters), tuple(rivals), odds=stands.odds))
        lost[law.effect] = search.lost_without(selected, name)
    return tuple(sorted(effects, key=lambda effect: (-min(effect.odds, SURE), -lost[effect.effect])))


def _considered(selected: Candidate, search: Search) -> list[Considered]:
    """Every law of the library that was not taken, how far it came beside the best structure, and why no further."""
    considered = []
    base = [laws for laws in (selected.laws, ()) if laws in search.candidates]
    for law in search.laws:
        if law.name in selected.laws:
            continue
        tried = [
            search.candidates[key((*laws, law.name))] for laws in base if key((*laws, law.name)) in search.candidates
        ]
        tried.sort(key=lambda c: -STAGES.index(c.stage))
        if not tried:
            considered.append(Considered(law.name, None, None, _why_untried(law, search)))
            continue
        best = tried[0]
        without = search.candidates[key([name for name in best.laws if name != law.name])]
        delta = None if best.stage != "judged" else -2.0 * (best.evidence - without.evidence)
        held = None if search.holdout is None else nrmse(best.held_out, search.holdout)
        considered.append(Considered(law.name, held, delta, best.why or why_not(best, without, selected, search.parts)))
    return sorted(considered, key=lambda law: (law.delta_bic is None, law.delta_bic or 0.0))


def _why_untried(law: Law, search: Search) -> str:
    """Why a law of the library was never put in."""
    if only_a_name(law):
        return f"it is fitted as {law.twin}, whose equation it has"
    if law.drive is not None and not any(segment.force is not None for segment in search.data.segments):
        return "it acts on a force, and none was recorded"
    if law.rugged:
        if search.asked_rugged:
            return "no prediction from any of its probes speaks for it"
        return "it is asked for where all others fail, and another did not"
    if any(parameter.probes == "lines" for parameter in law.parameters):
        return "no line stands out of what is left"
    return "nothing spoke for it wherever it was asked for"


def nrmse(fitted: Fitted | None, data: Data) -> float | None:
    """Of all segments together."""
    if fitted is None or not fitted.finite:
        return None
    power = sum(float(np.sum(r**2)) for r in fitted.residuals)
    spread = sum(segment.n * float(np.var(segment.response)) for segment in data.segments)
    return math.sqrt(power / spread)
