"""Which parameters moved between states of a rig: the fewest whose change explains the difference.

Estimates of one rig trade parameters against each other: a softer spring to one fit is a heavier mass to the next. So
it is not asked of each parameter alone whether its values differ, but of each set of parameters whether the states
differ in nothing else: those in the set have a value in each state, the others one for all (generalised least squares,
with the joint covariances). What that leaves is chi², or F where the errors were themselves learnt; the smallest set
that leaves no more than chance is named (Fisher 1925).

Where the models leave more than noise, their parameters are off by more than their errors, in a way that repeats share.
Then the parameters that did not move say how far: few causes move few parameters (effect sparsity, Box and Meyer
1986). A parameter is named where it takes away more than those that are left differ by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..identify.signals.odds import BY_CHANCE, DECISIVE
from .repeatability import KNOWN, Repeatability

#: Degrees of freedom that must be left to judge by what did not move.
_FEWEST = 2


@dataclass(frozen=True, eq=False)
class States:
    """m states of a rig, each with the estimate that its repeats make together.

    Attributes:
        names: (k) of the parameters.
        values: (m, k) in the estimates' scale.
        covariance: (m, k, k).
        repeatability: that is in the covariance.
    """

    names: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    repeatability: Repeatability


def joined(
    names: tuple[str, ...],
    values: np.ndarray,
    stated: np.ndarray,
    groups: Sequence[Sequence[int]],
    repeatability: Repeatability,
) -> States:
    """The estimates (n, k) of each group of places made into one, by generalised least squares."""
    inverse = np.linalg.inv(repeatability.covariance(stated))
    weights = np.array([inverse[list(group)].sum(axis=0) for group in groups])
    sums = np.array([np.einsum("ijk,ik->j", inverse[list(g)], values[list(g)]) for g in groups])
    covariance = np.linalg.inv(weights)
    return States(names, np.einsum("ijk,ik->ij", covariance, sums), covariance, repeatability)


@dataclass(frozen=True)
class Hypothesis:
    """That nothing but some parameters moved.

    Attributes:
        moved: their names.
        left: chi² of what that leaves, in units of the errors; ``freedom`` its degrees of freedom.
        chance: how often chance alone leaves as much.
    """

    moved: tuple[str, ...]
    left: float
    freedom: int
    chance: float


@dataclass(frozen=True, eq=False)
class Moved:
    """What moved.

    Attributes:
        nothing: the hypothesis that nothing did.
        best: the one that is believed.
        rivals: other sets of as many parameters that explain the difference as well, to the level of doubt.
        alone: each parameter's hypothesis that it alone moved.
        inflation: variance by which what did not move differs beyond the errors; 1 where the errors are known.
        common: (k,) the value of what did not move, by all states together; NaN of what moved.
        values, errors: (m, k) each state's value of what moved, given that the rest did not, and its standard error;
            of the rest its common value.
        apart: (m, k) the part of these errors that the states do not share: that of their differences.
    """

    nothing: Hypothesis
    best: Hypothesis
    rivals: tuple[Hypothesis, ...]
    alone: tuple[Hypothesis, ...]
    inflation: float
    common: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    apart: np.ndarray


def what_moved(states: States, level: float = BY_CHANCE) -> Moved:
    """The fewest parameters whose change explains how the states differ.

    Args:
        states: two or more.
        level: how often chance alone may be taken for a change.
    """
    names = states.names
    nothing, alone = _tested(states, ()), tuple(_tested(states, (name,)) for name in names)
    rest = not states.repeatability.trusted and _tested(states, names[:1]).freedom >= _FEWEST
    best = _by_the_rest(states, nothing, level) if rest else _fewest(states, nothing, level)
    inflation = max(1.0, best.left / best.freedom) if rest and best.freedom else 1.0
    same = [h for h in _beside(states, best) if h.moved != best.moved]
    rivals = [h for h in same if (h.left - best.left) / (2 * inflation) < DECISIVE and (rest or h.chance > level)]
    return Moved(nothing, best, tuple(rivals), alone, inflation, *values_given(states, best.moved, inflation))


def _tested(states: States, moved: Sequence[str]) -> Hypothesis:
    """What is left where nothing but ``moved`` did."""
    from scipy.special import chdtrc, fdtrc

    stay = [i for i, name in enumerate(states.names) if name not in moved]
    left, freedom = _heterogeneity(states, stay), (len(states.values) - 1) * len(stay)
    if not stay:
        return Hypothesis(tuple(moved), 0.0, 0, 1.0)
    known = 1.0 / float(np.mean(1.0 / states.repeatability.freedom[stay]))
    chance = chdtrc(freedom, left) if known >= KNOWN else fdtrc(freedom, known, left / freedom)
    return Hypothesis(tuple(moved), left, freedom, float(chance))


def _heterogeneity(states: States, stay: list[int]) -> float:
    """chi² of the states' values of ``stay`` about a common one, the other parameters free in each state."""
    if not stay:
        return 0.0
    inverse = np.linalg.inv(states.covariance[np.ix_(range(len(states.values)), stay, stay)])
    values = states.values[:, stay]
    mean = np.linalg.solve(inverse.sum(axis=0), np.einsum("ijk,ik->j", inverse, values))
    return float(np.einsum("ij,ijk,ik->", values - mean, inverse, values - mean))


def _grown(states: States, moved: tuple[str, ...]) -> Hypothesis:
    """One parameter more, the one that takes away most."""
    more = [_tested(states, (*moved, name)) for name in states.names if name not in moved]
    return min(more, key=lambda hypothesis: hypothesis.left)


def _fewest(states: States, nothing: Hypothesis, level: float) -> Hypothesis:
    """Parameters are added until chance explains the rest; then those that are not needed are left out again."""
    found = nothing
    while found.chance <= level and len(found.moved) < len(states.names):
        found = _grown(states, found.moved)
    for name in found.moved[:-1]:
        without = _tested(states, tuple(other for other in found.moved if other != name))
        if without.chance > level:
            found = without
    return found


def _by_the_rest(states: States, nothing: Hypothesis, level: float) -> Hypothesis:
    """Parameters are added while each takes away more than the rest differs by, in the light of how many are tried."""
    from scipy.special import fdtrc

    found, steps = nothing, len(states.values) - 1
    while len(found.moved) < len(states.names) - 1:
        next_one = _grown(states, found.moved)
        if next_one.freedom < _FEWEST:
            break
        noise = max(1.0, next_one.left / next_one.freedom)
        tried = len(states.names) - len(found.moved)
        chance = tried * float(fdtrc(steps, next_one.freedom, (found.left - next_one.left) / steps / noise))
        if chance > level:
            break
        found = next_one
    return found


def _beside(states: States, best: Hypothesis) -> list[Hypothesis]:
    """Hypotheses of as many parameters as the best, one of them exchanged."""
    made = []
    for name in best.moved:
        kept = tuple(other for other in best.moved if other != name)
        made += [_tested(states, (*kept, other)) for other in states.names if other not in best.moved]
    return made


def values_given(
    states: States, moved: Sequence[str], inflation: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """See ``Moved``: common, values, errors and apart, given that all but ``moved`` is the same in all states."""
    m, k = states.values.shape
    go = [i for i, name in enumerate(states.names) if name in moved]
    stay = [i for i in range(k) if i not in go]
    common, values, errors, apart = np.full(k, np.nan), np.empty((m, k)), np.zeros((m, k)), np.zeros((m, k))
    covariance = inflation * states.covariance
    if not stay:
        own = np.sqrt(np.einsum("ijj->ij", covariance))
        return common, states.values, own, own
    inner = covariance[np.ix_(range(m), stay, stay)]
    inverse = np.linalg.inv(inner)
    of_mean = np.linalg.inv(inverse.sum(axis=0))
    common[stay] = of_mean @ np.einsum("ijk,ik->j", inverse, states.values[:, stay])
    values[:, stay], errors[:, stay] = common[stay], np.sqrt(np.diag(of_mean))
    across = covariance[np.ix_(range(m), go, stay)]
    gain = across @ inverse
    values[:, go] = states.values[:, go] + np.einsum("ijk,ik->ij", gain, common[stay] - states.values[:, stay])
    own = np.einsum("ijj->ij", covariance[np.ix_(range(m), go, go)] - gain @ np.swapaxes(across, 1, 2))
    for made, weight in ((errors, gain), (apart, gain - gain.mean(axis=0))):
        doubt = own + np.einsum("ijk,kl,ijl->ij", weight, of_mean, weight)
        made[:, go] = np.sqrt(np.maximum(doubt, 0.0))
    return common, values, errors, apart
