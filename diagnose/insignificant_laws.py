"""Laws beside another that their own errors do not tell from none.

Where the path hangs by a hair, or by what a search's longer steps and coarser force do, a further law may be odds on
and yet come out with a strength that is as likely none. Where the others leave nothing but noise without it, it is not
named: what is named must be seen in the fit as it is delivered.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from ..errors import BadInput
from ..identify.problem.structure import Fitted, without_states
from ..identify.signals.odds import BEYOND_ERRORS
from ..model import Oscillator
from .search.candidate import Candidate, key
from .search.judgement import leaves_mismatch
from .search.measure import Measure
from .search.race import PATIENCE, Entry, race, started
from .search.search import Search
from .search.starts import handed_down

#: Standard errors: within so many of them, 95 % of what is none comes out.
_TOLD = 1.96


def without_needless(selected: Candidate, search: Search, delivered: Callable[[Fitted], Oscillator]) -> Candidate:
    """The best structure less the laws that it can do without, one after another, the least certain first.

    Args:
        selected: the best of the search, at the noise.
        search: that it came from, with its recordings.
        delivered: the model as it would be delivered, with standard errors; raises BadInput where none simulates.
    """
    while len(selected.laws) > 1 and selected.fit is not None:
        try:
            certain = certainty(delivered(selected.fit), selected.laws)
        except BadInput:
            break
        smaller = _smaller(
            selected, [law for law in sorted(certain, key=certain.__getitem__) if certain[law] < BEYOND_ERRORS], search
        )
        if smaller is None:
            break
        why = "beside the others its strength is zero within its error, and without it they leave no more than noise"
        search.candidates[selected.laws] = replace(selected, why=why)
        search.candidates[smaller.laws] = selected = smaller
    return selected


def certainty(model: Oscillator, laws: tuple[str, ...]) -> dict[str, float]:
    """By how many of its errors the surest strength of each law differs from none; inf for one without an error."""
    sure = {}
    for term in model.terms:
        strengths = [term.parameters[p.name] for p in term.law.parameters if p.strength]
        if term.effect in laws:
            errors = [abs(p.value) / p.std if p.std else math.inf for p in strengths]
            sure[term.effect] = max(errors, default=math.inf)
    return sure


def of_unknown_size(model: Oscillator, laws: tuple[str, ...]) -> list[str]:
    """A sentence for each law that is named for what it takes away, and whose strength its own error leaves open."""
    return [
        f"{law}: its strength is zero within its error: something acts like it, and how much of it there "
        "is, and whether it is this, these recordings leave open"
        for law, sure in certainty(model, laws).items()
        if sure < _TOLD
    ]


def _smaller(selected: Candidate, weak: list[str], search: Search) -> Candidate | None:
    """The structure less the first of the laws without which nothing but noise is left; None where none is."""
    for name in weak:
        less = _without(selected, name, search)
        if less is None:
            continue
        candidate = search.weigh(key([law for law in selected.laws if law != name]), less)
        if not leaves_mismatch(candidate, search.parts):
            return candidate
    return None


def _without(selected: Candidate, name: str, search: Search) -> Fitted | None:
    """The structure less one of its laws, fitted from where it is; None where that does not simulate."""
    fitted = selected.fit
    assert fitted is not None
    laws = key([law for law in selected.laws if law != name])
    fixed = [other for other in fitted.model.parameters() if other not in fitted.free]
    smaller = handed_down(fitted, search.data, name)
    entry = Entry(laws, smaller, without_states(fitted, name), fixed, patience=PATIENCE)
    start = started(entry, search.data, Measure())
    if start is None:
        return None
    race([start], Measure(), None, search.data.points)
    return start.fitted
