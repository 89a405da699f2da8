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
from ..identify.data import Data, noise_spectra
from ..identify.excitation import band_of
from ..identify.hold import hold_of_recordings
from ..identify.identification import belong_together
from ..identify.normal_equations import pseudo_inverse
from ..identify.prediction import FREE
from ..identify.scatter import scatter
from ..identify.structure import Fitted, Structure
from ..model import Oscillator, Provenance, Range
from ..model.laws import LIBRARY, find
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from .experiment.next_experiment import next_experiment
from .experiment.separated_by import separated_by
from .family import cut_for, family_of, first_fit, stranger
from .mend import exported, record_fits
from .place.locate import locate
from .place.missing_force import latent_forces
from .recordings import carries, same_quantity, split, why_unused
from .result import Considered, Diagnosis, Effect
from .search.judgement import Round, Trial
from .search.residual_test import leftovers
from .search.residual_test import sentence as remainder_sentence
from .search.search import SENSOR_OFFSET, Search
from .verdict import sentence_of, verdict_of

_DRAWS = 30
_MOST_EFFECTS = 3


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
        holdout: of another level or kind, to judge by; where there are none, stretches of each recording that can
            spare them are held out.
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
    progress("best of the given family", 0.0)
    best = family_of(model, recordings, holdout)
    notes += best.notes
    recordings, holdout = list(best.recordings), list(best.holdout)
    if not holdout:
        recordings, holdout = split(recordings, model)
        best = replace(best, free_zeros=False)  # the pieces of a recording share what was taken off
        notes.append(
            "no recording was held out, so stretches of each that can spare them are: judge with one of another level"
            if holdout
            else "nothing could be held out: what is named rests on the recordings that it was fitted to; judge with "
            "a recording of another level"
        )
    data = cut_for(best, recordings, model)
    # cut as the training was, whatever the fit made of the spring
    judged = cut_for(best, holdout, model) if holdout else data
    laws = [law for law in LIBRARY.values() if best.zeros_are_shared or law.effect != SENSOR_OFFSET]
    search = Search(data, judged, laws, progress=lambda what, part: progress(what, 0.05 + 0.8 * part))
    begun = first_fit(search, best.model)
    memory = search.data.memory
    found = _search(search, begun, progress)
    # what is left is said of simulations: a prediction leaves less
    data, judged = (replace(part, memory=FREE) for part in (search.data, search.holdout))
    final = found.final if search.data.memory == FREE else search.judge(found.final.model, data)
    family = found.family if memory == FREE else search.judge(found.family.model, data)
    left = (*leftovers(final, data), *leftovers(search.judge(found.final.model, judged), judged))
    before_left = (*leftovers(family, data), *leftovers(search.judge(found.family.model, judged), judged))
    other_rig = stranger(found.final, search, left, len(data.segments))
    if other_rig:
        notes.append(other_rig)
    progress("standard errors", 0.86)
    before = _with_errors(found.family, replace(data, memory=memory), recordings)
    after = _with_errors(found.final, search.data, recordings) if found.chain and not other_rig else None
    progress("the mended model on every recording, as an FMU on those held out", 0.9)
    with TemporaryDirectory() as folder:
        artefact = exported(after, fmu or Path(folder) / "model.fmu") if after is not None else None
        records = record_fits(before, after, recordings, holdout=False)
        records += record_fits(before, after, holdout, holdout=True, fmu=artefact)
    remainder = remainder_sentence(left)
    effects: tuple[Effect, ...] = ()
    if after is not None:
        effects = tuple(_effect(trial, found.round_of(trial).rivals(trial), after) for trial in found.chain)
    verdict = verdict_of(effects, remainder, records)
    progress("where, and what to record next", 0.95)
    location = None if verdict == "consistent" else locate(family, data)
    latent = () if verdict == "consistent" else latent_forces(family, data, after)
    experiment = next_experiment(_survivors(found, after or before), data)
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
        current = search.simulated(current)
    return _Found(family, current, tuple(chain), tuple(rounds))


def _with_errors(fitted: Fitted, data: Data, recordings: Sequence[Recording]) -> Oscillator:
    """The model with standard errors, validity and provenance."""
    shapes = [name for name in fitted.model.parameters() if name not in fitted.free]
    structure = Structure(fitted.model, data, shapes)
    noise = noise_spectra(fitted.residuals, fitted.model, data)
    state = structure.state(fitted.initial, fitted.offsets)
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
        hold=hold_of_recordings(recordings),
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
            seen[law.name] = Considered(law.name, None, None, "neither its score nor the measured motion asks for it")
    fitted = [law for law in seen.values() if law.delta_bic is not None]
    rest = [law for law in seen.values() if law.delta_bic is None]
    return sorted(fitted, key=lambda law: (law.holdout_nrmse is None, law.delta_bic or 0.0)) + rest


def _nrmse(fitted: Fitted | None, data: Data) -> float | None:
    """Of all segments together."""
    if fitted is None or not fitted.finite:
        return None
    power = sum(float(np.sum(r**2)) for r in fitted.residuals)
    spread = sum(segment.n * float(np.var(segment.response)) for segment in data.segments)
    return math.sqrt(power / spread)
