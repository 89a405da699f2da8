"""Laws that are a plainer one on the recordings at hand: of two stops one is touched, and the other may be anywhere.

Both then move the rig alike, so that no odds tell them apart; what no recording carries is not named. Neither is a
contact's damping where none is as likely as what comes out: then the plainer law is the likelier one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..identify.odds import DECISIVE
from ..identify.structure import Fitted, Structure
from ..model import Oscillator
from ..model.laws import find
from ..model.terms import with_term, without_term
from .search.candidate import Candidate, key
from .search.measure import Measure
from .search.race import PATIENCE, Entry, race, started
from .search.search import Search

#: Physical limit: motions that differ by less than this part of the noise are alike.
_ALIKE = 0.01


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
        for plainer, own in law.cases(values):
            laws = key([plainer if other == name else other for other in selected.laws])
            case = with_term(without_term(fitted.model, name), plainer, dict(own))
            if len(set(laws)) == len(selected.laws):
                candidate = _weighed(laws, case, fitted, search)
                most = selected.value - (DECISIVE if _alike(case, fitted, search) else 0.0)
                if candidate is not None and candidate.value > most:
                    why = f"it moves the rig as {plainer} does, which has fewer parameters"
                    search.candidates[selected.laws] = replace(selected, why=why)
                    search.candidates[laws] = selected = candidate
                    break
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
