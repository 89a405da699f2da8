"""Inner states that begin at the limit of what they can reach."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..signals.registry import numerics

_NEAR_REACH = numerics(0.98, "part of its limit", why="at which a limited inner state begins where it begins at it")


def nearest_reach(
    initial: np.ndarray, reaches: np.ndarray, own: Sequence[int], misfit: Callable[[np.ndarray], float]
) -> np.ndarray:
    """An initial state, its limited inner states where they suit best: as they are, or near either limit.

    A contact that slides when a decay begins is at its limit, and has no derivative there that would lead to it.

    Args:
        initial: (states,).
        reaches: (states,) the limits, 0 where there is none.
        own: which of the states may be moved.
        misfit: of an initial state; not-a-number where it does not simulate.
    """
    for k in own:
        if not reaches[k] > 0:
            continue
        candidates = [initial]
        for position in (-_NEAR_REACH * reaches[k], 0.0, _NEAR_REACH * reaches[k]):
            moved = initial.copy()
            moved[k] = position
            candidates.append(moved)
        values = [misfit(candidate) for candidate in candidates]
        initial = candidates[int(np.nanargmin(values))] if np.any(np.isfinite(values)) else initial
    return initial
