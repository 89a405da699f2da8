"""Laws with which whole recordings are told worse in one run than without.

Where stretches of one recording are held out, each piece has a beginning of its own, and what a law does to the phase
from one piece to the next is not seen. A model is used in one run, so the structure with which the whole recordings are
told best is taken of the best one and of those, among what was weighed, that have one law less.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..identify.problem.data import Data
from .search.candidate import Candidate, key
from .search.judgement import MATTERS
from .search.search import Search
from .search.weigh import judged


def told_best_in_one_run(selected: Candidate, search: Search, whole: Data) -> Candidate:
    """The best structure, less one law after another as long as the whole recordings are told better without it.

    Args:
        selected: the best of the search.
        search: with all that was weighed.
        whole: the recordings uncut.
    """
    left = left_of(selected, whole)
    while len(selected.laws) > 1:
        shorter = [search.candidates.get(key([law for law in selected.laws if law != name])) for name in selected.laws]
        tried = [(left_of(c, whole), c) for c in shorter if c is not None and c.stage == "judged" and c.fit is not None]
        least, best = min(tried, key=lambda pair: pair[0], default=(np.inf, selected))
        if not left - least > np.log1p(MATTERS):
            break
        why = "without one of its laws the whole recordings are explained better in one run"
        search.candidates[selected.laws] = replace(selected, why=why)
        selected, left = best, least
    return selected


def left_of(candidate: Candidate, whole: Data) -> float:
    """Logarithm of the part of the power that free simulation leaves, on average over the recordings."""
    assert candidate.fit is not None
    residuals = judged(candidate.fit.model, whole).residuals
    pairs = zip(residuals, whole.segments, strict=True)
    parts = [float(np.mean(residual**2)) / float(np.var(segment.response)) for residual, segment in pairs]
    return float(np.mean(np.log(np.maximum(parts, np.finfo(float).tiny))))
