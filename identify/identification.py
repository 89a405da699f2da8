"""From recordings to a model: a regression for the start, maximum likelihood for the answer.

FREEVIB and FORCEVIB stand beside them (``hilbert_result``), for pictures and comparison; their curves start the search
only where the regression fails.
"""

from __future__ import annotations

import difflib
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.computed_once import computed_once
from ..files.spoken import spoken
from ..model import Oscillator, Response
from ..model.fit_state import LACKING, left_over
from ..model.limits import checked_value
from ..model.oscillator import Band
from ..recording.checks import no_reach, overlapping, reversed_force
from ..recording.continuity import is_switched
from ..recording.given import recordings_of
from ..recording.oscillation import oscillation_of
from ..recording.prescribed import refuse_prescribed
from ..recording.recording import WHOLE, Recording
from ..simulate.work import Meter, Work
from .faults.inconsistent_recording import explain_residual
from .faults.spread import differing, with_spread
from .fit.frequency_known import refuse_unknown
from .fit.friction_that_pushes import friction_that_pushes
from .fit.given_start import leads, with_shared
from .fit.hold import held_as, hold_note, hold_of_recordings, with_hold
from .fit.likeliest_modes import Modes, modes_of_fit, odds, stand, with_more_modes
from .fit.likeliest_stop import likeliest_stop
from .fit.likelihood import maximum_likelihood
from .fit.limits import AMISS, FREE_OF_FRICTION, GAIN_RATIO
from .fit.plainest import plainest
from .fit.reported_result import Fit
from .hilbert.hilbert_result import HilbertAnalysis, analysis_or_none
from .left import beside_noise, has_lost, is_quiet, left_of_parts, stretch_words
from .motion.excitation import kind_of
from .motion.modes import modes_beside
from .problem.data import Data, data_of
from .problem.offset import Offset
from .problem.prediction import FREE
from .problem.release_memory import give_back_at_once
from .problem.structure import shapes_of
from .provenance import with_provenance
from .signals.hilbert import LONG
from .signals.odds import ABOVE_NOISE, DECISIVE, SIGNIFICANT
from .signals.signals import response_of
from .start.further_laws import holding, with_laws
from .start.further_modes import ringing_modes
from .start.start import HilbertEstimate, estimated, hilbert_start, plain_starts

_log = logging.getLogger(__name__)

#: What a user hears who asked for faults where there are none, by whether more than noise is left.
_NO_FAULT = {
    True: "nothing that a measuring chain does (gains, delays, hum, zeros, clocks) explains what the model leaves",
    False: "what the model leaves is noise: of faults of the measuring chain there is nothing to be seen",
}
LEADS_NOWHERE = (
    "the model to start from does not predict the motion, not even over one cycle; the search began at an estimate "
    "from the recordings: check that the model is of this rig and in the same units"
)


@dataclass(frozen=True, eq=False, repr=False)
class Identification:
    """A model and how it was found.

    Attributes:
        oscillator: parameters with standard errors, validity and provenance.
        hilbert: start values, by regression where it works, and the curves that are their fallback.
        fit: maximum likelihood: covariance, simulated responses.
        recordings: what was identified from.
        notes: one sentence each on what a user should know.
        faults: one sentence each on what the measuring chain did to a recording, or that it is of another rig, where
            that explains what the model leaves; the parameters are those of the recordings as given, with errors that
            cover it.
        work: how often the recordings were simulated for it, and how long that took.
        differs: one sentence on each parameter that differs between the recordings, which hold by how much; they are
            among the notes.
        modes_left: a sentence on modes that the model does not hold, where it leaves more than noise; else None.
    """

    oscillator: Oscillator
    hilbert: HilbertEstimate
    fit: Fit
    recordings: tuple[Recording, ...]
    notes: tuple[str, ...]
    faults: tuple[str, ...] = ()
    work: Work | None = None
    modes_left: str | None = None
    differs: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Identification of {self.oscillator!r} from {', '.join(r.name for r in self.recordings)}>"

    @computed_once
    def measured(self) -> HilbertAnalysis:
        """What FREEVIB and FORCEVIB say of the same recordings; empty, with a note, where they cannot be used."""
        return analysis_or_none(self.recordings)

    @property
    def useless(self) -> str | None:
        """A sentence on what the model is good for where its simulation does not follow the recordings; else None."""
        lost = [s for s in self.fit.segments if has_lost(s, self.fit)]
        worst = max(lost, key=lambda s: s.nrmse, default=None)
        if worst is None:
            return None
        where = stretch_words(worst, self.fit, self.recordings)
        return (
            f"its simulation leaves {left_of_parts([worst]).of_motion} in {where}: it is good as a start for dashpot "
            "diagnose, and for nothing else"
        )

    @property
    def unexplained(self) -> str | None:
        """A sentence on what says that the parameters may be off by more than their errors.

        That is the recording of which the model leaves the most, where that is more than noise and much of the motion;
        else a friction that would give energy. None without either, or where the model is ``useless`` anyway.
        """
        left = [s for s in self.fit.segments if s.over_noise > LACKING and not is_quiet(s.segment.response, self.fit)]
        worst = max(left, key=lambda s: s.nrmse, default=None)
        if self.useless:
            return None
        if worst is None or not beside_noise(worst) > AMISS:
            return friction_that_pushes(self.fit.oscillator)
        most, where = left_of_parts([worst]), stretch_words(worst, self.fit, self.recordings)
        return (
            f"its simulation leaves {most.of_motion} in {where}, {most.of_noise}: the parameters may be off by more "
            "than their errors"
        )


def identify(
    recordings: Sequence[Recording] | Any,
    *,
    name: str = "oscillator",
    effects: Sequence[str] = (),
    fixed: Mapping[str, float] = MappingProxyType({}),
    start: Oscillator | None = None,
    band: Band | None = None,
    wanted: float | None = None,
    doubted: bool = True,
    near: bool = False,
    faults: bool = False,
    every: bool = True,
    begun: Callable[[Sequence[Recording], Oscillator], None] = lambda *_: None,
    progress: Callable[[str], None] = lambda _: None,
) -> Identification:
    """Identify Eq. 17, with further laws where asked for, from recordings of one rig, free or forced, in any mixture.

    Args:
        recordings: as read by ``dashpot.recording.read``, or what ``recordings_of`` reads.
        name: the rig's name, for the model file.
        effects: names of laws of the library to be fitted beside Eq. 17.
        fixed: parameters that keep a value, by name; ``mass`` gives that of a rig of which only decays were recorded.
        start: model to start from, with its laws, instead of estimates from the recordings.
        band: in which one of several modes was isolated in them, for the model file; see ``modes``.
        wanted: frequency in Hz of that of several modes which the model is of; the strongest where None.
        doubted: whether what predictions say otherwise goes into the standard errors; see ``maximum_likelihood``.
        near: whether ``start`` was found from these very recordings; see there.
        faults: whether to ask what the measuring chain may have done to the recordings, by several fits more, where
            they do not contradict each other too; see ``explain_residual``.
        every: whether members of Eq. 17 stay that the recordings do not tell from none; see ``plainest``.
        begun: called, before the search, with the recordings and the model that it starts from.
        progress: called with one line per step.

    Raises:
        BadInput: where the recordings do not belong together, or cannot carry a model, of which frequency and damping
            are known to a third; where a law or a parameter is not known.
    """
    meter = Meter()
    recordings = recordings_of(recordings)
    belong_together(recordings)
    if any(recording.base == WHOLE for recording in recordings):  # what drives it is per unit mass
        if fixed.get("mass", 1.0) != 1.0:
            raise BadInput("a rig that its base drives has no mass to state: what drives it is per unit mass")
        fixed = {**fixed, "mass": 1.0}
    if max(recording.n for recording in recordings) >= LONG:
        give_back_at_once()
    progress("free motion, start values by regression")
    hilbert = hilbert_start(recordings)
    estimate = estimated(hilbert, recordings, name)
    base = estimate if start is None else replace(start, name=name)
    if start is not None and start.hold != "smooth":  # which is also what a model file says that says nothing
        recordings = held_as(recordings, start.hold)
    switched = {i for i, r in enumerate(recordings) if r.hold is None and r.force is not None and is_switched(r.force)}
    recordings = [held_as([r], "zero" if i in switched else None)[0] for i, r in enumerate(recordings)]
    own = with_shared(base, estimate)
    leading = start is None or leads(base, own, recordings)
    base = base if leading else own
    begun(recordings, with_fixed(base, fixed, final=False))
    laws = [effect for effect in effects if effect not in {term.effect for term in base.terms}]

    def answer(
        recordings: Sequence[Recording],
        known: Oscillator | None,
        kept: Sequence[str] = (),
        drifts: Sequence[Offset] = (),
        *,
        doubted: bool,
    ) -> Fit:
        data = data_of(recordings, base, coarse=False)

        def begun(model: Oscillator) -> Oscillator:
            model = with_fixed(model, fixed, final=not laws)
            if laws:
                progress(f"start values for {', '.join(laws)}")
                model = with_laws(model, laws, replace(data, coarse=True), fixed)
                model = with_fixed(model, fixed, final=True)
            return model

        def others() -> Iterator[Oscillator]:
            if known is not None:
                return
            if start is not None:
                yield begun(own)
            for plain in plain_models(base, hilbert, recordings):
                progress("that explains little; again from another start")
                yield begun(plain)

        model = known or begun(base)
        progress("maximum likelihood, from prediction to simulation")
        asked = [key for key, p in model.parameters().items() if p.std is not None]  # data asked for it before
        shapes = tuple(shape for shape in shapes_of(model) if shape not in (*fixed, *asked))
        how = {"doubted": doubted and not shapes, "near": near or known is not None, "drifts": drifts}
        fit = maximum_likelihood(model, recordings, (*fixed, *kept, *shapes), data, others=others, **how)
        return _with_shapes(fit, recordings, data, (*fixed, *kept), doubted=doubted) if shapes else fit

    def of_modes(fit: Fit | None, model: Oscillator | None, kept: Sequence[str] = (), *, doubted: bool) -> Fit:
        begin = None if model is None else with_fixed(model, fixed, final=False)
        drifts = [] if fit is None else [o.begun(recordings) for o in fit.offsets if o.channel == "drift"]
        return answer(recordings, begin, kept, drifts, doubted=doubted)

    first = answer(recordings, None, doubted=doubted)
    found_to_differ = None if any(r.differs for r in recordings) else differing(first, recordings)
    if found_to_differ is not None:
        progress("what differs between the recordings")
        each, mean = found_to_differ
        likelier = odds(again := answer(each, mean, doubted=doubted), first)
        _log.info("recordings that differ: log-odds %.3g", likelier)
        if likelier > DECISIVE:
            first, recordings = again, each
    found_modes = Modes(first)
    if start is None and not effects:
        found_modes = with_more_modes(found_modes, of_modes, ringing_modes(recordings, wanted), doubted=doubted)
    unheld, kept = recordings, found_modes.kept
    fit, recordings, chain = with_hold(found_modes.fit, unheld, partial(answer, kept=kept), doubted=doubted)
    for other in (found_modes.more, found_modes.fewer):
        # neither a mode nor a hold tells without the other where both are missing, and each imitates the other
        if other is None or (chain and other is found_modes.more):
            continue
        again, held, words = with_hold(other.fit, unheld, partial(answer, kept=other.kept), doubted=doubted)
        if words and (stand(again, fit) if other is found_modes.more else not stand(fit, again)):
            fit, kept, recordings, chain = again, other.kept, held, words
    if chain and start is None and not effects:  # under a wrong hold no number of modes leaves noise
        found_modes = with_more_modes(Modes(fit, tuple(kept)), of_modes, doubted=doubted)
        fit, kept = found_modes.fit, found_modes.kept
        fit = replace(fit, oscillator=replace(fit.oscillator, hold=hold_of_recordings(recordings)))
    several = len(modes_of_fit(fit.oscillator)) > 1
    if start is None and not effects:
        how = {"recordings": recordings, "fixed": (*fixed, *kept), "doubted": doubted}
        fit = _out_of_a_well(fit, partial(maximum_likelihood, **how))
    if not every:
        progress("whether a plainer model explains as much")
        held = tuple(recordings)

        def plainer(model: Oscillator, zero: Sequence[str]) -> Fit:
            near = max(part.over_noise for part in fit.segments) <= LACKING
            return maximum_likelihood(model, held, (*fixed, *kept, *zero), doubted=False, near=near)

        fit = plainest(fit, plainer)
    if start is None and not effects and doubted:
        fit = likeliest_stop(fit, recordings)
    faulty: dict[int, str] = {}
    if doubted or faults:
        progress("whether the recordings contradict each other")
        strange = None if effects or fixed or start or several else _alone
        found = explain_residual(fit, recordings, asked=faults, alone=strange)
        fit, faulty, chain = found.fit, found.faults, (*chain, *found.notes)
        if faults and not faulty and not found.notes:
            chain = (*chain, _NO_FAULT[any(part.over_noise > ABOVE_NOISE for part in fit.segments)])
    fit, spread = with_spread(fit, recordings)
    refuse_unknown(fit, recordings)
    kinds = [kind_of(recording, hilbert.decays[i]) for i, recording in enumerate(recordings)]
    oscillator = with_provenance(fit, recordings, curves=hilbert.curves, kinds=kinds, band=band, faults=faulty)
    work = meter.read(sum(recording.n for recording in recordings))
    _log.info("%s", work)
    return Identification(
        oscillator=oscillator,
        hilbert=hilbert,
        fit=fit,
        recordings=tuple(recordings),
        notes=(
            *([] if leading else [LEADS_NOWHERE]),
            *([] if wanted is None else _of_another_mode(oscillator, wanted)),
            *hilbert.notes,
            *([hold_note("zero")] if switched else []),
            *chain,
            *spread,
            *fit.notes,
            *_remarks(fit, recordings),
            *left_over(oscillator),
        ),
        faults=tuple(f"{recordings[i].name}: {words}" for i, words in faulty.items()),
        work=work,
        modes_left=_modes_left(fit, recordings),
        differs=spread,
    )


def _of_another_mode(oscillator: Oscillator, wanted: float) -> list[str]:
    """That the model is of another mode than the wanted one, in Hz, which stands beside it."""
    modes = [(omega / (2 * np.pi), gain) for omega, _, gain in modes_of_fit(oscillator)]
    own, (nearest, gain) = modes[0][0], min(modes, key=lambda mode: abs(np.log(mode[0] / wanted)))
    if nearest == own or not gain < 0.0:
        return []
    return [
        f"the sensor shows the mode at {nearest:.4g} Hz against the force, as no mass moves: the model is of the mode "
        f"at {own:.4g} Hz, and that one stands beside it as a further mode"
    ]


def _out_of_a_well(fit: Fit, answer: Callable[[Oscillator], Fit]) -> Fit:
    """The fit, or that from no preload, where the preload came out negative and that is likelier.

    A negative preload makes two wells, and a motion in one of them under a load looks like one about the middle.
    """
    preload = fit.oscillator.preload
    loaded = any(offset.channel == "force" for offset in fit.offsets)
    if preload.std is None or not preload.value < (0.0 if loaded else -SIGNIFICANT * preload.std):
        return fit
    try:
        other = answer(fit.oscillator.with_parameters({"preload": replace(preload, value=0.0)}))
    except BadInput:
        return fit
    return other if odds(other, fit) > 0.0 else fit


def _modes_left(fit: Fit, recordings: Sequence[Recording]) -> str | None:
    if max(s.over_noise for s in fit.segments) < LACKING:
        return None
    others = modes_beside(recordings, [omega / (2 * np.pi) for omega, _, _ in modes_of_fit(fit.oscillator)])
    if not others:
        return None
    there = f"{'is' if len(others) == 1 else 'are'} {', '.join(map(str, others))}"
    return (
        f"it does not hold all modes that ring: beside it there {there}; the parameters may be off by more than their "
        "errors, and --mode takes one alone"
    )


def _alone(recordings: Sequence[Recording]) -> Fit:
    """Eq. 17 of some recordings, from starts of their own."""
    hilbert = hilbert_start(recordings)
    model = estimated(hilbert, recordings, "alone")
    return maximum_likelihood(model, recordings, doubted=False, others=lambda: plain_models(model, hilbert, recordings))


def with_fixed(model: Oscillator, values: Mapping[str, float], *, final: bool) -> Oscillator:
    """The model with parameters set; raises BadInput for a name that it does not have, once all its laws are in."""
    known, bounds = model.parameters(), model.bounds()
    for name, value in values.items():
        checked_value(name, value, *(bounds.get(name, ()) if "." in name else ()))
    if final and (unknown := [key for key in values if key not in known and key != "mass"]):
        near = difflib.get_close_matches(unknown[0], known, n=1)
        meant = f"did you mean {near[0]}? The" if near else "the"
        there = ", ".join(dict.fromkeys(["mass", *known]))
        raise BadInput(f"there is no parameter {unknown[0]!r} to fix; {meant} model has {there}")
    if "mass" in values and model.mass is None:
        model = Oscillator.from_values(
            model.values() | {"mass": values["mass"]},
            name=model.name,
            response=model.response,
            force_unit=model.force_unit,
            laws=tuple(term.law for term in model.terms),
        )
    return holding(model, values)


def _with_shapes(
    fit: Fit, recordings: Sequence[Recording], data: Data, fixed: tuple[str, ...], *, doubted: bool
) -> Fit:
    """The fit; the shapes of laws, such as the sharpness of a bend, are freed where more than noise is left."""
    if max(s.over_noise for s in fit.segments) >= LACKING:
        freed = maximum_likelihood(fit.oscillator, recordings, fixed, data, doubted=False, near=True)
        fit = freed if _left(freed) < _left(fit) else fit
    if not doubted or fit.memory != FREE:
        return fit
    kept = tuple(name for name in fit.oscillator.parameters() if name not in fit.names)
    try:
        return maximum_likelihood(fit.oscillator, recordings, kept, data, near=True)
    except BadInput:  # it tells the beginning of a decay alone, and nothing simulates the whole from there
        return fit


def plain_models(start: Oscillator, hilbert: HilbertEstimate, recordings: Sequence[Recording]) -> Iterator[Oscillator]:
    """Linear rigs: see ``plain_starts``."""
    known = start.parameters()
    for plain in plain_starts(hilbert, recordings):
        values = {"cubic": 0.0, "preload": 0.0, "dry": 0.0} | plain
        changed = {name: replace(known[name], value=value) for name, value in values.items() if name in known}
        yield start.with_parameters(changed)


def _left(fit: Fit) -> float:
    """Mean logarithm of what is left of the motion, by which fits of different stretches can be compared."""
    size = [s.segment.n for s in fit.segments]
    return float(np.average([np.log(max(s.nrmse, np.finfo(float).tiny)) for s in fit.segments], weights=size))


def belong_together(recordings: Sequence[Recording]) -> None:
    """Raises BadInput where recordings cannot be of one rig, its units of length and force, or one is there twice."""
    if not recordings:
        raise BadInput("no recording was given; name at least one file with a decay or a driven response")
    first = recordings[0]
    refuse_prescribed(recordings)
    for problem in overlapping(recordings):
        raise BadInput(problem.sentence)
    moving = [(r, oscillation_of(r)) for r in recordings if np.ptp(r.response) > 0 and r.n > 1]
    for problem in (problem for recording, motion in moving for problem in reversed_force(recording, motion)):
        raise BadInput(problem.sentence)
    unrelated = [p for recording, motion in moving for p in no_reach(recording, motion) if p.severity == "error"]
    if len(unrelated) == len(recordings):  # else the others say what there is
        raise BadInput("\n".join(problem.sentence for problem in unrelated))
    for other in recordings[1:]:
        if not of_one_motion(other, Response(first.quantity, first.unit)):
            raise BadInput(
                f"{other.name} records {other.quantity} in {other.unit}, {first.name} {first.quantity} in "
                f"{first.unit}, which has no factor to it; give both in units of length, or one of them at a time"
            )
    forced = [r for r in recordings if r.force is not None and np.ptp(r.force) > 0]  # a load that stays drives nothing
    units = {r.force_unit for r in forced}
    if len(units) > 1:
        raise BadInput(f"the forces are in different units ({', '.join(sorted(units))}); give them in one unit")
    moved = [r for r in forced if np.std(r.response) > FREE_OF_FRICTION * response_of(r).noise]
    for quantity in {r.quantity for r in moved}:
        alike = [r for r in moved if r.quantity == quantity]
        forces = {r.name: 0.0 if r.force is None else float(np.std(r.force)) for r in alike}
        gains = {r.name: float(np.std(r.response)) / forces[r.name] for r in alike if forces[r.name] > 0}
        if not gains:
            continue
        low, high = min(gains, key=lambda k: gains[k]), max(gains, key=lambda k: gains[k])
        if gains[high] > GAIN_RATIO * gains[low]:
            raise BadInput(
                f"{high} moves {gains[high] / gains[low]:.0f} times as far per unit of force as {low}; "
                "one of them has another unit or is another rig: check the columns' units"
            )


def of_one_motion(recording: Recording, response: Response) -> bool:
    """Whether a recording shows the displacement of a model, or a derivative of it, in the units of its response."""
    return Response(recording.quantity, recording.unit).displacement_unit == response.displacement_unit


def _like_none(fit: Fit) -> list[str]:
    """A sentence on what is no larger than twice its error, and what to do where it stays in the model for that."""
    names = [
        name
        for name, p in fit.oscillator.parameters().items()
        if p.std is not None and abs(p.value) < 2 * p.std and name not in ("mass", "omega0")
    ]
    if not names:
        return []
    said = f"{spoken(names)} {'are' if names[1:] else 'is'} not distinguishable from zero in these recordings"
    if max(part.over_noise for part in fit.segments) > LACKING:
        fixed = " ".join(f"--fix {name}=0" for name in names if "." not in name)  # a law is left out without --with
        stay, them = ("they stay", "them") if names[1:] else ("it stays", "it")
        said += f"; {stay} in the model, for what that leaves may have bent {them}{fixed and f' ({fixed})'}"
    return [said]


def _remarks(fit: Fit, recordings: Sequence[Recording]) -> list[str]:
    remarks = []
    family = "model" if fit.oscillator.terms else "Eq. 17 family"
    remarks += [offset.sentence(recordings[offset.recording]) for offset in fit.offsets]
    for name in ("viscous", "dry", "preload"):
        parameter = getattr(fit.oscillator, name)
        if parameter.std is not None and parameter.value < -SIGNIFICANT * parameter.std:
            remarks.append(f"{name} came out negative, a sign that the {family} lacks something these recordings show")
    remarks += _like_none(fit)
    for segment in fit.segments:
        if has_lost(segment, fit):
            start = segment.segment.time
            remarks.append(
                f"{recordings[segment.segment.recording].name}, from {start:.3g} s: the model leaves "
                f"{left_of_parts([segment]).of_motion} unexplained"
            )
    return remarks
