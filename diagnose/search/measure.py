"""The log-likelihood in which structures are compared: one spectrum for all of them, and levels of each one's own.

A spectrum of its own would let a structure that leaves a mismatch buy some quiet frequencies with the motion itself:
what it explains least would count least. So the frequencies are weighted by the noise, as the structure that comes
nearest to it shows it; as long as none does, what is left is no noise, and every frequency counts alike. The level of
each stretch is concentrated out: far from the noise, gains are shares of what is left, and never shares of the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...identify.problem.data import Data, noise_spectra
from ...identify.problem.structure import Fitted
from ...identify.signals.noise_spectrum import NoiseSpectrum, white
from ...model import Oscillator
from ..limits import NEAR
from .residual_test import leftover, times_of_each


@dataclass(frozen=True, eq=False)
class Measure:
    """How the frequencies of each segment count.

    Attributes:
        noise: one spectrum per segment, up to its level; None where every frequency counts alike.
    """

    noise: tuple[NoiseSpectrum, ...] | None = None

    def value(self, residuals: Sequence[np.ndarray]) -> float:
        """Log-likelihood, up to what is the same for all structures; -inf where one does not simulate."""
        if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
            return -np.inf
        return sum(self.values(residuals))

    def values(self, residuals: Sequence[np.ndarray]) -> list[float]:
        """The same of each segment."""
        return [
            -0.5 * r.size * float(np.log(level)) for r, level in zip(residuals, self._levels(residuals), strict=True)
        ]

    def spectra(self, residuals: Sequence[np.ndarray]) -> list[NoiseSpectrum]:
        """The spectra at the levels of what a structure leaves."""
        if self.noise is None:
            return [white(residual) for residual in residuals]
        levels = self._levels(residuals)
        return [replace(s, density=level * s.density) for s, level in zip(self.noise, levels, strict=True)]

    def near(self, residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> bool:
        """Whether what a structure leaves is about the noise in size."""
        if self.noise is None:
            return max(times_of_each(residuals, model, data)) <= NEAR
        return max(self._levels(residuals)) <= NEAR**2

    def _levels(self, residuals: Sequence[np.ndarray]) -> list[float]:
        """Mean square of each segment, weighted."""
        if self.noise is not None:
            residuals = [s.whiten(residual) for s, residual in zip(self.noise, residuals, strict=True)]
        return [max(float(np.mean(residual**2)), np.finfo(float).tiny) for residual in residuals]


def measure_by(fitted: Fitted, data: Data) -> Measure:
    """The measure that a fitted structure gives: by the spectrum of what it leaves where that is noise."""
    if not fitted.finite or not _is_noise(fitted, data):
        return Measure()
    return Measure(tuple(noise_spectra(fitted.residuals, fitted.model, data)))


def _is_noise(fitted: Fitted, data: Data) -> bool:
    """Whether what is left is near the noise in size, or at least does not move with the rig."""
    ratios = times_of_each(fitted.residuals, fitted.model, data)
    if max(ratios) <= NEAR:
        return True
    # the loudest first: one that is no noise is enough
    parts = (leftover(fitted, data, i) for i in np.argsort(ratios)[::-1])
    return not any(part.is_mismatch or (part.short and part.ratio > NEAR) for part in parts)
