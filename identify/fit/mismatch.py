"""What a mismatch tells, of which no sample is a witness of its own.

What a wrong model leaves is one draw of an unknown function of the motion: more cycles of the same motion show the same
draw again, and only other motions show more of it (the likelihood of a wrong model is too sure of itself: White 1982).
So a mismatch is taken in blocks of some cycles, each a vector of the harmonics of the motion, and the blocks count by
how unlike they are. Levels are pooled over all blocks: a quiet block does not outvote a loud one.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ...recording.smoothing import analytic_of
from ..problem.segments import Segment
from .limits import CYCLES, HARMONICS

#: Components of a witness: the constant, then cosine and sine of each harmonic.
_COMPONENTS = 1 + 2 * HARMONICS
#: Log-likelihood that each independent witness gains by a factor of e in power: cosine and sine of each harmonic.
WITNESS = 2 * HARMONICS


def gain_of_mismatch(
    before: Sequence[np.ndarray], after: Sequence[np.ndarray], segments: Sequence[Segment], bags: int = 0
) -> tuple[np.ndarray, float]:
    """Gain of log-likelihood from one model to another, both of which leave a mismatch.

    Had other stretches of the motion been recorded the gain would be another: as many blocks drawn from those that
    there are, with repetition, show how much so (bags: Breiman 1996; of a wrong model's evidence: Huggins and Miller
    2023).

    Args:
        before, after: of each segment, what the two leave.
        segments: of the recordings; free and driven stretches of one sensor share one level each.
        bags: how many draws of the blocks, the same for the same segments.

    Returns:
        (1 + bags,) the gain of all blocks, then that of each bag; and as how many independent samples the mismatch
        counts.
    """
    kinds = [(segment.quantity, segment.force is None) for segment in segments]
    total, worth, rng = np.zeros(1 + bags), 0.0, np.random.default_rng(0)
    for kind in dict.fromkeys(kinds):
        places = [i for i, other in enumerate(kinds) if other == kind]
        old, new = (np.concatenate([_powers(left[i], segments[i]) for i in places]) for left in (before, after))
        drawn = np.vstack([np.ones(old.size), rng.multinomial(old.size, np.full(old.size, 1.0 / old.size), bags)])
        old, new = (np.maximum(drawn @ power, np.finfo(float).tiny) for power in (old, new))
        least = after if new[0] <= old[0] else before
        count = WITNESS * witnesses([least[i] for i in places], [segments[i] for i in places])
        worth += 2.0 * count
        total += count * np.log(old / new)
    return total, worth


def witnesses(residuals: Sequence[np.ndarray], segments: Sequence[Segment]) -> float:
    """How many independent witnesses a mismatch has: one where all blocks say the same, all of them where none does.

    The effective number of (tr C)² / tr C², of the inner products C of the blocks' vectors, less what vectors without
    any relation have on the mean.

    Args:
        residuals: of each segment, what is left.
        segments: along whose motion it was left.
    """
    vectors = np.concatenate([_vectors(left, segment) for left, segment in zip(residuals, segments, strict=True)])
    count = len(vectors)
    alike = float(np.sum((vectors.T @ vectors) ** 2)) - count
    return count / (1.0 + max(alike - count * (count - 1) / _COMPONENTS, 0.0) / max(count, 1))


def _blocks(segment: Segment) -> list[slice]:
    """Some cycles each."""
    count = max(1, int(segment.n * segment.dt * segment.pace / (2 * np.pi * CYCLES)))
    return [slice(a, b) for a, b in pairwise(np.linspace(0, segment.n, count + 1).astype(int).tolist())]


def _powers(residual: np.ndarray, segment: Segment) -> np.ndarray:
    """(blocks,) of what is left."""
    return np.array([float(np.sum(residual[block] ** 2)) for block in _blocks(segment)])


def _vectors(residual: np.ndarray, segment: Segment) -> np.ndarray:
    """(blocks, components) of what is left along the harmonics of the motion, of unit length."""
    motion = segment.response - residual
    analytic = analytic_of(motion - np.mean(motion))
    turn = analytic / np.maximum(np.abs(analytic), np.finfo(float).tiny)
    orders = [turn**k for k in range(1, HARMONICS + 1)]
    rows = np.vstack([np.full(turn.size, np.sqrt(0.5)), *(part for z in orders for part in (z.real, z.imag))])
    made = np.array([rows[:, block] @ residual[block] for block in _blocks(segment)])
    size = np.linalg.norm(made, axis=1, keepdims=True)
    return made / np.maximum(size, np.finfo(float).tiny)
