"""Evidence for a model: how probable it makes the recordings, all that is unknown in it averaged over.

Laplace's approximation (MacKay 1992; Kass and Raftery 1995): the likelihood at its maximum, times the prior there,
times the volume that the recordings leave to the unknowns. Parameters, offsets, initial states and phases are all
unknowns, so that each pays for what it could have been, and none is counted. Priors are those of Cauchy with the
natural size of each unknown (Jeffreys 1961): they rule out nothing.

The evidence of recordings that were held out is that of all, less that of the training recordings (the chain rule): the
likelihood averaged over what training has left open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..problem.linearised import Sums

#: (2, unknowns): middle and width of Cauchy's density.
Prior = np.ndarray


@dataclass(frozen=True, eq=False)
class Marginal:
    """Quadratic expansion of the log-likelihood in the shared unknowns, the initial states integrated out.

    Attributes:
        log_likelihood: at the point where everything was taken, initial states averaged over.
        information: (k, k) of parameters and offsets.
        gradient: (k,) of the log-likelihood there.
    """

    log_likelihood: float
    information: np.ndarray
    gradient: np.ndarray


def marginalised(
    log_likelihood: float, own: Sums, unknown: np.ndarray, values: np.ndarray, prior: Prior, k: int
) -> Marginal:
    """Average a likelihood over the initial states of a segment, and over what else is its own.

    Args:
        log_likelihood: at the point where ``own`` was taken.
        own: of the segment; the k shared unknowns come first.
        unknown: (m,) places of its own unknowns. Others that are neither these nor shared are known.
        values: (m,) of these.
        prior: of these.
        k: number of shared unknowns.
    """
    of_both = own.only(np.concatenate([np.arange(k), unknown]))
    precision = prior[1] ** -2.0
    averaged = of_both.without(slice(k, None), precision)
    inner = of_both.normal[k:, k:] + np.diag(precision)
    gained = 0.5 * (own.power - averaged.power)
    total = log_likelihood + log_prior(values, prior) + gained - _half_volume(inner)
    # of what initial states explain as well rounding leaves less than nothing: it tells nothing
    told = np.diag(averaged.normal) > np.finfo(float).eps * len(of_both.normal) * np.diag(of_both.normal)[:k]
    return Marginal(total, averaged.normal * np.outer(told, told), averaged.gradient * told)


def evidence(training: Marginal, values: np.ndarray, prior: Prior) -> float:
    """Log-evidence of what was fitted.

    Args:
        training: at the maximum.
        values: (k,) of the shared unknowns there.
        prior: of these.
    """
    matrix = training.information + np.diag(prior[1] ** -2.0)
    return training.log_likelihood + log_prior(values, prior) - _half_volume(matrix)


def predictive(held_out: Marginal, training: Marginal, prior: Prior) -> float:
    """Log-probability of recordings that were held out, averaged over what the training recordings leave open.

    Where the held-out recordings would move the parameters, they may, as far as training leaves room.
    """
    before = training.information + np.diag(prior[1] ** -2.0)
    after = _log_integral(before + held_out.information, held_out.gradient)
    return held_out.log_likelihood + after - _log_integral(before, np.zeros(len(before)))


def cross_validated(stretches: Sequence[Marginal], prior: Prior) -> float:
    """Log-probability of each stretch given all others, summed: what a model says of what it was not fitted to.

    Leaving a stretch out moves the parameters by one step of the linearised response, and widens what they may be.

    Args:
        stretches: all expanded at one point, the maximum for all together.
        prior: of the parameters.
    """
    own = np.diag(prior[1] ** -2.0)
    information = sum((part.information for part in stretches), own)
    gradient = np.sum([part.gradient for part in stretches], axis=0)
    total = 0.0
    for part in stretches:
        with_it = _log_integral(information, gradient)
        without = _log_integral(information - part.information, gradient - part.gradient)
        total += part.log_likelihood + with_it - without
    return float(total)


def _log_integral(matrix: np.ndarray, gradient: np.ndarray) -> float:
    """Logarithm of the integral of exp(gradient step - step matrix step / 2), less what its dimension makes."""
    return 0.5 * (float(gradient @ np.linalg.solve(matrix, gradient)) - _log_determinant(matrix))


def log_prior(values: np.ndarray, prior: Prior) -> float:
    """Log-density of Cauchy's distribution, all unknowns together."""
    middle, width = prior
    return float(-np.sum(np.log(np.pi * width * (1.0 + ((values - middle) / width) ** 2))))


def _half_volume(matrix: np.ndarray) -> float:
    """Half the logarithm of |matrix / 2 pi|: what the volume of a Gaussian takes away."""
    return 0.5 * (_log_determinant(matrix) - len(matrix) * float(np.log(2 * np.pi)))


def _log_determinant(matrix: np.ndarray) -> float:
    """In the scale of its diagonal, so that units do not matter."""
    if not matrix.size:
        return 0.0
    size = np.sqrt(np.diag(matrix))
    eigenvalues = np.linalg.eigvalsh(matrix / np.outer(size, size))
    floor = np.finfo(float).eps * len(matrix)
    return float(np.sum(np.log(np.maximum(eigenvalues, floor))) + 2.0 * np.sum(np.log(size)))
