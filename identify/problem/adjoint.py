"""What a force does to the response, and how a weighted sum of that feels it: the linearised motion, and its adjoint.

With the state's derivatives from sample to sample, z[i] = M[i] z[i-1] + B[i] u[i-1/2], and the response
y[i] = c[i] z[i] + d[i] u[i], the sum over w[i] y[i] feels the force through the costate

    q[i] = c[i] w[i] + M[i+1]' q[i+1],

which runs backward in time (Bryson and Ho 1975): one run of the model and one banded system, for any number of sums or
of forces.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..signals.registry import numerics

_AT_ONCE = numerics(2**14, "samples", why="of the banded system that is solved at once: what a cache holds")


def felt(
    transitions: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], weights: np.ndarray, *, held: bool
) -> Iterator[tuple[slice, np.ndarray]]:
    """Derivatives of weighted sums of a response by what is added to each sample of its force.

    Args:
        transitions: as ``Core.transitions`` gives them, of n samples and s states.
        weights: (k, n) of the sums.
        held: whether a sample of the force holds until the next; else straight lines join them.

    Yields:
        Samples and (k, m) of these, the last part first: of a long record all together would be its largest array. A
        straight line is taken for its mean over each interval, right to (omega dt)² / 12 of itself.
    """
    from scipy.linalg import solve_banded

    moved, pushed, shown, direct = transitions
    n, s = pushed.shape
    count = weights.shape[0]
    later, after = np.zeros((s, count)), np.zeros((count, 1))
    for begin in reversed(range(0, n, _AT_ONCE)):
        end = min(begin + _AT_ONCE, n)
        part = slice(begin, end)
        right = shown[part, :, None] * weights[:, part].T[:, None, :].astype(float)
        if end < n:
            right[-1] += moved[end].T @ later
        bands = np.zeros((2 * s, (end - begin) * s))
        bands[-1] = 1.0
        for row in range(s):
            for column in range(s):
                bands[s - 1 + row - column, s + column :: s] = -moved[begin + 1 : end, column, row]
        costate = solve_banded((0, 2 * s - 1), bands, right.reshape(-1, count), overwrite_b=True, check_finite=False)
        costate = costate.reshape(-1, s, count)
        later = costate[0]
        # by the force of the interval that ends at a sample, and of that which begins there
        ending = np.einsum("ns,nsk->kn", pushed[part], costate)
        of_interval = np.concatenate([ending[:, 1:], after], axis=1)
        after = ending[:, :1]
        if not held:
            of_interval += ending
            of_interval *= 0.5
        yield part, of_interval + direct[part] * weights[:, part]


def pushed(
    transitions: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], between: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """How a response changes when small forces are added to the recorded one.

    Args:
        transitions: as ``Core.transitions`` gives them, of n samples and s states.
        between: (k, n - 1) mean of each force over each interval.
        at: (k, n) each force at each sample.

    Returns:
        (k, n).
    """
    from scipy.linalg import get_lapack_funcs

    moved, by_force, shown, direct = transitions
    n, s = by_force.shape
    bands = np.zeros((2 * s, n * s))
    for row in range(s):
        for column in range(s):
            bands[s + row - column, column : (n - 1) * s : s] = -moved[1:, row, column]
    right = np.zeros((n, s, len(at)))
    right[1:] = by_force[1:, :, None] * between.T[:, None, :]
    (solved,) = get_lapack_funcs(("tbtrs",), (bands, right))
    states, _ = solved(bands, right.reshape(n * s, -1), uplo="L", diag="U")
    return np.einsum("ns,nsk->kn", shown, states.reshape(n, s, -1)) + direct * at
