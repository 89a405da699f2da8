"""Model against recordings: what is missing, where, what it is, the mended model, what to record next."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from .. import __version__
from ..errors import BadInput
from ..identify.data import Data, data_of, noise_spectra
from ..identify.excitation import band_of
from ..identify.identification import belong_together
from ..identify.normal_equations import pseudo_inverse
from ..identify.scatter import scatter
from ..identify.start import hilbert_start
from ..identify.structure import Fitted, Structure
from ..model import Oscillator, Provenance, Range
from ..model.laws import LIBRARY, find
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from .experiment.next_experiment import next_experiment
from .mend import exported, record_fits
from .place.locate import locate
from .place.missing_force import latent_forces
from .recordings import carries, same_quantity, split, why_unused
from .result import Considered, Diagnosis, Effect, RecordFit, Verdict
from .search.judgement import Round, Trial
from .search.residual_test import Leftover, leftovers
from .search.residual_test import sentence as remainder_sentence
from .search.search import Search

#: A rig whose natural frequency or mass is off by more than this factor is another rig.
_OTHER_FREQUENCY = 1.3
_OTHER_MASS = 2.0
#: A family that leaves this part of the motion has started in the wrong place.
_LOST = 0.5
#: The effects count as an explanation where they take away this part of what was left beyond the noise.
_EXPLAINED = 0.75
_DRAWS = 30
_MOST_EFFECTS = 3
#: Training recordings told this well, and held-out ones that are not by far, are not of one rig.
_STRANGE = 1.5
#: Frequency and mass of one rig stay within this part of themselves from one recording to the next.
_KEPT = 1e-3


@dataclass(frozen=True, eq=False)
class _Found:
    """The outcome of the search: the family's best, the mended model, the accepted trials and all rounds."""

    family: Fitted
    final: Fitted
    chain: tuple[Trial, ...]
    rounds: tuple[Round, ...]

    def round_of(self, trial: Trial) -> Round:
        """The round that a trial won."""
        return next(round_ for round_ in self.rounds if trial in round_.trials)


def diagnose(
    model: Oscillator,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording] = (),
    *,
    fmu: Path | None = None,
    progress: Callable[[str, float], None] = lambda _what, _part: None,
) -> Diagnosis:
    """Find what physics a model lacks that recordings show.

    Args:
        model: gives the family: Eq. 17 and whatever terms it has; its values are where the fit starts.
        recordings: to fit to.
        holdout: of another level or kind, to judge by; where there are none the end of each recording is held out.
        fmu: where to write the mended model as an FMU; a temporary place where None.
        progress: called with what is being done and how much of all is done, 0 to 1.

    Raises:
        BadInput: where the recordings are not of this model's rig, or cannot carry a diagnosis.
    """
    notes: list[str] = []
    recordings, holdout = list(recordings), list(holdout)
    belong_together([*recordings, *holdout])
    same_quantity(model, [*recordings, *holdout])
    unused = [why_unused(r, model) for r in (*recordings, *holdout) if not carries(r, model)]
    notes += [f"{why}; it was left out" for why in unused]
    recordings, holdout = ([r for r in group if carries(r, model)] for group in (recordings, holdout))
    if not recordings:
        raise BadInput(
            f"no recording can carry a diagnosis ({'; '.join(unused)}); record a decay of at least ten cycles or a "
            "sweep through the resonance"
        )
    if not holdout:
        recordings, holdout = split(recordings, model)
        notes.append(
            "no recording was held out, so the end of each that can spare it is: judge with one of another level"
            if holdout
            else "nothing could be held out: what is named rests on the recordings that it was fitted to; judge with "
            "a recording of another level"
        )
    progress("best of the given family", 0.0)
    data = data_of(recordings, model)
    search = Search(data, data, progress=lambda what, part: progress(what, 0.05 + 0.8 * part))
    family = _family(search, model, recordings)
    _same_rig(model, family.model, slide=data.segments[0].slide)
    judged = (
        data_of(holdout, model) if holdout else data
    )  # cut as the training was, whatever the fit made of the spring
    search.holdout = judged
    found = _search(search, family, progress)
    left = (*leftovers(found.final, data), *leftovers(search.judge(found.final.model), judged))
    before_left = (*leftovers(found.family, data), *leftovers(search.judge(found.family.model), judged))
    stranger = _stranger(found, search, left, len(data.segments))
    if stranger:
        notes.append(stranger)
    progress("standard errors", 0.86)
    before = _with_errors(found.family, data, recordings)
    after = _with_errors(found.final, data, recordings) if found.chain and not stranger else None
    progress("the mended model as an FMU on every recording", 0.9)
    with TemporaryDirectory() as folder:
        artefact = exported(after, fmu or Path(folder) / "model.fmu") if after is not None else None
        records = record_fits(before, after, recordings, holdout=False)
        records += record_fits(before, after, holdout, holdout=True, fmu=artefact)
    remainder = remainder_sentence(left)
    effects: tuple[Effect, ...] = ()
    if after is not None:
        effects = tuple(_effect(trial, found.round_of(trial).rivals(trial), after) for trial in found.chain)
    verdict = _verdict(effects, remainder, before_left, left)
    progress("where, and what to record next", 0.95)
    location = None if verdict == "consistent" else locate(found.family, data)
    latent = () if verdict == "consistent" else latent_forces(found.family, data, after)
    experiment = next_experiment(_survivors(found, after or before), data)
    effects = tuple(replace(e, separated_by=experiment.sentence) if e.indistinguishable_from else e for e in effects)
    progress("done", 1.0)
    return Diagnosis(
        verdict=verdict,
        sentence=_sentence(verdict, effects, remainder, records),
        effects=effects,
        location=location,
        before=before,
        model=after or before,
        records=tuple(records),
        considered=tuple(_considered(found, judged)),
        experiment=experiment,
        remainder=remainder,
        latent=latent,
        notes=tuple(notes),
    )


def _survivors(found: _Found, best: Oscillator) -> dict[str, Oscillator]:
    """The model and its closest rivals, by name."""
    models = {(best.terms[-1].effect if best.terms else "Eq. 17"): best}
    if found.chain:
        last = [round_ for round_ in found.rounds if set(round_.trials) & set(found.chain)][-1]
        finished = [t for t in last.trials if t.finished and t.effect not in models]
    else:
        finished = [t for t in found.rounds[-1].trials if t.finished]
    for trial in finished[:3]:
        models[trial.effect] = trial.fitted.model
    return models


def _family(search: Search, model: Oscillator, recordings: Sequence[Recording]) -> Fitted:
    """Best of the family, from the model's values or, where these lead nowhere, from others.

    These are the Hilbert transform's, and both without what can hold the mass: where a simulated mass is held through
    a whole recording, no parameter has a derivative there that would let it go.
    """
    family = search.best_of_family(model)
    if _worst_nrmse(family, search.data) < _LOST:
        return family
    estimate = hilbert_start(recordings)
    values = {name: getattr(estimate, name) for name in ("mass", "omega0", "cubic", "preload", "viscous", "dry")}
    known = model.parameters()
    start = model.with_parameters(
        {
            name: replace(known[name], value=value)
            for name, value in values.items()
            if name in known and value is not None
        }
    )
    starts = [start, *(_loose(one) for one in (family.model, start))]
    return max([family, *(search.best_of_family(one) for one in starts)], key=lambda one: one.likelihood)


def _loose(model: Oscillator) -> Oscillator:
    """The model without dry friction and preload."""
    known = model.parameters()
    return model.with_parameters(
        {name: replace(known[name], value=0.0) for name in ("dry", "preload") if name in known}
    )


def _worst_nrmse(fitted: Fitted, data: Data) -> float:
    if not fitted.finite:
        return math.inf
    spreads = [float(np.std(segment.response)) for segment in data.segments]
    return max(
        float(np.sqrt(np.mean(r**2))) / spread
        for r, spread in zip(fitted.residuals, spreads, strict=True)
        if spread > 0.05 * max(spreads)
    )


def _same_rig(given: Oscillator, found: Oscillator, *, slide: bool) -> None:
    """A slide, moved as its force moves it, has no natural frequency to compare."""
    frequency = 0.0 if slide else abs(math.log(found.omega0.value / given.omega0.value))
    heavier = 0.0
    if given.mass is not None and found.mass is not None:
        heavier = abs(math.log(found.mass.value / given.mass.value))
    if frequency > math.log(_OTHER_FREQUENCY) or heavier > math.log(_OTHER_MASS):
        mass = "" if found.mass is None else f" and {found.mass.value:.4g} {found.mass.unit}"
        given_mass = "" if given.mass is None else f" and {given.mass.value:.4g} {given.mass.unit}"
        raise BadInput(
            f"the recordings are not of the model's rig: they show {found.omega0.value / (2 * math.pi):.4g} Hz{mass}, "
            f"the model has {given.omega0.value / (2 * math.pi):.4g} Hz{given_mass}; identify a model from them first"
        )


def _search(search: Search, family: Fitted, progress: Callable[[str, float], None]) -> _Found:
    """One effect after another, as long as both kinds of recordings ask for it."""
    chain: list[Trial] = []
    rounds: list[Round] = []
    current = family
    while len(chain) < _MOST_EFFECTS:
        done = 1.0 - 0.5 ** len(chain)
        search.progress = lambda what, part, d=done: progress(what, 0.05 + 0.8 * (d + 0.5 * (1.0 - d) * part))
        round_ = search.round(current)
        rounds.append(round_)
        if round_.best is None:
            current = round_.before  # the trials may have led the model itself to a better place
            family = family if chain else current
            break
        chain.append(round_.best)
        current = round_.best.fitted
        if len(chain) > 1:
            chain, current = search.reconsidered(chain)
    return _Found(family, current, tuple(chain), tuple(rounds))


def _stranger(found: _Found, search: Search, left: Sequence[Leftover], training: int) -> str | None:
    """A sentence where the held-out recordings are told well by a model of their own, but not by this one."""
    ratios = [one.ratio for one in left]
    if max(ratios[:training]) > _STRANGE or max(ratios[training:]) < _STRANGE**2:
        return None
    worst: dict[str, float] = {}
    for one in left[training:]:
        worst[one.file] = max(one.ratio, worst.get(one.file, 0.0))
    if min(worst.values()) < _STRANGE:  # another rig shows in each; one alone may jump where a hair decides
        return None
    own = Structure(found.final.model, search.holdout).fit(settle=True)
    again = [one.ratio for one in leftovers(own, search.holdout)]
    if not own.finite or max(again) > 0.5 * max(ratios[training:]):
        return None
    here, there = found.final.model, own.model
    if not _moved(here, there, slide=search.data.segments[0].slide):
        return None
    words = [f"{there.omega0.value / (2 * math.pi):.4g} Hz instead of {here.omega0.value / (2 * math.pi):.4g} Hz"]
    if here.mass is not None and there.mass is not None:
        words.append(f"{there.mass.value:.4g} {there.mass.unit} instead of {here.mass.value:.4g} {here.mass.unit}")
    names = ", ".join(recording.name for recording in search.holdout.recordings)
    return (
        f"the held-out recordings ({names}) agree with a model of their own ({', '.join(words)}) and not with the one "
        "of the training recordings: they are of another rig, or the rig was changed between; no effect is named"
    )


def _moved(here: Oscillator, there: Oscillator, *, slide: bool) -> bool:
    """Whether frequency or mass differ by more than a thousandth, about what a lab can keep constant."""
    ratios = [] if slide else [there.omega0.value / here.omega0.value]
    if here.mass is not None and there.mass is not None:
        ratios.append(there.mass.value / here.mass.value)
    return any(ratio <= 0.0 or abs(math.log(ratio)) > _KEPT for ratio in ratios)


def _with_errors(fitted: Fitted, data: Data, recordings: Sequence[Recording]) -> Oscillator:
    """The model with standard errors, validity and provenance."""
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]
    structure = Structure(fitted.model, data, shapes)
    noise = noise_spectra(fitted.residuals, fitted.model, data)
    state = structure.state(fitted.initial)
    spread = scatter(structure.problem, state, noise, data.force, _DRAWS)
    derivatives = structure.problem.derivatives(state, fitted.residuals)
    information = structure.problem.information(derivatives, noise)
    inverse = pseudo_inverse(information)
    covariance = inverse @ spread @ inverse
    errors = dict(zip(structure.free, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    known = fitted.model.parameters()
    model = fitted.model.with_parameters(
        {name: replace(p, std=float(errors[name]) if errors.get(name) else None) for name, p in known.items()}
    )
    order = QUANTITIES.index(model.response.quantity)
    peak = max(float(np.max(np.abs(segment.response))) for segment in data.segments) / data.scales.omega**order
    bands = [edge for recording in recordings if (band := band_of(recording)) for edge in band]
    bands = bands or [model.omega0.value / (2 * math.pi)]
    return replace(
        model,
        amplitude=model.amplitude or Range(0.0, peak, model.response.displacement_unit),
        frequency=model.frequency or Range(min(bands), max(bands), "Hz"),
        identified=Provenance(
            recordings=tuple({"file": r.name, "sha256": r.sha256} for r in recordings),
            method="maximum-likelihood",
            software=f"dashpot {__version__}",
            parameters=structure.free,
            covariance=tuple(tuple(float(c) for c in row) for row in covariance),
            log_likelihood=fitted.likelihood,
        ),
    )


def _effect(trial: Trial, rivals: Sequence[str], model: Oscillator) -> Effect:
    law = find(trial.effect)
    (term,) = [term for term in model.terms if term.effect == trial.effect]
    return Effect(law.effect, law.name, law.path, dict(term.parameters), tuple(rivals))


def _verdict(
    effects: Sequence[Effect], remainder: str | None, before: Sequence[Leftover], after: Sequence[Leftover]
) -> Verdict:
    if not effects:
        return "consistent" if remainder is None else "unexplained"
    if remainder is None:
        return "missing-physics"
    excess = [sum(max(one.ratio**2 - 1.0, 0.0) for one in left) for left in (before, after)]
    return "missing-physics" if excess[1] < (1.0 - _EXPLAINED) * excess[0] else "unexplained"


def _sentence(verdict: Verdict, effects: Sequence[Effect], remainder: str | None, records: Sequence[RecordFit]) -> str:
    """The verdict for a person."""
    if verdict == "consistent":
        return "Nothing is missing: the model reproduces every recording to within its noise."
    if not effects:
        return f"Something is missing that no effect of the library explains: {remainder or 'see the notes'}."
    named = []
    for effect in effects:
        rivals = f" (or {', '.join(effect.indistinguishable_from)})" if effect.indistinguishable_from else ""
        named.append(f"{effect.effect}{rivals}")
    held = [r for r in records if r.holdout and math.isfinite(r.nrmse_after)]
    figures = ""
    if held:
        worst = max(
            held,
            key=lambda r: r.nrmse_before / max(r.noise_floor, 1e-300) if math.isfinite(r.nrmse_before) else math.inf,
        )
        before = f"{100 * worst.nrmse_before:.3g}" if math.isfinite(worst.nrmse_before) else "where nothing simulates"
        way = "rises" if worst.nrmse_after > worst.nrmse_before else "falls"
        figures = (
            f"; with it the held-out error {way} from {before} to {100 * worst.nrmse_after:.3g} "
            f"% in {worst.file} (noise {100 * worst.noise_floor:.3g} %)"
        )
    if verdict == "unexplained":
        return (
            f"Something is missing that the library only touches, nearest {' and '.join(named)}{figures}; {remainder}."
        )
    tail = f"; {remainder}" if remainder else ""
    return f"Missing: {' and '.join(named)}{figures}{tail}."


def _considered(found: _Found, holdout: Data) -> list[Considered]:
    """Every law of the library that was not taken, and why."""
    taken = {trial.effect for trial in found.chain}
    seen: dict[str, Considered] = {}
    for round_ in found.rounds:
        best = round_.best
        for trial in round_.trials:
            if trial.effect in taken:
                continue
            seen[trial.effect] = Considered(
                trial.effect, _nrmse(trial.holdout, holdout), -2.0 * trial.gain, trial.why_not(best)
            )
    for law in LIBRARY.values():
        if law.name not in taken and law.name not in seen:
            seen[law.name] = Considered(law.name, None, 0.0, "neither its score nor the measured motion asks for it")
    return sorted(seen.values(), key=lambda one: (one.holdout_nrmse is None, one.delta_bic))


def _nrmse(fitted: Fitted | None, data: Data) -> float | None:
    """Of all segments together."""
    if fitted is None or not fitted.finite:
        return None
    power = sum(float(np.sum(r**2)) for r in fitted.residuals)
    spread = sum(segment.n * float(np.var(segment.response)) for segment in data.segments)
    return math.sqrt(power / spread)
