"""A least-squares problem linearised at a point: whitened residuals and columns, and what follows from their sums.

Every question to a fit (a step, standard errors, the gain of one more column, the answer without some samples) is one
elimination in its normal equations [[A, B], [B', C]]: without the unknowns of C they are A - B C^-1 B'. With the
residual's power as a further row, the same elimination gives the power that is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from operator import add

import numpy as np

from ...files.computed_once import computed_once
from ..signals.hilbert import LONG
from ..signals.noise_spectrum import NoiseSpectrum, white
from ..signals.registry import numerics
from .normal_equations import products, pseudo_inverse, solve
from .output_error import OutputError, in_lines
from .search_point import State
from .unknowns import Unknown, Unknowns

_SAME = numerics(1e-8, "of the largest singular value", why="rounding: a direction below it is one of the others")

#: Some of the columns.
Places = slice | Sequence[int] | np.ndarray


@dataclass(frozen=True, eq=False)
class Sums:
    """Inner products of m columns and a residual over some samples.

    Attributes:
        normal: (m, m) of the columns.
        gradient: (m,) of the columns and the residual.
        power: of the residual.
        samples: how many there are.
    """

    normal: np.ndarray
    gradient: np.ndarray
    power: float
    samples: int

    @staticmethod
    def of(columns: np.ndarray, residual: np.ndarray) -> Sums:
        """Those of columns (m, n) and a residual (n,)."""
        power = float(np.vdot(residual, residual))
        return Sums(products(columns, columns), products(columns, residual), power, residual.size)

    @staticmethod
    def none(m: int) -> Sums:
        """Those of no samples."""
        return Sums(np.zeros((m, m)), np.zeros(m), 0.0, 0)

    def __add__(self, other: Sums) -> Sums:
        """Those over the samples of both."""
        samples = self.samples + other.samples
        return Sums(self.normal + other.normal, self.gradient + other.gradient, self.power + other.power, samples)

    def widened(self, m: int) -> Sums:
        """The same with further columns of zeros, m in all."""
        more = m - len(self.gradient)
        return replace(self, normal=np.pad(self.normal, (0, more)), gradient=np.pad(self.gradient, (0, more)))

    def without(self, gone: Places, precision: np.ndarray | float = 0.0) -> Sums:
        """Those of the other columns, when the columns ``gone`` take the values that leave the least power.

        Args:
            gone: indices of columns.
            precision: (gone,) of a Gaussian prior of their values, about those at the point.
        """
        stay, out, inverse = self._split(gone, precision)
        border = self.normal[np.ix_(out, stay)]
        toward = inverse @ np.column_stack([border, self.gradient[out]])
        return Sums(
            self.normal[np.ix_(stay, stay)] - border.T @ toward[:, :-1],
            self.gradient[stay] - border.T @ toward[:, -1],
            self.power - float(self.gradient[out] @ toward[:, -1]),
            self.samples,
        )

    def reduction(self, gone: Places) -> np.ndarray:
        """(others, m) by which a gradient becomes that of the other columns when the columns ``gone`` follow it."""
        stay, out, inverse = self._split(gone)
        made = np.eye(len(self.gradient))[stay]
        made[:, out] = -self.normal[np.ix_(stay, out)] @ inverse
        return made

    def _split(self, gone: Places, precision: np.ndarray | float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Indices of the columns that stay and of those that go, and the inverse of the information on the latter."""
        indices = np.arange(len(self.gradient))
        out = indices[gone]
        corner = self.normal[np.ix_(out, out)] + np.diag(np.broadcast_to(precision, out.size))
        return np.delete(indices, out), out, pseudo_inverse(corner)

    def only(self, indices: np.ndarray) -> Sums:
        """Those of some columns, when the others stay as they are."""
        return replace(self, normal=self.normal[np.ix_(indices, indices)], gradient=self.gradient[indices])

    def step(self) -> np.ndarray:
        """(m,) values of the columns that leave the least power."""
        return pseudo_inverse(self.normal) @ self.gradient

    def gain(self) -> float:
        """Gain of log-likelihood by that step."""
        return 0.5 * float(self.gradient @ self.step())

    def left(self, step: np.ndarray) -> float:
        """The power that is left after a step (m,)."""
        return float(self.power - 2.0 * self.gradient @ step + step @ self.normal @ step)

    def errors(self) -> np.ndarray:
        """(m,) standard errors, where the noise has unit variance."""
        return np.sqrt(np.maximum(np.diag(pseudo_inverse(self.normal)), 0.0))


@dataclass(frozen=True, eq=False)
class Linearised:
    """A problem at a point; its arrays are of one entry a segment.

    Attributes:
        unknowns: what the rows of the columns are.
        columns: (shared + states, n) derivatives, divided by the noise.
        residuals: (n,), divided by the noise.
    """

    unknowns: Unknowns
    columns: tuple[np.ndarray, ...]
    residuals: tuple[np.ndarray, ...]

    @staticmethod
    def of(
        problem: OutputError,
        state: State,
        residuals: Sequence[np.ndarray],
        noise: Sequence[NoiseSpectrum] | None,
        derivatives: Sequence[np.ndarray] | None = None,
        *,
        single: bool = True,
    ) -> Linearised:
        """The problem at ``state``, whitened: lines of the spectrum, which have the inner products of the samples.

        Args:
            problem: what is fitted.
            state: the point.
            residuals: there.
            noise: of each segment; None takes it for white with the level of the residual.
            derivatives: there, where they are known.
            single: whether those of long segments may come in single precision.
        """
        if derivatives is None:
            rows = problem.derivatives(state, residuals, single=single)
        else:
            rows = [own.copy() for own in derivatives]
        spectra = [white(residual) for residual in residuals] if noise is None else noise
        in_lines(problem, rows, spectra)
        lines = [spectrum.lines(residual) for spectrum, residual in zip(spectra, residuals, strict=True)]
        return Linearised(Unknowns.of(problem, state), tuple(rows), tuple(lines))

    @staticmethod
    def in_time(
        problem: OutputError,
        state: State,
        residuals: Sequence[np.ndarray],
        noise: Sequence[NoiseSpectrum],
        derivatives: Sequence[np.ndarray] | None = None,
    ) -> Linearised:
        """The problem at ``state``, whitened and sample by sample: for ``block`` and ``keeping``.

        Derivatives that are known become its columns, in place.
        """
        rows = problem.derivatives(state, residuals) if derivatives is None else derivatives
        for own, spectrum in zip(rows, noise, strict=True):
            for row in own:
                row[:] = spectrum.whiten(row)
        made = [spectrum.whiten(residual) for spectrum, residual in zip(noise, residuals, strict=True)]
        return Linearised(Unknowns.of(problem, state), tuple(rows), tuple(made))

    def leaving(self, residuals: Sequence[np.ndarray]) -> Linearised:
        """The same with other residuals, whitened as these are."""
        other = replace(self, residuals=tuple(residuals))
        other.__dict__["sums"] = tuple(
            Sums(own.normal, products(rows, left), float(np.vdot(left, left)), left.size)
            for own, rows, left in zip(self.sums, self.columns, residuals, strict=True)
        )
        return other

    @property
    def shared_rows(self) -> slice:
        """Rows of the shared unknowns."""
        return slice(len(self.unknowns.shared))

    @property
    def initial_rows(self) -> slice:
        """Rows of initial states."""
        return slice(len(self.unknowns.shared), None)

    @computed_once
    def sums(self) -> tuple[Sums, ...]:
        """Of each segment those over all unknowns."""
        return tuple(Sums.of(rows, left) for rows, left in zip(self.columns, self.residuals, strict=True))

    @computed_once
    def shared(self) -> Sums:
        """Those over the shared unknowns, initial states eliminated, of all segments together."""
        return reduce(add, (own.without(self.initial_rows) for own in self.sums))

    def over(self, kept: Sequence[Unknown]) -> Sums:
        """Those over some of the shared unknowns, in their order among these, all else eliminated."""
        indices = [self.unknowns.index(unknown) for unknown in kept]
        return self.shared.without(np.setdiff1d(np.arange(len(self.unknowns.shared)), indices))

    def information(self, kept: Sequence[Unknown]) -> np.ndarray:
        """(k, k) information on some of the shared unknowns, all else eliminated."""
        return self.over(kept).normal

    def step(self, damping: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Step of the shared unknowns (k,) and of the initial states (segments, states), damped in their scales."""
        return solve([(own.normal, own.gradient) for own in self.sums], damping, len(self.unknowns.shared))

    def beside(self, columns: Mapping[int, np.ndarray]) -> Sums:
        """Those over the shared unknowns and further columns behind them, initial states eliminated.

        Args:
            columns: (c, n) by segment, whitened as the residuals are; zero along the other segments.
        """
        k, m = len(self.unknowns.shared), len(self.columns[0])
        total = Sums.none(k + len(next(iter(columns.values()))))
        for i, own in enumerate(self.sums):
            if i in columns:
                border = products(self.columns[i], columns[i])
                normal = np.block([[own.normal, border], [border.T, products(columns[i], columns[i])]])
                gradient = np.concatenate([own.gradient, products(columns[i], self.residuals[i])])
                total += replace(own, normal=normal, gradient=gradient).without(np.arange(k, m))
            else:
                total += own.without(self.initial_rows).widened(len(total.gradient))
        return total

    def gain(self, columns: Mapping[int, np.ndarray]) -> tuple[float, np.ndarray, np.ndarray]:
        """What further columns would gain of log-likelihood, by which values (c,), and the information (c, c) on these.

        A score test (Rao 1948): the shared unknowns and the initial states are fitted along.
        """
        asked = self.beside(columns).without(self.shared_rows)
        return asked.gain(), asked.step(), asked.normal

    def keeping(self, kept: Sequence[np.ndarray]) -> Linearised:
        """The same of some samples, given by a mask (n,) for each segment; of what was made ``in_time``."""
        columns = tuple(rows[:, mask] for rows, mask in zip(self.columns, kept, strict=True))
        return replace(
            self, columns=columns, residuals=tuple(r[mask] for r, mask in zip(self.residuals, kept, strict=True))
        )

    def block(self, edges: Sequence[Sequence[int] | np.ndarray]) -> list[list[Sums]]:
        """Of each segment those of each block of samples, over all unknowns; of what was made ``in_time``.

        The sums are taken piece by piece, so that they need no more memory than one block. Blocks of one segment are
        added with ``+``; ``Sums.without`` eliminates initial states, before or after.

        Args:
            edges: of each segment the samples at which its blocks begin, and where the last one ends.
        """
        return [
            [Sums.of(rows[:, a:b], left[a:b]) for a, b in pairwise(ends)]
            for rows, left, ends in zip(self.columns, self.residuals, edges, strict=True)
        ]

    def projected(self, i: int, of_shared: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Columns (k, n) less what the initial states imitate, and the diagonal (n,) of the hat matrix, of a segment.

        In the memory of the segment's columns, which are not what they were afterwards, and in parts.

        Args:
            i: index of the segment.
            of_shared: (k, k) covariance of the shared unknowns.
        """
        k, rows, sums = len(of_shared), self.columns[i], self.sums[i]
        of_initial, border = pseudo_inverse(sums.normal[k:, k:]), -sums.reduction(self.initial_rows)[:, k:]
        taken = np.zeros(rows.shape[1])
        for begin in range(0, rows.shape[1], LONG):
            shared, own = rows[:k, begin : begin + LONG], rows[k:, begin : begin + LONG]
            shared -= border @ own
            taken[begin : begin + LONG] = np.sum(shared * (of_shared @ shared), axis=0) + np.sum(
                own * (of_initial @ own), axis=0
            )
        return rows[:k], taken


def orthonormal(rows: np.ndarray) -> np.ndarray:
    """Orthonormal basis (m, n) of the span of (.., n) rows; rows of zeros add nothing."""
    size = np.linalg.norm(rows, axis=1)
    rows = rows[size > 0] / size[size > 0, None]
    if not rows.size:
        return rows
    _, values, basis = np.linalg.svd(rows, full_matrices=False)
    return basis[values > _SAME * values[0]]


def off(basis: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows (.., n) less what lies in an orthonormal basis (m, n): what its columns cannot imitate."""
    return rows - (rows @ basis.T) @ basis if basis.size else rows
