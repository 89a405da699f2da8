"""The log-likelihood in which structures are compared: of noise by its own spectrum, of a mismatch by its power.

What a wrong model leaves is no noise. Weighed by its own spectrum, what is explained least would count least, and a
structure could buy some quiet frequencies with the motion itself. So only what is noise is given a spectrum.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...identify.data import Data, likelihood, noise_spectra
from ...identify.descent import cost_of
from ...identify.noise_spectrum import NoiseSpectrum, white
from ...identify.structure import Fitted
from ...model import Oscillator
from .residual_test import leftovers, times_the_noise

#: What is left within this many times the noise is told apart by frequency, whatever it is.
NEAR = 1.2


def is_noise(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> bool:
    """Whether what a model leaves is near the noise in size, or at least does not move with the rig."""
    if max(times_the_noise(residuals, model, data)) <= NEAR:
        return True
    left = leftovers(Fitted(model, np.zeros((0, 0)), tuple(residuals), 0.0, ()), data)
    return not any(part.is_mismatch for part in left)


def plausibility(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> float:
    """Log-likelihood: Whittle's of noise, that of a level alone of a mismatch; -inf where it does not simulate.

    The first is never below the second (Jensen's inequality), so that a mismatch cannot gain by its colour.
    """
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return -np.inf
    return likelihood(residuals, model, data) if is_noise(residuals, model, data) else -cost_of(residuals, None)


def weights(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> list[NoiseSpectrum]:
    """The spectra that go with it."""
    if is_noise(residuals, model, data):
        return noise_spectra(residuals, model, data)
    return [white(residual) for residual in residuals]
