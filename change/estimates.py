"""Models as estimates of the same parameters: values side by side, each with its joint covariance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..model import units
from ..model.identified import Identified

#: What keeps a covariance of full rank, as a part of each variance.
_RIDGE = 1e-9


@dataclass(frozen=True, eq=False)
class Estimates:
    """n models, k parameters that all of them estimate.

    Attributes:
        names, units: (k) of the parameters.
        scale: (k,) unit in which the numbers below are, the median standard error.
        values: (n, k) over ``scale``.
        covariance: (n, k, k) over ``scale`` twice; positive definite.
        given: parameters that are not compared, each with why, in words.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    scale: np.ndarray
    values: np.ndarray
    covariance: np.ndarray
    given: tuple[str, ...]

    @property
    def n(self) -> int:
        """How many models."""
        return len(self.values)

    @property
    def k(self) -> int:
        """How many parameters."""
        return len(self.names)


def of_first(estimates: Estimates, n: int) -> Estimates:
    """Those of the first ``n`` models."""
    return replace(estimates, values=estimates.values[:n], covariance=estimates.covariance[:n])


def side_by_side(models: Sequence[Identified]) -> Estimates:
    """The parameters that all models estimate.

    Raises:
        BadInput: they are not of one kind or in the same units, or have no errors, or nothing in common.
    """
    first = models[0]
    for model in models[1:]:
        if model.imposed != first.imposed:
            law, rig = (first, model) if first.imposed else (model, first)
            raise BadInput(f"{law.name} is a force law by itself and {rig.name} an oscillator; compare two of one kind")
        for name, parameter in model.parameters().items():
            there = first.parameters().get(name)
            if there is not None and not units.same(there.unit, parameter.unit):
                raise BadInput(
                    f"{model.name} has {name} in {parameter.unit}, {first.name} in {there.unit}; identify both from "
                    "recordings of the same quantity and units"
                )
    stated = [_stated(model) for model in models]
    names = [name for name in first.parameters() if all(name in own for own, _ in stated)]
    given = _not_compared(models, names)
    if not names:
        raise BadInput(
            f"{first.name} and {models[-1].name} estimate no parameter in common, so nothing can be compared; "
            "identify both with the same --with and --fix"
        )
    values = np.array([[model.parameters()[name].value for name in names] for model in models])
    covariance = np.array([_block(own, matrix, names) for own, matrix in stated])
    errors = np.sqrt(np.einsum("ijj->ij", covariance))
    scale = np.median(errors, axis=0)
    covariance = covariance / np.outer(scale, scale)
    ridge = _RIDGE * np.einsum("ijj->ij", covariance)
    covariance = covariance + ridge[:, :, None] * np.eye(len(names))
    unit = tuple(first.parameters()[name].unit for name in names)
    return Estimates(tuple(names), unit, scale, values / scale, covariance, given)


def _stated(model: Identified) -> tuple[list[str], np.ndarray]:
    """Names that a model estimates with an error above zero, and their covariance."""
    provenance, parameters = model.identified, model.parameters()
    if provenance.covariance is not None:
        names = list(provenance.parameters or parameters)
        matrix = np.array(provenance.covariance, float)
    else:
        names = [name for name, parameter in parameters.items() if parameter.std]
        matrix = np.diag([float(parameters[name].std or 0.0) ** 2 for name in names])
    known = [i for i in range(len(names)) if matrix[i, i] > 0 and math.isfinite(matrix[i, i])]
    if not known:
        raise BadInput(
            f"{model.name}: no parameter has a standard error, so it cannot be said what moved; identify it from "
            "recordings"
        )
    return [names[i] for i in known], matrix[np.ix_(known, known)]


def _block(own: list[str], matrix: np.ndarray, names: list[str]) -> np.ndarray:
    rows = [own.index(name) for name in names]
    return matrix[np.ix_(rows, rows)]


def _not_compared(models: Sequence[Identified], names: list[str]) -> tuple[str, ...]:
    """A sentence for each parameter that some model has and that is not compared, but for those of further laws."""
    notes = []
    for name in dict.fromkeys(name for model in models for name in model.parameters() if "." not in name):
        if name in names:
            continue
        values = {model.parameters()[name].value for model in models if name in model.parameters()}
        if len(values) > 1 or any(name not in model.parameters() for model in models):
            notes.append(f"{name} was not estimated in every model and is not compared")
    return tuple(notes)


def laws_of(model: Identified) -> tuple[str, ...]:
    """The effects that a model has beside Eq. 17."""
    return tuple(term.effect for term in model.terms)
