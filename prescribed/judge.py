"""Which structure of an element is more probable, by the same odds as an oscillator's: see ``diagnose/search``.

Where what is left is noise, every sample is a witness. Where it is a mismatch its samples repeat each other: blocks of
some cycles count by how unlike they are, any smooth function of displacement and velocity takes its part by chance, and
as many laws as there are may be the cause.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..diagnose.limits import GROUP
from ..identify.fit.mismatch import gain_of_mismatch
from ..identify.signals.odds import ABOVE_NOISE
from ..identify.signals.registry import budget, numerics
from ..model.laws import LIBRARY, PRESCRIBED
from .fit import Fitted, Problem, basis_of

BAGS = budget(100, "draws of the blocks", why="a probability of a half is then known to a twentieth")
_DRAWN = budget(30, "functions", why="whose largest twentieth is known to some hundredths of the power")
_WAVES = numerics(12, "cosines", why="of which a random smooth function is made: nearly a Gaussian process")
_ROUGH = numerics(0.7, "of the largest amplitude", why="the length over which it changes: that of a cubic or of a bend")
_MOST = numerics(0.99, "of the power", why="what is left is never nothing")
_HOPELESS = numerics(1e6, "log-odds", why="against what runs away: beyond any that a recording gives")
_FINEST = numerics(1e-12, "of a column", why="rounding")


class Judge:
    """Compares structures that are fitted to the same motions, and judged by the same held-out ones."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        motions = [*problem.motions, *problem.held]
        self._segments = [motion.segment(i) for i, motion in enumerate(motions)]
        self._told = [motion.told for motion in motions]
        self._noise = [motion.noise for motion in motions]
        self._chance: dict[int, tuple[Fitted, np.ndarray, np.ndarray]] = {}

    def times_the_noise(self, fitted: Fitted) -> list[float]:
        """Rms of what is left of each motion, held-out ones last, over the noise."""
        return [
            float(np.sqrt(np.mean(left[told] ** 2))) / noise
            for left, told, noise in zip(self._left(fitted), self._told, self._noise, strict=True)
        ]

    def mismatch(self, fitted: Fitted) -> float:
        """Part of the power that it leaves which is no noise."""
        ratio = max(self.times_the_noise(fitted))
        return 1.0 - (ABOVE_NOISE / ratio) ** 2 if ratio > ABOVE_NOISE else 0.0

    def odds(self, one: Fitted, other: Fitted, bags: int = 0) -> np.ndarray:
        """(1 + bags,) logarithm of how many times more probable one is than another; then in bags of the blocks."""
        lost = [not all(np.all(np.isfinite(left)) for left in self._left(fitted)) for fitted in (one, other)]
        if any(lost):  # what runs away along a motion that was held out is no answer
            return np.full(1 + bags, _HOPELESS * (lost[1] - lost[0]))
        points, more = self.problem.points, one.count - other.count
        total = one.likelihood - other.likelihood - 0.5 * more * math.log(points)
        share = self.mismatch(one if total >= 0.0 else other)
        if share <= 0.0:
            return np.full(1 + bags, total)
        gain, worth = gain_of_mismatch(self._left(other), self._left(one), self._segments, bags)
        if more:
            fewer = other if more > 0 else one
            gain += math.copysign(0.5 * worth, more) * math.log1p(-share * self._by_chance(fewer, abs(more)))
        laws = one.shape.causes - other.shape.causes
        samples = sum(int(np.count_nonzero(told)) for told in self._told)
        gain *= 1.0 / (worth / samples + share)
        return np.clip(gain - share * laws * math.log(len(LIBRARY) + len(PRESCRIBED)), -abs(total), abs(total))

    def _left(self, fitted: Fitted) -> list[np.ndarray]:
        return [*fitted.residuals, *fitted.held]

    def _by_chance(self, fitted: Fitted, count: int) -> float:
        """Part of the power left that random smooth functions of the motion take away: of the best twentieth of them.

        They are functions of the channels too, where there are any. Less what the members and laws that are there can
        imitate.
        """
        if id(fitted) not in self._chance:
            self._chance[id(fitted)] = (fitted, *self._drawn(fitted))
        _, columns, left = self._chance[id(fitted)]
        rng, shares = np.random.default_rng(1), []
        power = float(left @ left)
        for first in range(_DRAWN):
            others = rng.permutation(np.delete(np.arange(_DRAWN), first))[: min(count, _DRAWN) - 1]
            asked = columns[[first, *others]]
            size = np.linalg.norm(asked, axis=1, keepdims=True)
            basis = np.linalg.qr((asked / np.maximum(size, _FINEST)).T)[0]
            shares.append(float(np.sum((left @ basis) ** 2)) / max(power, np.finfo(float).tiny))
        return float(np.clip(np.quantile(shares, GROUP), 0.0, _MOST))

    def _drawn(self, fitted: Fitted) -> tuple[np.ndarray, np.ndarray]:
        """(drawn, told) of all motions together, and what is left of them."""
        problem, rng = self.problem, np.random.default_rng(0)
        along = rng.normal(size=(_DRAWN, _WAVES, 2 + len(problem.spans))) / _ROUGH
        phase, size = rng.uniform(0.0, 2.0 * np.pi, (_DRAWN, _WAVES)), rng.normal(size=(_DRAWN, _WAVES))
        rows, own, left = [], [], []
        for motion, residual in zip(problem.motions, fitted.residuals, strict=True):
            x = (motion.displacement - problem.origin) / problem.scales.length
            beside = [(motion.channels[name] - span.reference) / span.half for name, span in problem.spans.items()]
            place = np.stack([x, motion.velocity / (problem.scales.length * motion.pace), *beside])[:, motion.told]
            made = [s @ np.cos(w @ place + p[:, None]) for w, p, s in zip(along, phase, size, strict=True)]
            known = problem.columns(fitted.shape, fitted.values, motion)[:, motion.told]
            rows.append(np.array(made) - np.mean(made, axis=1, keepdims=True))
            own.append(known - np.mean(known, axis=1, keepdims=True))
            left.append(residual[motion.told])
        whole, basis = np.concatenate(rows, axis=1), basis_of(np.concatenate(own, axis=1))
        whole = whole - (whole @ basis) @ basis.T
        return whole, np.concatenate(left)


def probability(odds: Sequence[np.ndarray]) -> np.ndarray:
    """(k,) of structures with these odds (1 + bags,) against one of them: their mean over the bags."""
    weights = np.exp(np.array(odds) - np.max(odds, axis=0))
    return np.mean(weights / np.sum(weights, axis=0), axis=1)
