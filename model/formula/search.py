"""Closed forms within the band of a learnt curve, the shortest description first.

A form is a straight line through zero (a constant for a damping over the place) and one or two of ``ATOMS``. Its
constants are those that come nearest to the curve by the curve's own covariance; what the spline cannot show of a form
counts for nothing. A description is as long as what the form leaves, each constant as finely as the curve tells it, and
the choice among all forms of so many pieces (minimum description length: Rissanen 1978).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from .atoms import ATOMS, Atom
from .curve import LearntCurve

_RANK = 1e-9  # of the largest variance: smaller ones are rounding
_SIZES = np.geomspace(0.05, 3.0, 60)  # of the range: where the constant within a piece is first looked for
_ZOOMS, _FINER = 3, 9  # how often the best place of a grid is looked at more closely, with how many sizes
_REFINED = 12  # pairs whose constants are sought beyond that
_ALIKE = 1e-5  # of their sizes: what two columns have apart that are one
_WITHIN = 0.95  # of what chance leaves


def contradicts(left: float, freedom: int) -> bool:
    """Whether a squared distance in the curve's covariance is more than chance leaves."""
    from scipy.special import chdtri

    return left > float(chdtri(max(freedom, 1), 1.0 - _WITHIN))


@dataclass(frozen=True, eq=False)
class Formula:
    """One closed form of a curve.

    Attributes:
        pieces: names of ``ATOMS``.
        factors: (1 + pieces,) before the straight line (or the constant) and before each piece.
        inside: (pieces,) the constant within each, 0 where there is none.
        left: squared distance from the curve in its own covariance, of ``freedom`` degrees of freedom.
        length: of the description, in natural units of information.
        errors: (1 + pieces,) standard errors of the factors, the constants within free.
        inside_errors: (pieces,) of those, 0 where there is none.
    """

    pieces: tuple[str, ...]
    factors: np.ndarray
    inside: np.ndarray
    left: float
    freedom: int
    length: float
    errors: np.ndarray
    inside_errors: np.ndarray

    @property
    def within(self) -> bool:
        """Whether the curve does not contradict it."""
        return not contradicts(self.left, self.freedom)


@dataclass(frozen=True, eq=False)
class _Target:
    """The curve in coordinates in which its errors are one each."""

    at: np.ndarray
    whitener: np.ndarray
    value: np.ndarray
    line: np.ndarray
    choices: float

    def columns(self, pieces: Sequence[Atom], inside: np.ndarray) -> np.ndarray:
        made = [self.line, *(atom.values(self.at, a) for atom, a in zip(pieces, inside, strict=True))]
        return self.whitener @ np.column_stack(made)

    def left(self, pieces: Sequence[Atom], inside: np.ndarray) -> float:
        columns = self.columns(pieces, inside)
        if not np.all(np.isfinite(columns)):
            return np.inf
        size = np.linalg.norm(columns, axis=0)
        solved = np.linalg.lstsq(columns / np.where(size > 0, size, 1.0), self.value, rcond=1e-8)[0]
        rest = self.value - columns / np.where(size > 0, size, 1.0) @ solved
        return float(rest @ rest)


def formulas(curve: LearntCurve) -> list[Formula]:
    """All forms that were tried to the end, the shortest description first."""
    target = _target(curve)
    grids = [_Grid.of(target, atom) for atom in ATOMS.values()]
    begun: list[tuple[float, tuple[Atom, ...], np.ndarray]] = [(0.0, (), np.zeros(0))]
    for grid in grids:
        gain = grid.along**2 / grid.power
        best = int(np.argmax(gain))
        begun.append((-float(gain[best]), (grid.atom,), grid.sizes[[best]]))
    pairs = [_together(target, first, second) for first, second in combinations(grids, 2)]
    whole = float(target.value @ target.value)

    def length(pair: tuple[float, tuple[Atom, ...], np.ndarray]) -> float:
        """Of the description but for what the factors cost: a constant within is told as finely as the curve."""
        return 0.5 * pair[0] + 0.5 * math.log(whole) * sum(atom.within for atom in pair[1])

    begun += sorted(pairs, key=length)[:_REFINED]
    found = [_finished(target, pieces, _nearest(target, pieces, start)) for _, pieces, start in begun]
    return sorted(found, key=lambda one: one.length)


@dataclass(frozen=True, eq=False)
class _Grid:
    """One piece at several sizes: what of it no straight line has, in coordinates in which errors are one.

    Attributes:
        columns: (rank, sizes).
        power: (sizes,) their squares.
        along: (sizes,) their products with the curve.
    """

    atom: Atom
    sizes: np.ndarray
    columns: np.ndarray
    power: np.ndarray
    along: np.ndarray

    @classmethod
    def of(cls, target: _Target, atom: Atom, sizes: np.ndarray | None = None) -> _Grid:
        """At all sizes, or at some."""
        if sizes is None:
            sizes = float(np.max(np.abs(target.at))) * _SIZES if atom.within else np.zeros(1)
        columns = target.whitener @ np.column_stack([atom.values(target.at, size) for size in sizes])
        line = target.whitener @ target.line
        line = line / np.linalg.norm(line)
        before = np.sum(columns**2, axis=0)
        columns = columns - np.outer(line, line @ columns)
        power = np.sum(columns**2, axis=0)
        straight = power <= _ALIKE**2 * before  # a straight line itself, within the range
        columns, power = np.where(straight, 0.0, columns), np.where(straight, 1.0, power)
        return cls(atom, sizes, columns, power, columns.T @ target.value)

    def around(self, target: _Target, place: int) -> _Grid:
        """The same piece at sizes between the neighbours of one."""
        if not self.atom.within:
            return self
        low, high = self.sizes[max(place - 1, 0)], self.sizes[min(place + 1, self.sizes.size - 1)]
        return _Grid.of(target, self.atom, np.geomspace(low, high, _FINER))


def _together(target: _Target, first: _Grid, second: _Grid) -> tuple[float, tuple[Atom, ...], np.ndarray]:
    """What two pieces take away together at their best sizes, less than zero, with both."""
    gain, i, j = _best(first, second)
    for _ in range(_ZOOMS):
        first, second = first.around(target, i), second.around(target, j)
        gain, i, j = _best(first, second)
    return -gain, (first.atom, second.atom), np.array([first.sizes[i], second.sizes[j]])


def _best(first: _Grid, second: _Grid) -> tuple[float, int, int]:
    """What two pieces take away where they take away most, and where that is."""
    shared = first.columns.T @ second.columns
    both = np.outer(first.power, second.power)
    apart = both - shared**2
    gain = np.outer(first.along**2, second.power) + np.outer(first.power, second.along**2)
    gain = gain - 2 * np.outer(first.along, second.along) * shared
    gain = np.where(apart > _ALIKE * both, gain / np.where(apart > 0, apart, 1.0), 0.0)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    return float(gain[i, j]), int(i), int(j)


def whitener_of(covariance: np.ndarray) -> np.ndarray:
    """(rank, n) what makes errors one each of points with a covariance (n, n)."""
    values, vectors = np.linalg.eigh(covariance)
    kept = values > _RANK * values[-1]
    return (vectors[:, kept] / np.sqrt(values[kept])).T


def _target(curve: LearntCurve) -> _Target:
    whitener = whitener_of(curve.covariance)
    line = np.ones(curve.at.size) if curve.times else curve.at
    pieces = len(ATOMS)
    return _Target(curve.at, whitener, whitener @ curve.value, line, math.log(pieces))


def _nearest(target: _Target, pieces: Sequence[Atom], start: np.ndarray) -> np.ndarray:
    """(pieces,) constants within that come nearest, from those of the grid."""
    from scipy.optimize import minimize

    free = [i for i, atom in enumerate(pieces) if atom.within]
    if not free:
        return start
    whole = np.array(start, float)
    reach = float(np.max(np.abs(target.at)))
    low, high = math.log(_SIZES[0] * reach / 3), math.log(_SIZES[-1] * reach * 3)

    def left(logs: np.ndarray) -> float:
        whole[free] = np.exp(np.clip(logs, low, high))
        return target.left(pieces, whole)

    most = {"xatol": 1e-5, "fatol": 1e-6, "maxfev": 150 * len(free)}
    solved = minimize(left, np.log(whole[free]), method="Nelder-Mead", options=most)
    whole[free] = np.exp(np.clip(solved.x, low, high))
    return whole


def _finished(target: _Target, pieces: Sequence[Atom], inside: np.ndarray) -> Formula:
    columns = target.columns(pieces, inside)
    factors, *_ = np.linalg.lstsq(columns, target.value, rcond=1e-12)
    rest = target.value - columns @ factors
    slopes = [columns]
    for i, atom in enumerate(pieces):
        if atom.within:
            step = 1e-4 * inside[i]
            more, less = (target.columns([atom], inside[[i]] + sign * step)[:, 1] for sign in (1, -1))
            slopes.append((factors[1 + i] * (more - less) / (2 * step))[:, None])
    whole = np.column_stack(slopes)
    constants = np.array([*factors, *(a for a, atom in zip(inside, pieces, strict=True) if atom.within)])
    size = np.where((norm := np.linalg.norm(whole, axis=0)) > 0, norm, 1.0)
    covariance = np.linalg.pinv((whole / size).T @ (whole / size)) / np.outer(size, size)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    left = float(rest @ rest)
    # what the curve tells of all constants together, as parts of themselves: they may stand for one another
    told = np.linalg.eigvalsh((whole * constants).T @ (whole * constants))
    length = 0.5 * left + 0.5 * float(np.sum(np.log(math.e + np.maximum(told, 0.0)))) + len(pieces) * target.choices
    freedom = target.value.size - constants.size
    beside = np.zeros(len(pieces))
    beside[[i for i, atom in enumerate(pieces) if atom.within]] = errors[factors.size :]
    names = tuple(atom.name for atom in pieces)
    return Formula(names, factors, np.array(inside), left, freedom, length, errors[: factors.size], beside)
