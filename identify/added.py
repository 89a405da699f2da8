"""A rig to which a known mass or stiffness was added: what that changes tells its moving mass, without a force.

A free decay says everything per unit mass. With a mass on it, and a stiffness beside its spring, that are known,

    omega0'² = (m omega0² + k_added) / (m + m_added),

and every other strength per unit mass is (m + m_added) / m times smaller: the mass is all that is unknown (the method
of added masses of modal analysis, Parloo, Verboven, Guillaume, Van Overmeire 2002).

The recordings that have the same added to them are identified by themselves. The rig is that from which all of them
follow, within their errors: least squares weighted with their covariances, which is the likelihood of all recordings
together as far as each is a parabola. What is left says whether what was added changed anything else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..model import Oscillator
from ..model.parameter import Parameter
from ..model.units import compose
from .faults.fault import with_error
from .identification import Identification
from .signals.odds import BY_CHANCE, SIGNIFICANT

_MASS, _OMEGA = "mass", "omega0"


@dataclass(frozen=True)
class Added:
    """What was added to a rig while it was recorded: a mass, and a stiffness beside its spring, in SI."""

    mass: float = 0.0
    stiffness: float = 0.0

    def __bool__(self) -> bool:
        return bool(self.mass or self.stiffness)

    def words(self, units: tuple[str, str]) -> str:
        """Both, as far as they are there, in the units of the model."""
        said = [f"{value:g} {unit}" for value, unit in zip((self.mass, self.stiffness), units, strict=True) if value]
        return " and ".join(said)


@dataclass(frozen=True, eq=False)
class _Told:
    """What one identification says of the parameters, by name, with their covariance, and what was added."""

    added: Added
    names: tuple[str, ...]
    values: np.ndarray
    factor: np.ndarray  # Cholesky, lower, of the covariance


def absent(found: Identification) -> dict[str, float]:
    """Members of Eq. 17 that an identification left out, as they are to be kept where something was added."""
    model = found.oscillator
    return {n: 0.0 for n in ("cubic", "preload", "dry") if n not in found.fit.names and not model.values()[n]}


def with_what_was_added(as_it_is: Identification, others: Sequence[tuple[Added, Identification]]) -> Identification:
    """The identification of the rig as it is, with the mass that the others tell, and what they tell of all else.

    Args:
        as_it_is: with nothing added.
        others: of the same laws, members left out being kept so (``absent``), with something added each.

    Raises:
        BadInput: what was added does not move the natural frequency by more than its error, or the wrong way.
    """
    model = as_it_is.oscillator
    mass = model.mass.value if model.mass is not None else _first_mass(as_it_is, others)
    known = {_MASS: mass} | {name: p.value for name, p in model.parameters().items() if name != _MASS}
    told = [_told(Added(), as_it_is), *(_told(added, found) for added, found in others)]
    names = tuple(n for n in known if n == _MASS or any(n in one.names for one in told))
    theta, covariance, left, freedom = _fitted(model, known, names, told)
    wide = 1.0
    if freedom > 0:
        from scipy.special import chdtri

        wide = max(1.0, left / freedom) if left > float(chdtri(freedom, BY_CHANCE)) else 1.0
    return _combined(as_it_is, others, dict(zip(names, theta, strict=True)), covariance * wide, wide)


def _told(added: Added, found: Identification) -> _Told:
    provenance = found.oscillator.identified
    names, matrix = provenance.parameters, np.array(provenance.covariance or [[]], float)
    values = found.oscillator.values()
    known = [i for i, name in enumerate(names) if name in values and np.isfinite(matrix[i, i]) and matrix[i, i] > 0.0]
    if _OMEGA not in (names[i] for i in known):
        raise BadInput(f"{found.recordings[0].name}: its natural frequency is not known; record more of it")
    part = matrix[np.ix_(known, known)]
    std = np.sqrt(np.diag(part))
    alike = part / np.outer(std, std)
    sizes, axes = np.linalg.eigh(alike)
    alike = (axes * np.maximum(sizes, np.sqrt(np.finfo(float).eps))) @ axes.T  # rounding makes others of what is one
    factor = std[:, None] * np.linalg.cholesky(alike)
    return _Told(added, tuple(names[i] for i in known), np.array([values[names[i]] for i in known]), factor)


def _first_mass(as_it_is: Identification, others: Sequence[tuple[Added, Identification]]) -> float:
    """The mass by the natural frequencies alone, of the recordings that tell it best."""
    own = as_it_is.oscillator.omega0
    best: tuple[float, float] | None = None
    for added, found in others:
        other = found.oscillator.omega0
        apart = own.value**2 - other.value**2
        error = 2.0 * float(np.hypot(own.value * (own.std or 0.0), other.value * (other.std or 0.0)))
        name = found.recordings[0].name
        if not abs(apart) > SIGNIFICANT * error:
            raise BadInput(
                f"{name}: what was added moves the natural frequency by no more than its error, from "
                f"{own.value / (2 * np.pi):.6g} to {other.value / (2 * np.pi):.6g} Hz; add more"
            )
        mass = (added.mass * other.value**2 - added.stiffness) / apart
        if not mass > 0.0:
            raise BadInput(
                f"{name}: what was added moves the natural frequency the wrong way, from "
                f"{own.value / (2 * np.pi):.6g} to {other.value / (2 * np.pi):.6g} Hz; check which recording has it"
            )
        if best is None or error / abs(apart) < best[0]:
            best = error / abs(apart), mass
    assert best is not None
    return best[1]


def _foreseen(model: Oscillator, values: Mapping[str, float], added: Added) -> dict[str, float]:
    """Parameters of the rig with what was added."""
    mass = values[_MASS]
    share = mass / (mass + added.mass)
    strengths = {f"{term.effect}.{p.name}" for term in model.terms for p in term.law.parameters if p.strength}
    strengths |= {"cubic", "preload", "viscous", "dry"}
    made = {name: value * share if name in strengths else value for name, value in values.items()}
    squared = (mass * values[_OMEGA] ** 2 + added.stiffness) / (mass + added.mass)
    return made | {_MASS: mass + added.mass, _OMEGA: float(np.sqrt(max(squared, 0.0)))}


def _fitted(
    model: Oscillator, known: Mapping[str, float], names: Sequence[str], told: Sequence[_Told]
) -> tuple[np.ndarray, np.ndarray, float, int]:
    """Values of the names with their covariance, the sum of squares that is left over its errors, and its freedom."""
    from scipy.optimize import least_squares

    spread = {n: float(np.linalg.norm(one.factor[i])) for one in told for i, n in enumerate(one.names)}
    start = np.array([known[name] for name in names])
    scale = np.array([spread.get(name, abs(known[name])) for name in names])

    def left(moved: np.ndarray) -> np.ndarray:
        values = {**known, **dict(zip(names, start + scale * moved, strict=True))}
        parts = []
        for one in told:
            foreseen = _foreseen(model, values, one.added)
            off = one.values - np.array([foreseen[name] for name in one.names])
            parts.append(np.linalg.solve(one.factor, off))
        return np.concatenate(parts)

    found = least_squares(left, np.zeros(len(names)), method="lm", x_scale="jac")
    size = np.linalg.norm(found.jac, axis=0)
    inverse = np.linalg.pinv((found.jac / size).T @ (found.jac / size), hermitian=True) / np.outer(size, size)
    freedom = sum(len(one.names) for one in told) - len(names)
    return start + scale * found.x, inverse * np.outer(scale, scale), 2.0 * float(found.cost), freedom


def _combined(
    as_it_is: Identification,
    others: Sequence[tuple[Added, Identification]],
    values: Mapping[str, float],
    covariance: np.ndarray,
    wide: float,
) -> Identification:
    model, names = as_it_is.oscillator, tuple(values)
    unit, length = model.force_unit, model.response.displacement_unit
    units = compose("Q.s2/X", length, unit), compose("Q/X", length, unit)
    std = dict(zip(names, np.sqrt(np.diag(covariance)), strict=True))
    if model.mass is None:
        model = replace(model, mass=Parameter(values[_MASS], None, units[0]))
    model = model.with_parameters(
        {n: Parameter(float(values[n]), float(std[n]), model.parameters()[n].unit) for n in names}
    )
    files: list[Mapping[str, Any]] = list(model.identified.recordings)
    files += [r for added, found in others for r in _noted(found, added, units)]
    provenance = replace(
        model.identified,
        recordings=tuple(files),
        parameters=names,
        covariance=tuple(tuple(map(float, row)) for row in covariance),
    )
    sets = [f"{added.words(units)} in {', '.join(r.name for r in found.recordings)}" for added, found in others]
    note = f"what was added ({'; '.join(sets)}) tells the mass: {with_error(values[_MASS], std[_MASS])} {units[0]}"
    if wide > 1.0:
        note += (
            f"; the sets of recordings differ by {np.sqrt(wide):.2g} times their errors in what it does not change, "
            "so that the errors are as much wider: mounting it may have changed the rig"
        )
    notes = [n for _, found in others for n in found.notes]
    return replace(
        as_it_is,
        oscillator=replace(model, identified=provenance),
        notes=tuple(dict.fromkeys((note, *as_it_is.notes, *notes))),
    )


def _noted(found: Identification, added: Added, units: tuple[str, str]) -> list[Mapping[str, Any]]:
    return [{**r, "added": added.words(units)} for r in found.oscillator.identified.recordings]
