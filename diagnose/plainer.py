"""Laws that are a plainer one on the recordings at hand: of two stops one is touched, and the other may be anywhere.

Both then move the rig alike, so that no odds tell them apart; what no recording carries is not named. Neither is a
contact's damping where none is as likely as what comes out: then the plainer law is the likelier one. And the sine of a
pendulum's own angle needs no width: fitted, it and the straight spring beside it replace one another along a valley in
which no search comes to rest, and neither is what it is called.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..identify.problem.structure import Fitted, Structure
from ..identify.signals.odds import DECISIVE
from ..model import Oscillator
from ..model.library import find
from ..model.terms import with_term, without_term
from .search.candidate import Candidate, key
from .search.measure import Measure
from .search.race import PATIENCE, Entry, race, started
from .search.search import Search
from .search.start_from_simpler_model import led

#: Physical limit: motions that differ by less than this part of the noise are alike.
_ALIKE = 0.01
#: Gain in log-likelihood below which nothing is left to be found: a fourteenth of a standard error.
_AT_REST = 0.0025


def with_plainer_laws(selected: Candidate, search: Search) -> Candidate:
    """The best structure with each law as the plainer one that it is along all recordings, or that is likelier.

    Args:
        selected: the best of the search.
        search: that it came from, with its recordings.
    """
    for name in selected.laws:
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
            candidate = _weighed(laws, case, fitted, search)
            most = selected.value - (DECISIVE if _alike(case, fitted, search) else 0.0)
            if candidate is not None and candidate.value > most:
                why = f"it moves the rig as {plainer} does, which has fewer parameters"
                search.candidates[selected.laws] = replace(selected, why=why)
                search.candidates[laws] = selected = candidate
                break
    return _of_the_angle(selected, search)


def _of_the_angle(selected: Candidate, search: Search) -> Candidate:
    """The same with what the angle itself tells (``LawParameter.in_radians``), where that is likelier than fitted."""
    fitted = selected.fit
    if fitted is None or fitted.model.response.displacement_unit != "rad":
        return selected
    told = {
        name: p.in_radians
        for term in fitted.model.terms
        for p in term.law.parameters
        if p.in_radians is not None and (name := f"{term.effect}.{p.name}") in fitted.free
    }
    if not told:
        return selected
    parameters = fitted.model.parameters()
    there = fitted.model.with_parameters({name: replace(parameters[name], value=value) for name, value in told.items()})
    fixed = [name for name in parameters if name not in fitted.free or name in told]
    # the others have made up for what was fitted, and simulated with it they lose the motion
    try:
        held = Structure(led(there, search.data, fixed), search.data, fixed).fit(tolerance=_AT_REST)
    except BadInput:
        return selected
    candidate = search.weigh(selected.laws, held)
    if candidate.value > selected.value:
        search.candidates[selected.laws] = selected = candidate
    return selected


def _alike(case: Oscillator, fitted: Fitted, search: Search) -> bool:
    """Whether a model moves as a fit does, from the same beginnings."""
    structure = Structure(case, search.data)
    residuals = structure.problem.residuals(structure.state(fitted.initial, fitted.offsets))
    pairs = zip(residuals, fitted.residuals, search.data.sensor, strict=True)
    return all(float(np.sqrt(np.mean((new - old) ** 2))) <= _ALIKE * noise for new, old, noise in pairs)


def _weighed(laws: tuple[str, ...], case: Oscillator, fitted: Fitted, search: Search) -> Candidate | None:
    """The plainer structure, fitted from where it is and weighed; None where it does not simulate."""
    fixed = [name for name in case.parameters() if name in fitted.model.parameters() and name not in fitted.free]
    start = started(Entry(laws, case, fitted.initial, fixed, patience=PATIENCE), search.data, Measure())
    if start is None:
        return None
    race([start], Measure(), None, search.data.points)
    return search.weigh(laws, start.fitted)
