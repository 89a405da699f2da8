"""The third step of a diagnosis: rivals to their end, laws that the best structure does without, and plainer laws.

Four questions follow one another, each asked of the answer to the one before.

0. *Has what cannot be told from its laws been fitted to its end?* A race counts samples, and leaves behind what the
   witnesses of a mismatch may not tell from the best. Such a rival is fitted to its end and weighed, and may lead, as
   does what is most probable in the place of a law.
1. *Is its strength zero within its own error?* Where the path depends on small differences, or on a search's longer
   steps and coarser force, a further law may be odds on and yet come out with a strength that is as likely none. Where
   the others leave nothing but noise without it, it is not named: what is named must be seen in the fit as delivered.
2. *Is it a plainer law on these recordings?* Of two stops one is touched, and the other may be anywhere. Both laws then
   move the rig alike, so that no odds tell them apart; what no recording carries is not named. Neither is a contact's
   damping where none is as likely as what comes out: then the plainer law is the likelier one. And the sine of a
   pendulum's own angle needs no width: fitted, it and the straight spring beside it replace one another along a valley
   in which no search comes to rest, and neither is what it is called.
3. *Do whole recordings in one run speak against it?* A race weighs frequencies by a noise that the mismatch itself
   may have shaped. Where stretches of one recording are held out, each piece has an initial state of its own
   besides, and what a law does to the phase from one piece to the next is not seen. A model is used in one run, so
   of the best structure and of those evaluated with one law less that one is taken which leaves least of the whole
   recordings.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from dataclasses import replace
from statistics import NormalDist

import numpy as np

from ..errors import BadInput
from ..identify.problem.data import Data
from ..identify.problem.prediction import FREE
from ..identify.problem.structure import Fitted, Structure, without_states
from ..identify.signals.odds import BEYOND_ERRORS, DECISIVE
from ..identify.signals.registry import numerics
from ..model import Oscillator
from ..model.library import find
from ..model.terms import with_term, without_term
from .case import Case, Progress
from .delivery import refitted
from .family import cut_for
from .limits import ALIKE, GROUP
from .search.candidate import Candidate, key
from .search.found import Found
from .search.judgement import MATTERS, leading, leaves_mismatch, standing, tells_as_well
from .search.measure import Measure
from .search.race import PATIENCE, Entry, continued, race, started
from .search.starts import handed_down
from .search.weigh import forget, judged
from .time_allowed import SEARCHED, TimeAllowed, part_at

#: Standard errors within which the share ``GROUP`` of what is none comes out.
_TOLD = -NormalDist().inv_cdf((1 - GROUP) / 2)
_AT_REST = numerics(0.0025, "log-likelihood", why="a fourteenth of a standard error: nothing is left to be found")

_log = logging.getLogger(__name__)


def simplify(case: Case, found: Found, progress: Progress, allowed: TimeAllowed) -> Found:
    """The best structure less what it does without; see above.

    Args:
        case: what the diagnosis is about.
        found: of the search.
        progress: called with what is being done and how much of all is done.
        allowed: what the whole may take: without time left, the rivals are compared as far as they came.
    """
    progress("rivals of what was found", part_at(SEARCHED, bool(found.selected.laws)))
    found = with_most_probable(with_rivals_fitted(found, lambda: allowed.checking))
    weighing, several = found.weighing, len(found.selected.laws) > 1
    if weighing.data.memory == FREE and several and not leaves_mismatch(found.selected, weighing.parts):
        progress("whether all laws are needed", SEARCHED)
        found = without_needless(found, lambda fitted: refitted(fitted, case.model, case.recordings).oscillator)
    found = with_plainer_laws(found)
    if len(found.selected.laws) > 1:
        whole = cut_for(case.family, case.uncut, case.model)
        found = best_in_one_run(found, replace(whole, memory=FREE))
    forget()
    return found


# Rivals that left the race.


def with_rivals_fitted(found: Found, checking: Callable[[], bool] = lambda: True) -> Found:
    """The best structure once each law that cannot be told from one of its own was fitted to its end and weighed.

    Those are not that come where no time is left for checking.
    """
    tried: set[tuple[str, ...]] = set()
    while True:
        selected, parts, candidates = found.selected, found.weighing.parts, list(found.candidates.values())
        rivals = {
            key((*(other for other in selected.laws if other != law), rival))
            for law in selected.laws
            for rival in standing(law, selected, candidates, parts).rivals
        }
        rivals = {laws for laws in rivals if found.candidates[laws].stage != "judged"} - tried
        if not rivals:
            return found
        if not checking():
            return replace(found, untried=(*found.untried, "rivals fitted to their end"))
        tried |= rivals
        evaluated = []
        for laws in sorted(rivals):
            fitted = found.candidates[laws].fit
            assert fitted is not None
            fixed = [name for name in fitted.model.parameters() if name not in fitted.free]
            begun = fitted.initial, fitted.offsets
            if fit := _at_rest(Entry(laws, fitted.model, *begun, fixed, patience=PATIENCE), found):
                evaluated.append(found.weighing.weigh(laws, fit))
        found = replace(found, candidates=dict(found.candidates) | {one.laws: one for one in evaluated})
        best = leading(selected, evaluated, parts)
        if best.laws != selected.laws:
            found = _exchanged(found, best, f"fitted to its end, {best.name} is as near")


def with_most_probable(found: Found) -> Found:
    """The best structure with what is most probable in the place of each law; a search counts laws, a name unknowns."""
    for law in found.selected.laws:
        first = standing(law, found.selected, list(found.candidates.values()), found.weighing.parts).first
        other = found.candidates.get(key((*(name for name in found.selected.laws if name != law), first)))
        if first in ("", law) or other is None or other.stage != "judged":
            continue
        if tells_as_well(other, found.selected):
            found = _exchanged(found, other, f"for as many unknowns as it has, {first} is more probable")
    return found


# Laws whose strength is zero within its error.


def without_needless(found: Found, delivered: Callable[[Fitted], Oscillator]) -> Found:
    """The best structure less the laws that it can do without, one after another, the least certain first.

    Args:
        found: of a search, the best at the noise.
        delivered: the model as it would be delivered, with standard errors; raises BadInput where none simulates.
    """
    while len(found.selected.laws) > 1 and found.selected.fit is not None:
        try:
            certain = certainty(delivered(found.selected.fit), found.selected.laws)
        except BadInput:
            break
        smaller = _smaller(
            found, [law for law in sorted(certain, key=certain.__getitem__) if certain[law] < BEYOND_ERRORS]
        )
        if smaller is None:
            break
        why = "beside the others its strength is zero within its error, and without it they leave no more than noise"
        found = _exchanged(found, smaller, why)
    return found


def certainty(model: Oscillator, laws: tuple[str, ...]) -> dict[str, float]:
    """By how many of its errors the surest strength of each law differs from none; inf for one without an error."""
    sure = {}
    for term in model.terms:
        strengths = [term.parameters[p.name] for p in term.law.parameters if p.strength]
        if term.effect in laws:
            errors = [abs(p.value) / p.std if p.std else math.inf for p in strengths]
            sure[term.effect] = max(errors, default=math.inf)
    return sure


def of_unknown_size(model: Oscillator, laws: tuple[str, ...]) -> dict[str, str]:
    """Of laws whose strength their own error leaves open, which are therefore not named, a sentence each."""
    return {
        law: f"{law} is in the model and not named: its strength is zero within its error. Something acts like it, and "
        "how much of it there is, and whether it is this, these recordings leave open"
        for law, sure in certainty(model, laws).items()
        if sure < _TOLD
    }


def _smaller(found: Found, weak: list[str]) -> Candidate | None:
    """The structure less the first of the laws without which nothing but noise is left; None where none is."""
    for name in weak:
        less = _without(found, name)
        if less is None:
            continue
        candidate = found.weighing.weigh(key([law for law in found.selected.laws if law != name]), less)
        if not leaves_mismatch(candidate, found.weighing.parts):
            return candidate
        _log.info("%s stays: its strength is zero within its error, but without it more than noise is left", name)
    return None


def _without(found: Found, name: str) -> Fitted | None:
    """The structure less one of its laws, fitted from where it is; None where that does not simulate."""
    fitted = found.fitted
    laws = key([law for law in found.selected.laws if law != name])
    fixed = [other for other in fitted.model.parameters() if other not in fitted.free]
    smaller = handed_down(fitted, found.weighing.data, name)
    return _at_rest(Entry(laws, smaller, without_states(fitted, name), fitted.offsets, fixed, patience=PATIENCE), found)


# Laws that are a plainer one.


def with_plainer_laws(found: Found) -> Found:
    """The best structure with each law as the plainer one that it is along all recordings, or that is likelier."""
    for name in found.selected.laws:
        selected = found.selected
        law, fitted = find(name), selected.fit
        if law.cases is None or fitted is None:
            continue
        values = {n: p.value for term in fitted.model.terms if term.effect == name for n, p in term.parameters.items()}
        taken = {term.effect for term in fitted.model.terms}
        for plainer, own in law.cases(values):
            if plainer in taken:  # a model has no law twice
                continue
            laws = key([plainer if other == name else other for other in selected.laws])
            case = with_term(without_term(fitted.model, name), plainer, dict(own))
            candidate = _evaluated(laws, case, fitted, found)
            most = selected.value - (DECISIVE if _alike(case, fitted, found.weighing.data) else 0.0)
            if candidate is not None and candidate.value > most:
                found = _exchanged(found, candidate, f"it moves the rig as {plainer} does, which has fewer parameters")
                break
    return _of_the_angle(found)


def _of_the_angle(found: Found) -> Found:
    """The same with what the angle itself tells (``LawParameter.in_radians``), where that is likelier than fitted."""
    selected, fitted, data = found.selected, found.selected.fit, found.weighing.data
    if fitted is None or fitted.model.response.displacement_unit != "rad":
        return found
    exact = {
        name: p.in_radians
        for term in fitted.model.terms
        for p in term.law.parameters
        if p.in_radians is not None and (name := f"{term.effect}.{p.name}") in fitted.free
    }
    if not exact:
        return found
    parameters = fitted.model.parameters()
    there = fitted.model.with_parameters({name: replace(parameters[name], value=v) for name, v in exact.items()})
    fixed = [name for name in parameters if name not in fitted.free or name in exact]
    # the others have made up for what was fitted, and simulated with it they lose the motion
    try:
        held = Structure(continued(there, data, fixed), data, fixed).fit(tolerance=_AT_REST)
    except BadInput:
        return found
    candidate = found.weighing.weigh(selected.laws, held)
    return found.instead(candidate) if candidate.value > selected.value else found


def _alike(case: Oscillator, fitted: Fitted, data: Data) -> bool:
    """Whether a model moves as a fit does, from the same initial states."""
    structure = Structure(case, data)
    residuals = structure.problem.residuals(structure.state(fitted.initial, fitted.offsets))
    pairs = zip(residuals, fitted.residuals, data.sensor, strict=True)
    return all(float(np.sqrt(np.mean((new - old) ** 2))) <= ALIKE * noise for new, old, noise in pairs)


def _evaluated(laws: tuple[str, ...], case: Oscillator, fitted: Fitted, found: Found) -> Candidate | None:
    """The plainer structure, fitted from where it is and evaluated; None where it does not simulate."""
    fixed = [name for name in case.parameters() if name in fitted.model.parameters() and name not in fitted.free]
    fit = _at_rest(Entry(laws, case, fitted.initial, fitted.offsets, fixed, patience=PATIENCE), found)
    return None if fit is None else found.weighing.weigh(laws, fit)


# Laws that whole recordings in one run speak against.


def best_in_one_run(found: Found, whole: Data) -> Found:
    """The best structure, less one law after another as long as the whole recordings are explained better without it.

    Args:
        found: of a search, with all that was evaluated.
        whole: the recordings uncut.
    """
    left = left_of(found.selected, whole)
    while len(found.selected.laws) > 1:
        laws = found.selected.laws
        shorter = [found.candidates.get(key([law for law in laws if law != name])) for name in laws]
        tried = [(left_of(c, whole), c) for c in shorter if c is not None and c.stage == "judged" and c.fit is not None]
        least, best = min(tried, key=lambda pair: pair[0], default=(np.inf, found.selected))
        if not left - least > np.log1p(MATTERS):
            break
        found = _exchanged(found, best, "without one of its laws the whole recordings are explained better in one run")
        left = least
    return found


def left_of(candidate: Candidate, whole: Data) -> float:
    """Logarithm of the part of the power that free simulation leaves, on average over the recordings."""
    assert candidate.fit is not None
    residuals = judged(candidate.fit.model, whole).residuals
    pairs = zip(residuals, whole.segments, strict=True)
    parts = [float(np.mean(residual**2)) / float(np.var(segment.response)) for residual, segment in pairs]
    return float(np.mean(np.log(np.maximum(parts, np.finfo(float).tiny))))


# What the three share.


def _at_rest(entry: Entry, found: Found) -> Fitted | None:
    """A structure fitted from where it is; None where that does not simulate."""
    data = found.weighing.data
    start = started(entry, data, Measure())
    if start is None:
        return None
    race([start], Measure(), None, data.points)
    return start.fitted


def _exchanged(found: Found, other: Candidate, why: str) -> Found:
    """Another structure as the best, with the reason for it."""
    _log.info("%s instead of %s: %s", other.name, found.selected.name, why)
    return found.instead(other, why)
