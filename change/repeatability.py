"""How far estimates of one unchanged rig lie apart: learnt from repeats, as random effects beside the stated errors.

Estimate i of a rig in one state is theta_i = mean + b_i + e_i. Its stated errors e_i have the covariance s² C_i: C_i as
the fit states it, s >= 1 what that is too small by (Birge 1932). What truly differs from one repeat to the next, b_i,
has a variance tau_j² for each parameter (random effects: Hartung, Knapp and Sinha 2008, chapter 9). s and tau are those
that make the repeats most likely, the means of the states left out of it (restricted maximum likelihood, Patterson and
Thompson 1971).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .estimates import Estimates

#: In a parameter's median standard error: below the one nothing is seen, above the other no search need go.
_LEAST, _MOST = 1e-2, 1e6
#: Of a variance that is known.
KNOWN = 1e6


@dataclass(frozen=True, eq=False)
class Repeatability:
    """What is added to the stated errors.

    Attributes:
        source: ``repeats``; ``neighbours``, where successive estimates stand for repeats; ``errors``, the stated ones.
        trusted: whether the models leave no more than noise; else what did not move says how far they can be believed.
        inflation: s² on the stated covariances, at least 1.
        spread: (k,) tau_j, the standard deviation between repeats beyond that, in the estimates' ``scale``.
        freedom: (k,) degrees of freedom of each parameter's error; KNOWN where nothing of it was learnt.
        learnt: degrees of freedom that the repeats had: their number less that of their states.
    """

    source: Literal["repeats", "neighbours", "errors"]
    trusted: bool
    inflation: float
    spread: np.ndarray
    freedom: np.ndarray
    learnt: int = 0

    def covariance(self, stated: np.ndarray) -> np.ndarray:
        """(n, k, k) covariance of estimates that state (n, k, k)."""
        return self.inflation * stated + np.diag(self.spread**2)


def stated_errors(k: int, *, trusted: bool) -> Repeatability:
    """The errors as they are stated; ``trusted`` where the models leave no more than noise."""
    return Repeatability("errors", trusted, 1.0, np.zeros(k), np.full(k, KNOWN))


def learnt_from(
    estimates: Estimates,
    groups: Sequence[Sequence[int]],
    *,
    trusted: bool,
    source: Literal["repeats", "neighbours"] = "repeats",
) -> Repeatability:
    """What repeats show.

    Args:
        estimates: of any rigs.
        groups: places of estimates of one rig in one state; those of a single one say nothing.
        trusted: whether the models leave no more than noise.
        source: where they come from.
    """
    groups = [list(group) for group in groups if len(group) > 1]
    freedom = sum(len(group) - 1 for group in groups)
    k = estimates.k
    if not freedom:
        return stated_errors(k, trusted=trusted)
    variance = _most_likely(estimates, groups)
    inflation, spread = float(variance[0]), np.where(variance[1:] > 2 * _LEAST**2, variance[1:], 0.0)
    mine = [i for group in groups for i in group]
    stated = np.mean(np.einsum("ijj->ij", estimates.covariance[mine]), axis=0)
    whole = inflation * stated + spread
    # Satterthwaite 1946: a variance of which the part f has nu degrees of freedom has nu / f²; s is shared by all k
    own, shared = spread / whole, (inflation - 1.0) * stated / whole
    doubt = own**2 / freedom + shared**2 / (freedom * k)
    return Repeatability(source, trusted, inflation, np.sqrt(spread), 1.0 / np.maximum(doubt, 1.0 / KNOWN), freedom)


def _most_likely(estimates: Estimates, groups: Sequence[Sequence[int]]) -> np.ndarray:
    """(1 + k,) s² and tau² at the maximum of the restricted likelihood."""
    from scipy.optimize import minimize

    k = estimates.k
    mine = np.array([i for group in groups for i in group])
    label = np.array([g for g, group in enumerate(groups) for _ in group])
    values, stated = estimates.values[mine], estimates.covariance[mine]

    def loss(logs: np.ndarray) -> float:
        variance = np.exp(logs)
        inverse = np.linalg.inv(variance[0] * stated + np.diag(variance[1:]))
        weight, pull = np.zeros((len(groups), k, k)), np.zeros((len(groups), k))
        np.add.at(weight, label, inverse)
        np.add.at(pull, label, np.einsum("ijk,ik->ij", inverse, values))
        rest = values - np.einsum("ijk,ik->ij", np.linalg.inv(weight), pull)[label]
        total = np.einsum("ij,ijk,ik->", rest, inverse, rest)
        total += np.sum(np.linalg.slogdet(weight)[1]) - np.sum(np.linalg.slogdet(inverse)[1])
        return 0.5 * float(total)

    means = np.array([values[label == g].mean(axis=0) for g in range(len(groups))])
    moment = np.sum((values - means[label]) ** 2, axis=0) / (len(mine) - len(groups))
    floor, ceiling = 2 * np.log(_LEAST), 2 * np.log(_MOST)
    bounds = [(0.0, ceiling), *[(floor, ceiling)] * k]
    wide = np.clip(np.log(np.maximum(moment, 1e-12)), floor, ceiling)
    starts = [np.concatenate([[0.0], wide]), np.concatenate([[np.clip(wide.mean(), 0.0, ceiling)], np.full(k, -1.0)])]
    found = [minimize(loss, start, method="L-BFGS-B", bounds=bounds) for start in starts]
    return np.exp(min(found, key=lambda result: result.fun).x)
