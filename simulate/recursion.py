"""The states of a linear system sample by sample, all at once: a recursion added up by blocks (Ladner, Fischer 1980).

``scipy.signal`` filters as well, and takes a quarter of a second of processor to import: as long as a short decay takes
to be identified.
"""

from __future__ import annotations

import numpy as np

#: Samples of a block: what is carried from block to block costs a sixteenth of the rest.
_BLOCK = 16


def recursion(matrix: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """(n, states) z of z[k] = matrix z[k-1] + inputs[k], from rest before the first sample.

    Args:
        matrix: (states, states), real or complex.
        inputs: (n, states).
    """
    n, states = inputs.shape
    if states == 1:
        return _of_one_state(matrix[0, 0], inputs[:, 0])[:, None]
    blocks = -(-n // _BLOCK)
    made = np.zeros((blocks, _BLOCK, states), np.result_type(matrix, inputs))
    made.reshape(-1, states)[:n] = inputs
    power, by = matrix, 1
    while by < _BLOCK:
        made[:, by:] += made[:, :-by] @ power.T
        power, by = power @ power, 2 * by
    if blocks > 1:
        ends = recursion(power, made[:, -1])[:-1]
        for place in range(_BLOCK):
            ends = ends @ matrix.T
            made[1:, place] += ends
    return made.reshape(-1, states)[:n]


def _of_one_state(pole: complex, inputs: np.ndarray) -> np.ndarray:
    """(n,) of one state: a triangular system of two diagonals, which the linear algebra solves sample by sample."""
    from scipy.linalg import get_blas_funcs

    if not inputs.size:
        return np.zeros(0, np.result_type(pole, inputs))
    diagonals = np.empty((2, inputs.size), np.result_type(pole, inputs), order="F")
    diagonals[0], diagonals[1] = 1.0, -pole
    (solve,) = get_blas_funcs(("tbsv",), (diagonals,))
    return np.asarray(solve(1, diagonals, inputs.astype(diagonals.dtype), lower=1, diag=1))


def powers(poles: np.ndarray, n: int) -> np.ndarray:
    """(n, K) states of a system that is let go at one: e to the power of each pole (K,) times 0 to n - 1.

    Each doubling multiplies what is there: a tenth of the time that as many exponential functions take.
    """
    made = np.empty((n, poles.size), complex)
    made[:1], done = 1.0, 1
    while done < n:
        more = min(done, n - done)
        np.multiply(made[:more], np.exp(done * poles), out=made[done : done + more])
        done += more
    return made


def driven_by_lines(system: tuple[np.ndarray, ...], force: np.ndarray, dt: float) -> np.ndarray:
    """(n,) output of a linear system (A, B, C, D) whose input is straight between its samples (n,), dt apart: exact.

    The input comes up from zero within the step before the first sample.
    """
    from scipy.linalg import expm

    a, b, c, d = system
    states = len(a)
    turned = np.zeros((states + 2, states + 2))
    turned[:states, :states], turned[:states, states], turned[states, states + 1] = a * dt, b[:, 0] * dt, 1.0
    moved = expm(turned)[:states]
    before = np.append(0.0, force[:-1])
    inputs = np.multiply.outer(before, moved[:, states]) + np.multiply.outer(force - before, moved[:, states + 1])
    return recursion(moved[:, :states], inputs) @ c[0] + d[0, 0] * force
