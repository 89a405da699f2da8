"""The stretches of a life in each of which nothing moved, and what moved between them.

A row of states is cut in two where its parts differ most; if what differs is more than chance makes of that many places
to cut, each part is cut in its turn (binary segmentation: Vostrikova 1981). So a step that is small beside the scatter
of single tests still shows by the many before and behind it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..identify.signals.odds import BEYOND_ERRORS
from .estimates import Estimates
from .moved import Moved, States, joined, values_given, what_moved
from .repeatability import Repeatability
from .steps import Step, drift_of, steps_of

#: Fewer states than that are not cut: each is a stretch of its own.
_FEW = 6
#: Median of the size of a standard normal variable.
_MIDDLE = 0.6745


@dataclass(frozen=True, eq=False)
class Found:
    """What moved, and where.

    Attributes:
        moved: which parameters.
        cuts: the first state of each stretch but the first, where stretches were sought.
        steps: of each parameter that moved.
        drifts: change per state of each of them that moves in a straight line rather than in steps, with its error.
        values, errors: (m, k) of each state, in the estimates' scale, given that what did not move did not.
    """

    moved: Moved
    cuts: tuple[int, ...]
    steps: tuple[Step, ...]
    drifts: dict[str, tuple[float, float]]
    values: np.ndarray
    errors: np.ndarray


def judged(estimates: Estimates, groups: Sequence[Sequence[int]], known: Repeatability, level: float) -> Found | None:
    """What moved between the states whose estimates ``groups`` names; None where there is one."""
    m = len(groups)
    if m < 2:
        return None
    states = _of(estimates, groups, known)
    edges = _cut(estimates, groups, known, 0, m, level) if m >= _FEW else list(range(m + 1))
    cuts = tuple(edges[1:-1]) if m >= _FEW else ()
    if len(edges) == 2:  # no place to cut: what differs, if anything, goes to and fro
        edges = list(range(m + 1))
    whole = [[place for group in groups[a:b] for place in group] for a, b in pairwise(edges)]
    moved = what_moved(_of(estimates, whole, known), level)
    stretch = np.repeat(np.arange(len(whole)), np.diff(edges))
    steps: list[Step] = []
    drifts: dict[str, tuple[float, float]] = {}
    _, single, _, own = values_given(states, moved.best.moved, moved.inflation)
    for name in moved.best.moved:
        j = estimates.names.index(name)
        scale = estimates.scale[j]
        freedom = min(float(known.freedom[j]), moved.best.freedom if moved.inflation > 1 else math.inf)
        found = steps_of(name, moved.values[:, j] * scale, moved.apart[:, j] * scale, freedom, level)
        slope = drift_of(single[:, j] * scale, own[:, j] * scale, level) if len(found) > 1 else None
        if slope is not None:
            drifts[name] = slope
        steps += [Step(name, edges[step.state], step.before, step.after, step.error) for step in found]
    return Found(
        moved=moved,
        cuts=cuts,
        steps=tuple(sorted(steps, key=lambda step: step.state)),
        drifts=drifts,
        values=moved.values[stretch],
        errors=moved.errors[stretch],
    )


def _of(estimates: Estimates, groups: Sequence[Sequence[int]], known: Repeatability) -> States:
    return joined(estimates.names, estimates.values, estimates.covariance, groups, known)


def _cut(
    estimates: Estimates, groups: Sequence[Sequence[int]], known: Repeatability, low: int, high: int, level: float
) -> list[int]:
    """Edges of the stretches between the states ``low`` and ``high``."""
    if high - low < 2:
        return [low, high]
    at = low + 1 + int(np.argmax(_apart(_of(estimates, groups[low:high], known))))
    before, behind = ([place for group in groups[a:b] for place in group] for a, b in ((low, at), (at, high)))
    if not what_moved(_of(estimates, [before, behind], known), level / (len(groups) - 1)).best.moved:
        return [low, high]
    left = _cut(estimates, groups, known, low, at, level)
    return [*left[:-1], *_cut(estimates, groups, known, at, high, level)]


def _apart(states: States) -> np.ndarray:
    """(m - 1,) chi² by which the states before and from each place on differ."""
    weight = np.linalg.inv(states.covariance)
    sums = np.cumsum(weight, axis=0), np.cumsum(np.einsum("ijk,ik->ij", weight, states.values), axis=0)
    sides = [(sums[0][:-1], sums[1][:-1]), (sums[0][-1] - sums[0][:-1], sums[1][-1] - sums[1][:-1])]
    covariance = [np.linalg.inv(w) for w, _ in sides]
    means = [np.einsum("ijk,ik->ij", c, s) for c, (_, s) in zip(covariance, sides, strict=True)]
    difference = means[1] - means[0]
    return np.einsum("ij,ijk,ik->i", difference, np.linalg.inv(covariance[0] + covariance[1]), difference)


def leaps(estimates: Estimates, groups: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """States that differ from the one before by more than neighbours do: a thousand times as likely a step as scatter.

    How far neighbours lie apart is taken from the median of all their distances, which few steps do not move.
    """
    first = [group[0] for group in groups]
    variance = np.einsum("ijj->ij", estimates.covariance)[first]
    apart = np.abs(np.diff(estimates.values[first], axis=0)) / np.sqrt(variance[1:] + variance[:-1])
    usual = np.maximum(np.median(apart, axis=0) / _MIDDLE, 1.0)
    return tuple(int(i) + 1 for i in np.flatnonzero(np.any(apart > BEYOND_ERRORS * usual, axis=1)))


def neighbours(groups: Sequence[Sequence[int]], cuts: Collection[int]) -> list[list[int]]:
    """Pairs of successive states within the stretches between cuts, as if one were the other's repeat."""
    edges = [0, *sorted(cuts), len(groups)]
    return [[groups[i][0], groups[i + 1][0]] for low, high in pairwise(edges) for i in range(low, high - 1, 2)]
