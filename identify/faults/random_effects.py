"""Parameters that each recording has of its own: a random effect about a common mean (Laird and Ware 1982).

About the point at which every recording has its own values the likelihood is a quadratic form. From it follow how much
is lost where some of them do not differ, how far the others scatter, and the most probable mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..problem.linearised import Linearised, Sums
from ..problem.normal_equations import pseudo_inverse
from ..problem.search_point import State
from ..signals.registry import numerics

_SIZES = numerics(41, "sizes of a spread", why="from a tenth to ten times of what is seen, 12 % apart")
_ROUNDS = numerics(3, "rounds", why="the sizes for several parameters hardly depend on each other")


@dataclass(frozen=True, eq=False)
class OwnValues:
    """The likelihood about the point at which each recording has parameters of its own.

    Attributes:
        sums: over the common parameters, then the deviations of each kind, all recordings; all else eliminated.
        common: how many of them are common.
        here: (kinds, recordings) deviations at the point.
    """

    sums: Sums
    common: int
    here: np.ndarray

    @staticmethod
    def of(linearised: Linearised, point: State, places: Sequence[int], first: int, count: int) -> OwnValues:
        """From a problem whose last unknowns are a deviation of each kind, of each recording but one.

        Args:
            linearised: the problem, at ``point``.
            point: where all are free.
            places: of the kinds among the parameters that are found.
            first: the recording, of ``count``, that has none.
            count: how many recordings there are.
        """
        common, kinds = len(linearised.unknowns.parameters), len(places)
        known = len(linearised.unknowns.shared) - common - kinds * (count - 1)
        shared = linearised.shared.without(slice(common, common + known))
        others = [i for i in range(count) if i != first]
        # the first one's deviation is that of all less that of the others
        made = np.zeros((len(shared.gradient), common + kinds * count))
        made[:common, :common] = np.eye(common)
        here = np.zeros((kinds, count))
        for k, place in enumerate(places):
            rows = common + k * (count - 1) + np.arange(count - 1)
            made[rows, common + k * count + np.array(others)] = 1.0
            made[place, common + k * count + first] = 1.0
            made[rows, common + k * count + first] = -1.0
            here[k, others] = point.offsets[known + k * (count - 1) + np.arange(count - 1)]
        wide = replace(shared, normal=made.T @ shared.normal @ made, gradient=made.T @ shared.gradient)
        return OwnValues(wide, common, here)

    def columns(self, kinds: Sequence[int]) -> np.ndarray:
        """Places of the deviations of some kinds."""
        count = self.here.shape[1]
        return np.concatenate([np.zeros(0, int), *(self.common + k * count + np.arange(count) for k in kinds)])

    def lost(self, kinds: Sequence[int], instead: np.ndarray | None = None, along: np.ndarray | None = None) -> float:
        """Log-likelihood that is lost at least where only these kinds differ, all the rest fitted.

        Args:
            kinds: which.
            instead: (ways, kinds, recordings) how the others may differ; not at all where this is None.
            along: (any, kinds, recordings) by any multiples of which they may differ besides.
        """
        gone = self.columns([k for k in range(len(self.here)) if k not in kinds])
        if not gone.size:
            return 0.0
        sums, columns = self.sums.without(np.setdiff1d(np.arange(len(self.sums.gradient)), gone)), gone - self.common
        ways = np.zeros((1, *self.here.shape)) if instead is None else instead
        steps = (ways - self.here).reshape(len(ways), self.here.size)[:, columns]
        slopes = sums.gradient - steps @ sums.normal
        left = sums.power - np.sum(steps * (sums.gradient + slopes), axis=1)
        if along is not None:
            further = along.reshape(len(along), self.here.size)[:, columns]
            toward = slopes @ further.T
            left = left - np.sum(toward @ pseudo_inverse(further @ sums.normal @ further.T) * toward, axis=1)
        return 0.5 * (float(np.min(left)) - sums.power) + sums.gain()

    def of_kinds(self, kinds: Sequence[int]) -> Sums:
        """Over the common parameters and the deviations of these kinds, where the others do not differ."""
        gone = self.columns([k for k in range(len(self.here)) if k not in kinds])
        kept = np.setdiff1d(np.arange(len(self.sums.gradient)), gone)
        moved = self.sums.normal[:, gone] @ -self.here.ravel()[gone - self.common]
        return replace(self.sums, gradient=self.sums.gradient - moved).only(kept)

    def sizes(self, kinds: Sequence[int]) -> np.ndarray:
        """(kinds,) the most probable standard deviations between recordings (restricted likelihood)."""
        sums, here, count = self.of_kinds(kinds), self.here[list(kinds)], self.here.shape[1]
        sizes = np.maximum(np.std(here, axis=1, ddof=1), np.finfo(float).tiny)
        for _ in range(_ROUNDS):
            for k in range(len(kinds)):
                tried = sizes[k] * np.geomspace(0.1, 10.0, _SIZES)
                value = []
                for size in tried:
                    precision = np.repeat(np.where(np.arange(len(kinds)) == k, size, sizes) ** -2.0, count)
                    value.append(_evidence(sums, here.ravel(), precision, self.common))
                sizes[k] = tried[int(np.argmax(value))]
        return sizes

    def effects(self, kinds: Sequence[int], sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(common,) step to the means, and the most probable (kinds, recordings) deviations from them."""
        sums, here = self.of_kinds(kinds), self.here[list(kinds)]
        step = _posterior(sums, here.ravel(), np.repeat(sizes**-2.0, here.shape[1]), self.common)
        return step[: self.common], here + step[self.common :].reshape(here.shape)


def _scattering(sums: Sums, precision: np.ndarray, common: int) -> np.ndarray:
    """Normal matrix, where the deviations behind the ``common`` parameters have a Gaussian prior."""
    return sums.normal + np.diag(np.concatenate([np.zeros(common), precision]))


def _posterior(sums: Sums, here: np.ndarray, precision: np.ndarray, common: int) -> np.ndarray:
    """Step to the most probable values where the deviations, ``here`` at the point, scatter about zero."""
    pull = np.concatenate([np.zeros(common), precision * here])
    return pseudo_inverse(_scattering(sums, precision, common)) @ (sums.gradient - pull)


def _evidence(sums: Sums, here: np.ndarray, precision: np.ndarray, common: int) -> float:
    """Logarithm of the probability of what was found, all unknowns averaged over, but for a constant."""
    step, normal = _posterior(sums, here, precision, common), _scattering(sums, precision, common)
    size = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    left = 0.5 * (sums.left(step) - sums.power) + 0.5 * float(precision @ (here + step[common:]) ** 2)
    volume = float(np.linalg.slogdet(normal / np.outer(size, size))[1]) + 2.0 * float(np.sum(np.log(size)))
    return 0.5 * (float(np.sum(np.log(precision))) - volume) - left
