"""Normal equations of least squares in which each segment has unknowns of its own, which are eliminated.

A bordered block-diagonal system. All of it in the scale of each unknown's own information, so that units do not matter.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..signals.registry import numerics

_LOST = numerics(1e-14, "part of the information of the best direction", why="rounding: what has less has none")
#: So little information that its inverse would be beyond what a number can be is none at all.
_LEAST = 1.0 / (_LOST * float(np.finfo(float).max))

_AT_ONCE = numerics(2**14, "samples", why="that are multiplied at once: what a cache holds")

#: Normal matrix and gradient of one segment: shared unknowns first, then its own.
Block = tuple[np.ndarray, np.ndarray]


def products(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """``rows @ others.T``; of rows in single precision in parts and summed in double, as so many are lost in single."""
    if rows.dtype == float:
        return rows @ others.T
    total = np.zeros((rows.shape[0], *others.shape[:-1]))
    for begin in range(0, rows.shape[1], _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        first = rows[:, part].astype(float)
        total += first @ (first if others is rows else others[..., part].astype(float)).T
    return total


def promise(blocks: Sequence[Block], shared: np.ndarray, own: np.ndarray) -> float:
    """What the linearised model expects a step to gain, twice."""
    total = 0.0
    for (normal, gradient), initial in zip(blocks, own, strict=True):
        step = np.concatenate([shared, initial])
        total += float(2.0 * gradient @ step - step @ normal @ step)
    return total


def solve(blocks: Sequence[Block], damping: float, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Step of the shared unknowns (k,) and of each segment's own (s, m), damped in the scale of each unknown."""
    matrix, right = np.zeros((k, k)), np.zeros(k)
    kept = []
    for normal, gradient in blocks:
        own = _damped(normal[k:, k:], damping)
        inverse = pseudo_inverse(own)
        border = normal[:k, k:]
        matrix += normal[:k, :k] - border @ inverse @ border.T
        right += gradient[:k] - border @ inverse @ gradient[k:]
        kept.append((inverse, border, gradient[k:]))
    whole = np.array([np.diag(normal)[:k] for normal, _ in blocks]).sum(axis=0)
    shared = pseudo_inverse(matrix + damping * np.diag(whole)) @ right
    own_steps = np.array([inverse @ (gradient - border.T @ shared) for inverse, border, gradient in kept])
    return shared, own_steps


def held_at(block: Block, fixed: np.ndarray) -> Block:
    """The same of a segment with some of the shared unknowns kept as they are."""
    normal, gradient = block[0].copy(), block[1].copy()
    normal[fixed] = normal[:, fixed] = gradient[fixed] = 0.0
    return normal, gradient


def _damped(normal: np.ndarray, damping: float) -> np.ndarray:
    return normal + damping * np.diag(np.diag(normal))


def pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric information matrix in the scale of its own diagonal; directions without information: 0."""
    if not matrix.size or not np.all(np.isfinite(matrix)):
        return np.zeros_like(matrix)
    size, eigenvalues, vectors, kept = _directions(matrix)
    inverse = np.where(kept, 1.0 / np.where(kept, eigenvalues, 1.0), 0.0)
    return (vectors * inverse) @ vectors.T / np.outer(size, size)


def without_information(matrix: np.ndarray) -> np.ndarray:
    """(k, m) directions among k unknowns that a symmetric information matrix says nothing of, alone or together.

    An unknown without any information of its own is in none of them.
    """
    seen = np.flatnonzero(np.diag(matrix) > _LEAST)
    if not seen.size or not np.all(np.isfinite(matrix)):
        return np.zeros((len(matrix), 0))
    size, _, vectors, kept = _directions(matrix[np.ix_(seen, seen)])
    found = np.zeros((len(matrix), np.count_nonzero(~kept)))
    found[seen] = (vectors / size[:, None])[:, ~kept]
    return found


def _directions(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Scale of each unknown, and in it the information of each direction, the directions, and which have any."""
    diagonal = np.diag(matrix)
    size = np.sqrt(np.where(diagonal > _LEAST, diagonal, 1.0))
    eigenvalues, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    # 1 is the largest where there is any
    return size, eigenvalues, vectors, eigenvalues > _LOST * max(float(eigenvalues[-1]), 1.0)


def shared_information(blocks: Sequence[Block], k: int) -> np.ndarray:
    """(k, k) information on the shared unknowns, each segment's own eliminated."""
    total = np.zeros((k, k))
    for normal, _ in blocks:
        border = normal[:k, k:]
        total += normal[:k, :k] - border @ pseudo_inverse(normal[k:, k:]) @ border.T
    return total


def least_squares(matrix: np.ndarray, vector: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Solution of the normal equations in the columns that are used; zero in the others."""
    solved = np.zeros(vector.size)
    size = np.sqrt(np.diag(matrix)[used])
    normal = matrix[np.ix_(used, used)] / np.outer(size, size)
    solved[used] = np.linalg.lstsq(normal, vector[used] / size, rcond=1e-10)[0] / size
    return solved
