"""The last step of a diagnosis: the mended model tried on every recording, and what is said of it."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from ..identify.problem.data import Data
from ..identify.problem.prediction import FREE
from ..identify.problem.structure import Fitted
from ..model import Oscillator
from ..model.formula.closed_form import closed_forms
from ..model.formula.nearest_words import nearest_laws
from ..model.law import Law
from ..model.left import share_of_motion
from ..model.library import find
from ..recording.fact import changed
from .case import Case, Progress
from .delivery import named, with_errors
from .experiment.next_experiment import next_experiment
from .experiment.separated_by import separated_by
from .family import identified_from, less_offsets, stranger
from .measuring_chain import hold_of
from .place.locate import locate
from .place.missing_force import latent_forces
from .repair_trial import FITTED_TO_ALL, exported, fitted_to_all, no_finding, record_fits, unmended
from .result import SURE, Considered, Diagnosis, Effect, RecordFit
from .search.candidate import STAGES, key
from .search.found import Found, Weighing
from .search.judgement import names_of, only_a_name, standing, why_not
from .search.residual_test import Leftover, leftovers, nearer
from .search.residual_test import sentence as remainder_sentence
from .search.weigh import judged
from .simplify import of_unknown_size
from .time_allowed import DELIVERED, REFITTED, TRIED, TimeAllowed, part_at
from .verdict import explained_share, sentence_of, verdict_of

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class _Left:
    """What the family and the best structure leave, simulated freely.

    Attributes:
        data, held: recordings fitted to and held out; the latter None where there are none.
        family: the family on ``data``.
        before, after: what the family and the best structure leave in each segment, held-out ones last.
    """

    data: Data
    held: Data | None
    family: Fitted
    before: Sequence[Leftover]
    after: Sequence[Leftover]


def tell(case: Case, found: Found, fmu: Path | None, progress: Progress, allowed: TimeAllowed) -> Diagnosis:
    """Deliver the best structure, try it on every recording, and say what was found.

    Args:
        case: what the diagnosis is about.
        found: the best structure, with all others that were evaluated.
        fmu: where to write the mended model as an FMU; a temporary place where None.
        progress: called with what is being done and how much of all is done.
        allowed: what the whole may take: without time left, the hold of the force is not asked anew.
    """
    missing, asked = bool(found.selected.laws), case
    case, left = _without_offsets(case, found)
    other_rig = stranger(found.fitted, found.weighing.data, found.weighing.holdout, left.after)
    if other_rig:
        case = case.noted(other_rig)
    progress("standard errors", part_at(REFITTED, missing))
    before, _ = with_errors(found.family, case.model, case.recordings, found.family_memory)
    after = None
    if found.selected.laws and not other_rig:
        case, left, after = _delivered(case, found, left, before, allowed)
    progress("the mended model on every recording, as an FMU on those held out", part_at(DELIVERED, missing))
    mended = after
    case, after, records = _tried(case, found, left, (before, mended), fmu, progress)
    if mended is not None and after is None and (plainer := _without_learnt(found)):
        return tell(asked, plainer, fmu, progress, allowed)
    for record in records:
        _log.info("%s: NRMSE %.4g before, %.4g after", record.file, record.nrmse_before, record.nrmse_after)
    remarks = _remarks(found, left, after)
    if after is None:
        left = replace(left, after=left.before)
    remainder = remainder_sentence(left.after, {record.file: record.left_after for record in records})
    unknown = {} if after is None else of_unknown_size(after, _added(case, after))
    effects, unnamed = ((), {}) if after is None else _effects(found, after, unknown)
    unlikely = "is in the model and not named: that it is something else, or nothing, is more probable"
    remarks += [unknown.get(law, f"{law} {unlikely}") for law in unnamed]
    kept = before
    if after is None and case.in_pieces:
        # a fit to a part of what there is is held against the rest, and no reason to leave that of all
        kept = case.model if identified_from(case.model, case.given) else case.family.model
    untried = bool(found.untried)
    verdict = verdict_of(after, remainder, records, untried=untried)
    progress("where, and what to record next", part_at(TRIED, missing))
    nothing = verdict == "consistent" and remainder is None
    location = None if nothing else locate(left.family, left.data, records)
    latent = () if nothing else latent_forces(left.family, left.data, after)
    experiment = next_experiment(_survivors(found, after or before), left.data)
    effects = tuple(
        replace(e, separated_by=separated_by(e.effect, e.indistinguishable_from, experiment)) for e in effects
    )
    progress("done", 1.0)
    return Diagnosis(
        verdict=verdict,
        sentence=sentence_of(verdict, effects, remainder, records, left.before, left.after, unnamed, untried=untried),
        effects=effects,
        location=location,
        before=before,
        model=after or kept,
        records=tuple(records),
        considered=tuple(_considered(found)),
        experiment=experiment,
        remainder=remainder,
        latent=latent,
        notes=(*case.notes, *remarks),
        chain=case.chain,
        forms=() if after is None else closed_forms(after),
        nearest=() if after is None else nearest_laws(after),
        recordings=case.uncut if case.in_pieces else (*case.recordings, *case.holdout),
    )


def _without_offsets(case: Case, found: Found) -> tuple[Case, _Left]:
    """What is left, and the recordings less the zeros and drifts that their sensors have beside the best structure."""
    best, weighing, fitted = case.family, found.weighing, found.fitted
    # what is left is said of simulations: a prediction leaves less
    data = replace(weighing.data, memory=FREE)
    held = None if weighing.holdout is None else replace(weighing.holdout, memory=FREE)
    final = fitted if weighing.data.memory == FREE else judged(fitted.model, data)
    family = found.family if found.family_memory == FREE else judged(found.family.model, data)
    left, before = leftovers(final, data), leftovers(family, data)
    recordings, zeros = less_offsets(case.recordings, best.shown, data, final.offsets)
    holdout, chain = list(case.holdout), list(case.chain)
    if best.drifts:  # as the best structure says, and no longer the family
        chain = [fact for fact in chain if fact.what != "drift"]
    chain += [] if case.in_pieces else zeros
    if held is not None:
        held_fit = judged(fitted.model, held)
        holdout, zeros = less_offsets(holdout, best.shown_elsewhere, held, held_fit.offsets)
        chain += [] if case.in_pieces else zeros
        left += leftovers(held_fit, held)
        before += leftovers(judged(found.family.model, held), held)
    case = replace(case, recordings=tuple(recordings), holdout=tuple(holdout), chain=tuple(chain))
    return case, _Left(data, held, family, before, left)


def _delivered(
    case: Case, found: Found, left: _Left, before: Oscillator, allowed: TimeAllowed
) -> tuple[Case, _Left, Oscillator]:
    """The best structure as it is delivered, the hold of the force asked for beside it, and what it then leaves."""
    # beside what still lacks something the hold would be asked for in vain once more
    free = all(r.hold is None for r in case.given) and not remainder_sentence(left.after) and allowed.checking
    fitted = named(found.fitted, found.selected.laws)
    memory = found.weighing.data.memory
    after, notes = with_errors(fitted, case.model, case.recordings, memory, named=True, hold_is_free=free)
    case = case.noted(*(note for note in notes if note not in case.notes))
    if after.hold != before.hold:  # which was found beside what the family lacks
        recordings, holdout, uncut = (
            tuple(changed(r, hold=after.hold) for r in group) for group in (case.recordings, case.holdout, case.uncut)
        )
        chain = [fact for fact in case.chain if fact.what != "hold"] + [hold_of(after.hold, found=True)]
        case = replace(case, recordings=recordings, holdout=holdout, uncut=uncut, chain=tuple(chain))
    # the search may have ended where a stretch is lost that the delivered fit follows
    remaining = [leftovers(judged(after, part), part) for part in (left.data, left.held) if part is not None]
    return case, replace(left, after=nearer(left.after, sum(remaining, ()))), after


def _tried(
    case: Case,
    found: Found,
    left: _Left,
    models: tuple[Oscillator, Oscillator | None],
    fmu: Path | None,
    progress: Progress,
) -> tuple[Case, Oscillator | None, list[RecordFit]]:
    """The mended model run along every recording; None in its place where that shows no improvement."""
    before, after = models
    with TemporaryDirectory() as folder:
        artefact = exported(after, Path(folder) / "model.fmu") if after is not None else None
        records = record_fits(before, after, case.recordings, holdout=False)
        records += record_fits(before, after, case.holdout, holdout=True, fmu=artefact)
        if after is None:
            return case, None, records
        if why := no_finding(records, explained_share(left.before, left.after)):
            # however much more probable than the others
            _log.info("%s is not named: it %s", found.selected.name, why)
            note = f"the most probable structure ({found.selected.name}) {why}: no effect is named"
            return case.noted(note), None, [unmended(record) for record in records]
        if case.in_pieces and case.holdout:
            progress("the mended model, fitted to what was held out too", DELIVERED)
            free = named(found.fitted, found.selected.laws).free
            fixed = [name for name in after.parameters() if name not in free]
            if whole := fitted_to_all(after, case.uncut, fixed):
                after, artefact = whole, exported(whole, Path(folder) / "all.fmu")
                case = replace(case, notes=(FITTED_TO_ALL, *case.notes))
        if artefact is not None and fmu is not None:
            shutil.move(artefact, fmu)
    return case, after, records


def _remarks(found: Found, left: _Left, after: Oscillator | None) -> list[str]:
    """What a user should know of the mended model."""
    if after is None:
        return []
    remarks = []
    rugged = [law for law in found.selected.laws if find(law).rugged]
    if rugged and remainder_sentence(left.after):
        remarks.append(
            f"the likelihood of {' + '.join(rugged)} has many side valleys and this fit rests in one of them, above "
            "the noise: its parameters may be off by far more than their errors"
        )
    return remarks


def _added(case: Case, model: Oscillator) -> tuple[str, ...]:
    """The laws that a mended model has and the given one has not."""
    known = {term.effect for term in case.model.terms}
    return tuple(term.effect for term in model.terms if term.effect not in known)


def _without_learnt(found: Found) -> Found | None:
    """The best structure less what was learnt, where that was evaluated: whole recordings spoke against the curve."""
    kept = key([law for law in found.selected.laws if not find(law).learnt])
    other = found.candidates.get(kept)
    if not kept or kept == found.selected.laws or other is None or other.fit is None or other.stage != "judged":
        return None
    return found.instead(other, "with the curve that it learns whole recordings are explained worse")


def _survivors(found: Found, best: Oscillator) -> dict[str, Oscillator]:
    """The model and its closest rivals, by name."""
    selected = found.selected
    models = {(best.terms[-1].effect if best.terms else "Eq. 17"): best}
    # one that has all of the best's laws and more says nothing else of the rig
    others = [c for c in found.candidates.values() if c.stage == "judged" and c.laws]
    others = [c for c in others if not set(c.laws) >= set(selected.laws) or not selected.laws]
    for candidate in sorted(others, key=lambda c: -c.value)[:3]:
        without = next((law for law in selected.laws if law not in candidate.laws), "")
        name = next((law for law in candidate.laws if law not in selected.laws), f"no {without}")
        if candidate.fit is not None:
            models.setdefault(name, candidate.fit.model)
    return models


def _effects(
    found: Found, model: Oscillator, unknown: Collection[str] = ()
) -> tuple[tuple[Effect, ...], dict[str, float | None]]:
    """What is named, that first of which most is expected: its share of what is left times its probability.

    Laws of ``unknown`` size, and what is there less probably than not, are in the model and not named: they are given
    with their shares.
    """
    selected, fit = found.selected, found.fitted
    effects, unnamed = [], {}
    for name in selected.laws:
        (fitted,) = [term for term in fit.model.terms if term.effect == name]
        names = names_of(fitted, fit.model)
        stands = standing(name, selected, list(found.candidates.values()), found.weighing.parts)
        if names[0] in unknown or stands.odds < 1.0:
            unnamed[names[0]] = found.share_of(name)
            continue
        (term,) = [term for term in model.terms if term.effect == names[0]]
        law = find(names[0])
        rivals = dict.fromkeys(find(other).effect for other in (*names[1:], *stands.rivals))
        rivals.pop(law.effect, None)
        odds, share = min(stands.odds, SURE), found.share_of(name)
        effects.append(Effect(law.effect, law.name, law.path, dict(term.parameters), tuple(rivals), "", odds, share))
    effects.sort(key=lambda effect: -effect.probability * (1.0 if effect.share is None else effect.share))
    return tuple(effects), unnamed


def _considered(found: Found) -> list[Considered]:
    """Every law of the library that was not taken, how far it came beside the best structure, and why no further."""
    selected, weighing = found.selected, found.weighing
    considered = []
    base = [laws for laws in (selected.laws, ()) if laws in found.candidates]
    for law in weighing.laws:
        if law.name in selected.laws:
            continue
        tried = [
            found.candidates[key((*laws, law.name))] for laws in base if key((*laws, law.name)) in found.candidates
        ]
        tried.sort(key=lambda c: -STAGES.index(c.stage))
        if not tried:
            considered.append(
                Considered(law.name, None, None, _why_untried(law, weighing, asked_rugged=found.asked_rugged))
            )
            continue
        best = tried[0]
        without = found.candidates[key([name for name in best.laws if name != law.name])]
        delta = None if best.stage != "judged" else -2.0 * (best.evidence - without.evidence)
        held = None if weighing.holdout is None else nrmse(best.held_out, weighing.holdout)
        considered.append(
            Considered(law.name, held, delta, best.why or why_not(best, without, selected, weighing.parts))
        )
    return sorted(considered, key=lambda law: (law.delta_bic is None, law.delta_bic or 0.0))


def _why_untried(law: Law, weighing: Weighing, *, asked_rugged: bool) -> str:
    """Why a law of the library was never put in."""
    if only_a_name(law):
        return f"it is fitted as {law.twin}, whose equation it has"
    if law.drive is not None and not any(segment.force is not None for segment in weighing.data.segments):
        return "it acts on a force, and none was recorded"
    if law.rugged:
        if asked_rugged:
            return "no prediction from any of its probes speaks for it"
        return "it is asked for where all others fail, and another did not"
    if any(parameter.probes == "lines" for parameter in law.parameters):
        return "no line stands out of what is left"
    return "nothing spoke for it wherever it was asked for"


def nrmse(fitted: Fitted | None, data: Data) -> float | None:
    """Of all segments together."""
    if fitted is None or not fitted.finite:
        return None
    return share_of_motion(fitted.residuals, [segment.response for segment in data.segments])
