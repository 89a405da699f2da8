"""Shares of the missing force by kind of coordinate, with errors by leaving blocks of the recordings out.

Share and error are those of a jackknife over blocks (Quenouille 1956 on what it takes off, which here is what so many
free columns explain by chance; Künsch 1989, Annals of Statistics 17, section 2; of groups of unequal size: Busing,
Meijer and van der Leeden 1999, Statistics and Computing 9). The smoother hides a part of every force, the most of its
high harmonics: each column is what it would show of that column. All regressions are solved from the products of
these, block by block, so that leaving a block out costs a subtraction and no pass over the samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...identify.signals.odds import ABOVE_NOISE
from ...identify.signals.registry import budget, numerics
from ..depends_on import DependsOn, Share
from .free_form import KINDS, Rows, family, hats, nodes_of
from .mismatch_ranges import ORDERS
from .what_it_follows import LINES, Symptoms, line_columns, plainest

_GROUPS = budget(40, "groups of blocks", why="an error from forty is good to an eighth")
_RIDGE = numerics(1e-10, "of a column's power", why="columns that say the same twice: a sum of hats is a constant")
_LEAST = numerics(1e-9, "of all power", why="a group with less of it has no share of its own")
_PIECES = numerics(10, "pieces over the range of the amplitude", why="as the pieces of a force")


def _amplitude(rows: Rows) -> np.ndarray:
    """Stiffness and damping that depend on the amplitude of the cycle."""
    size = rows.joined(lambda s: s.amplitude)
    known = np.isfinite(size)
    if not np.any(known):
        return np.zeros((size.size, 0))
    pieces = hats(np.where(known, size, 0.0), nodes_of(size[known], _PIECES)) * known[:, None]
    x, v = rows.joined(lambda s: s.x), rows.joined(lambda s: s.v)
    return np.hstack([pieces * x[:, None], pieces * v[:, None]])


def _phase(rows: Rows) -> np.ndarray:
    """A force that repeats in every cycle, whatever the amplitude."""
    turn = rows.joined(lambda s: s.phase)
    known = np.isfinite(turn)
    turns = np.arange(1, ORDERS) * np.where(known, turn, 0.0)[:, None]
    return np.column_stack([np.cos(turns), np.sin(turns)]) * known[:, None]


#: Kinds that are only said: what a diagnosis does next does not depend on them. The acceleration is none of them: it is
#: what the missing force makes, and explains all of it whatever the cause.
SAID: dict[str, Callable[[Rows], np.ndarray]] = {
    "amplitude": _amplitude,
    "phase": _phase,
}


@dataclass(frozen=True, eq=False)
class _Products:
    """Products of all columns and of the force with one another, in each group of blocks.

    Attributes:
        places: columns of each kind, and of the ``family``.
        normal: (groups, k, k) columns with columns.
        along: (groups, k) columns with the missing force, ``silent`` with its noise.
        power: (groups, 2) of the force and of its noise.
        size: (groups,) power that the family leaves.
    """

    places: dict[str, np.ndarray]
    normal: np.ndarray
    along: np.ndarray
    silent: np.ndarray
    power: np.ndarray
    size: np.ndarray

    @classmethod
    def of(cls, rows: Rows, kinds: dict[str, np.ndarray]) -> _Products:
        """From unweighted columns (n, m) of each kind."""
        group = groups_of(rows)
        groups = int(group[-1]) + 1
        places, first = {"family": np.arange(rows.base.shape[1])}, rows.base.shape[1]
        for name, columns in kinds.items():
            places[name] = np.arange(first, first + columns.shape[1])
            first += columns.shape[1]
        whole = np.hstack([rows.joined(family), *kinds.values()])
        ends = np.cumsum([s.n for s in rows.stretches])[:-1]
        each = zip(np.split(whole, ends), rows.stretches, strict=True)
        whole = np.concatenate([part if s.seen is None else s.seen(part) for part, s in each])  # as the force was seen
        whole *= rows.weight[:, None]
        whole /= np.maximum(np.linalg.norm(whole, axis=0), 1e-300)
        edges = np.searchsorted(group, np.arange(groups + 1))  # blocks are in order
        parts = [slice(low, high) for low, high in pairwise(edges)]
        return cls(
            places,
            np.array([whole[part].T @ whole[part] for part in parts]),
            np.array([whole[part].T @ rows.target[part] for part in parts]),
            np.array([whole[part].T @ rows.noise[part] for part in parts]),
            np.array([[rows.target[p] @ rows.target[p], rows.noise[p] @ rows.noise[p]] for p in parts]),
            np.array([rows.left[part] @ rows.left[part] for part in parts]),
        )

    def without(self) -> _Products:
        """First all groups together, then all but each one."""

        def left(values: np.ndarray) -> np.ndarray:
            total = values.sum(axis=0, keepdims=True)
            return np.concatenate([total, total - values])

        made = (left(values) for values in (self.normal, self.along, self.silent, self.power, self.size))
        return _Products(self.places, *made)

    def taken(self, kinds: Sequence[str], along: np.ndarray) -> np.ndarray:
        """(groups,) power that these kinds take from what has the products ``along`` (groups, k) with the columns."""
        which = np.concatenate([self.places[kind] for kind in kinds])
        normal = self.normal[:, which[:, None], which]
        power = np.einsum("gii->gi", normal)
        # a column all of whose power lies in the group left out is rounding in the others
        size = np.sqrt(np.maximum(np.maximum(power, _LEAST * power[:1]), 1e-300))
        normal = normal / (size[:, :, None] * size[:, None, :])
        wanted = along[:, which] / size
        normal[:, np.arange(which.size), np.arange(which.size)] += _RIDGE
        solved = np.linalg.solve(normal, wanted[..., None])[..., 0]
        return np.einsum("gi,gi->g", solved, 2 * wanted - np.einsum("gij,gj->gi", normal, solved))

    def rank(self, kinds: Sequence[str]) -> int:
        """How many columns of these kinds say something of their own."""
        which = np.concatenate([self.places[kind] for kind in kinds])
        normal = self.normal[0][which[:, None], which]
        size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        return int(np.linalg.matrix_rank(normal / np.outer(size, size), tol=which.size * _RIDGE, hermitian=True))


def depends_on(signature: Symptoms, *, base_moves: bool = False) -> DependsOn | None:
    """On what the missing force depends, with errors; None where there are fewer than two blocks.

    Args:
        signature: what the missing force follows.
        base_moves: whether the recorded force is minus the acceleration of a base, which is then named.
    """
    rows = signature.rows
    if int(rows.block.max()) < 1:
        return None
    kinds = {name: make(rows) for name, make in (KINDS | SAID).items()}
    if signature.line is not None:
        kinds["tone" if signature.line.steady else "ringing"] = line_columns(rows, signature.line.frequency_hz)
    kinds = {name: columns for name, columns in kinds.items() if columns.shape[1]}
    products = _Products.of(rows, kinds).without()
    before = products.taken(["family"], products.along)
    silent = products.power[:, 1] - products.taken(["family"], products.silent)
    excess = products.power[:, 0] - before - silent
    if not np.all(excess > 0):
        return None
    # the noise is known to a tenth at most: to two errors, so that one error of its power is a tenth as well
    doubt = (ABOVE_NOISE - 1.0) * float(silent[0] / excess[0])

    def share(*names: str) -> np.ndarray:
        return (products.taken(["family", *names], products.along) - before) / excess

    first = signature.kind if signature.kind in LINES else plainest(signature.shares)
    used, lead = products.rank(["family", first]), share(first)
    shares = []
    for kind in kinds:
        both = (jackknife(part, products.size) for part in (share(kind), share(first, kind) - lead))
        alone, adds = ((min(value, 1.0), math.hypot(error, doubt * value)) for value, error in both)
        within = products.rank(["family", first, kind]) == used
        name = "base" if kind == "force" and base_moves else kind
        shares.append(Share(name, *alone, *(alone if kind == first else (0.0, 0.0) if within else adds), within=within))
    leads = {"force": "base"}.get(first, first) if base_moves else first
    shares.sort(key=lambda one: (one.kind != leads, -one.adds))
    return DependsOn(tuple(shares), products.size.size - 1)


def groups_of(rows: Rows) -> np.ndarray:
    """(n,) number of the group of neighbouring blocks that a sample is of: each has about as much of the power.

    Of groups as long as each other one would hold a resonance or the begin of a decay, and most of the shares.
    """
    power = np.bincount(rows.block, rows.left**2)
    before = np.cumsum(power) - 0.5 * power
    wanted = np.floor(before * min(power.size, _GROUPS) / max(float(np.sum(power)), 1e-300)).astype(int)
    return np.unique(wanted, return_inverse=True)[1][rows.block]


def jackknife(made: np.ndarray, size: np.ndarray) -> tuple[float, float]:
    """An estimate without what its freedom makes of chance, and its standard error.

    Args:
        made: (1 + groups,) the estimate from all groups, and from all but each one.
        size: (1 + groups,) what stands for how much there is: in all groups, and in all but each one.
    """
    whole, without, n, groups = float(made[0]), made[1:], float(size[0]), made.size - 1
    parts = n / np.maximum(n - size[1:], _LEAST * n)  # so many groups of this size there would be
    estimate = groups * whole - float(np.sum((1.0 - 1.0 / parts) * without))
    pseudo = parts * whole - (parts - 1.0) * without
    return estimate, float(np.sqrt(np.mean((pseudo - estimate) ** 2 / (parts - 1.0))))
