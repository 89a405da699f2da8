"""Laws where no simulation keeps step: told apart by prediction over a cycle, and led from there to a simulation.

Far from the truth a structure has lost the motion, and what a law would make of the path it took says nothing of the
law. Predicted over a cycle every structure follows, the right ones better. Those that do best go the way that
identification goes, which knows of no other structure: from prediction to simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace

from ...errors import DashpotError
from ...identify.fit.likelihood import maximum_likelihood
from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted, Structure, shapes_of
from ...identify.start.further_laws import MEMORY, placed
from ...model.law import Law
from .starts import HALF, Proposal


def by_prediction(fitted: Fitted, data: Data, laws: Sequence[Law], cost: float) -> list[Proposal]:
    """Laws that make a prediction over a cycle better, where a fit that knows nothing else ends with them.

    Args:
        fitted: a structure beside which they are put.
        data: what it was fitted to.
        laws: those that are asked, but for those with side valleys, which are asked for in their own way.
        cost: of a parameter, in log-likelihood.
    """
    near, laws = replace(data, memory=MEMORY), [law for law in laws if not law.rugged]
    kept = [name for name in fitted.model.parameters() if name not in fitted.free]
    try:
        known = Structure(fitted.model, near, kept).fit(None).likelihood
    except DashpotError:
        return []
    with ThreadPoolExecutor(max_workers=2) as pool:
        found = list(pool.map(lambda law: placed(fitted.model, law, data, dict.fromkeys(kept)), laws))
    gains = {
        law.name: place.likelihood - known - cost * sum(not (p.shape or p.scale) for p in law.parameters)
        for law, place in zip(laws, found, strict=True)
        if place is not None
    }
    best = max(gains.values(), default=0.0)
    proposals = []
    for law, place in zip(laws, found, strict=True):
        if place is None or not gains[law.name] > max(HALF * best, 0.0):
            continue
        fixed = (*kept, *(name for name in shapes_of(place.model) if name not in kept))
        with suppress(DashpotError):  # nothing simulates from there
            fit = maximum_likelihood(place.model, data.recordings, fixed, data, doubted=False)
            proposals.append(Proposal(law.name, fit.oscillator, None, gains[law.name]))
    return proposals
