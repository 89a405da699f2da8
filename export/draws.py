"""Draws of the parameters from the covariance of their estimates: models that the recordings allow as well.

The estimates of a maximum-likelihood fit are normally distributed about the true values (Ljung 1999, section 9.2). What
a parameter cannot be (a negative mass, a value beyond the bounds of its law) is rejected and drawn again, so that the
draws are those of the normal distribution under the condition that nature's limits hold. Clipping would instead
pile up draws at the limit and give each of them partners that belong to another value.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..model.consistency import covariance_problem

if TYPE_CHECKING:
    from ..model import Oscillator

#: So many are tried for each draw before it is said that there are too few.
_TRIES = 1000
#: What nature wants positive though no bound of its law says so: a fit may find it negative, then it stays free.
_POSITIVE = ("preload", "viscous")


def draws(oscillator: Oscillator, count: int, seed: int = 0) -> list[dict[str, float]]:
    """``count`` sets of parameters as plausible as the identified one.

    Args:
        oscillator: a model whose ``identified`` holds a covariance.
        count: how many; with more of them the first stay the same.
        seed: of the random numbers; the same seed gives the same draws.

    Returns:
        Values by the names of ``parameters()``, in their units; without a row in the covariance they are as identified.

    Raises:
        BadInput: there is no covariance or it is none, or hardly a draw lies within the bounds of the parameters.
    """
    names, root = _root(oscillator)
    values = oscillator.values()
    centre = np.array([values[name] for name in names])
    low, high = np.array([limits(oscillator, name) for name in names]).reshape(-1, 2).T
    random = np.random.default_rng(seed)
    kept: list[dict[str, float]] = []
    outside = np.zeros(len(names), int)
    tried = 0
    while len(kept) < count:
        if tried >= _TRIES * count:
            worst = names[int(np.argmax(outside))]
            raise BadInput(
                f"{oscillator.name}: of {tried} draws from the covariance only {len(kept)} lie within the bounds of "
                f"the parameters, most of the others not because of {worst} = {values[worst]:.4g}, whose error is "
                "large; record where it matters and identify again, or ask for --draws 0"
            )
        tried += 1
        # to twelve digits: the last ones of the linear algebra differ between machines
        draw = [float(f"{value:.12g}") for value in centre + root @ random.standard_normal(len(names))]
        wrong = ~((low <= draw) & (draw <= high))
        outside += wrong
        if not np.any(wrong):
            kept.append(values | dict(zip(names, draw, strict=True)))
    return kept


def limits(oscillator: Oscillator, name: str) -> tuple[float, float]:
    """Between which values the parameter ``name`` makes sense, in its unit: the bounds of its law, and its sign."""
    effect, _, own = name.rpartition(".")
    for term in oscillator.terms:
        if term.effect == effect:
            return next((p.lower, p.upper) for p in term.law.parameters if p.name == own)
    if name in ("mass", "omega0"):
        return math.nextafter(0.0, 1.0), math.inf
    wanted = name in _POSITIVE or oscillator.bounds()[name][0] >= 0
    positive = wanted and oscillator.values()[name] >= 0
    return (0.0 if positive else -math.inf), math.inf


def _root(oscillator: Oscillator) -> tuple[tuple[str, ...], np.ndarray]:
    """Names of the rows of the covariance, and its symmetric root (n, n): unlike a triangular one it needs no rank,
    and unlike eigenvectors it has no sign of its own."""
    provenance = oscillator.identified
    if provenance.covariance is None:
        raise BadInput(
            f"{oscillator.name}: the model holds no covariance to draw parameters from; "
            "take one that dashpot identify wrote, or ask for --draws 0"
        )
    names = provenance.parameters or tuple(oscillator.parameters())
    unknown = [name for name in names if name not in oscillator.parameters()]
    problem = covariance_problem([list(row) for row in provenance.covariance], list(names))
    if unknown or problem:
        said = f"{unknown[0]!r} is no parameter" if unknown else problem
        raise BadInput(f"{oscillator.name}: identified.covariance: {said}; identify the model again")
    matrix = np.array(provenance.covariance, float)
    std = np.sqrt(np.diag(matrix))
    unit = np.where(std > 0, std, 1.0)
    size, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T) / unit[:, None] / unit)
    root = (vectors * np.sqrt(np.clip(size, 0.0, None))) @ vectors.T
    return names, std[:, None] * root
