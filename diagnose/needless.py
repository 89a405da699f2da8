"""Laws that only a search asked for: each is held against the fit as it is delivered.

A search compares structures by simulations with longer steps and a coarser force. Where several laws leave nothing but
noise, one of them may stand for what that coarseness did. So each must be needed by the fine fit too: without it, and
fitted as finely, the recordings must be decisively less likely.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..identify.delivered import Fit
from ..identify.odds import DECISIVE
from ..identify.prediction import FREE
from ..identify.structure import Fitted, without_states
from ..model.terms import without_term
from .search.candidate import Candidate, key
from .search.measure import Measure
from .search.race import PATIENCE, Entry, race, started
from .search.search import Search


def without_needless(selected: Candidate, search: Search, finely: Callable[[Fitted], Fit]) -> Candidate:
    """The best structure less the laws that the fine fit does without, one after another, the least needed first.

    Args:
        selected: the best of the search, at the noise.
        search: that it came from, with its recordings.
        finely: a structure as it would be delivered; it raises BadInput where that does not simulate.
    """
    while len(selected.laws) > 1 and selected.fit is not None:
        whole = _simulated(selected.fit, finely)
        smaller = {name: less for name in selected.laws if (less := _without(selected, name, search)) is not None}
        costs = {name: _cost(whole, _simulated(less, finely)) for name, less in smaller.items()}
        least = min(costs, key=lambda name: costs[name], default=None)
        if least is None or costs[least] > DECISIVE:
            break
        why = f"simulated as finely as a model is delivered it gains {costs[least]:.3g} in log-likelihood"
        search.candidates[selected.laws] = replace(selected, why=why)
        laws = key([law for law in selected.laws if law != least])
        selected = search.candidates[laws] = search.weigh(laws, smaller[least])
    return selected


def _simulated(fitted: Fitted, finely: Callable[[Fitted], Fit]) -> float:
    """Log-likelihood of the fine fit; -inf where it simulates nothing, or predicts."""
    try:
        fit = finely(fitted)
    except BadInput:
        return -np.inf
    return fit.log_likelihood if fit.memory == FREE else -np.inf


def _cost(whole: float, less: float) -> float:
    """What a structure loses without a law; without end where that cannot be told."""
    return whole - less if np.isfinite(whole) else np.inf


def _without(selected: Candidate, name: str, search: Search) -> Fitted | None:
    """The structure less one of its laws, fitted from where it is; None where that does not simulate."""
    fitted = selected.fit
    assert fitted is not None
    laws = key([law for law in selected.laws if law != name])
    fixed = [other for other in fitted.model.parameters() if other not in fitted.free]
    entry = Entry(laws, without_term(fitted.model, name), without_states(fitted, name), fixed, patience=PATIENCE)
    start = started(entry, search.data, Measure())
    if start is None:
        return None
    race([start], Measure(), None, search.data.points)
    return start.fitted
