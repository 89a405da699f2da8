"""Poles of many short windows of a recording at once, each from the signal subspace of its Hankel matrix.

A sum of damped modes and a constant obeys one linear recurrence, so that the Hankel matrix of its samples has twice as
many singular values above the noise as there are modes, and one more for the constant. The subspace that belongs to
them, moved by one sample, gives the poles (Kung 1978; ESPRIT: Roy and Kailath 1989).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..signals.odds import ABOVE_NOISE
from ..signals.registry import budget, numerics

MOST_MODES = budget(3, "modes", why="of which a window is asked")
_LEAST, _MOST = numerics(
    (-0.02, 0.97), "damping ratios", why="what grows or is over at once is no oscillation of a window"
)


def poles_of_windows(
    windows: np.ndarray, noise: float, shares: Sequence[float]
) -> list[list[tuple[np.ndarray, np.ndarray]]]:
    """The modes of each window (B, n) that shows one to three and nothing else beside a constant.

    Args:
        windows: samples, any unit.
        noise: standard deviation of their white noise.
        shares: parts of the largest singular value below which one is no mode's.

    Returns:
        For each of the shares undamped natural frequencies in radians a sample and damping ratios, (K,) each, in order
        of frequency.
    """
    n = windows.shape[1]
    rows = n // 2
    hankel = np.lib.stride_tricks.sliding_window_view(windows, n - rows + 1, axis=1)
    left, sizes, _ = np.linalg.svd(hankel, full_matrices=False)
    # the largest singular value of noise alone (Davidson and Szarek 2001, theorem II.13)
    floor = ABOVE_NOISE * noise * (np.sqrt(rows) + np.sqrt(n - rows + 1))
    ranks = [np.sum(sizes > (floor + share * sizes[:, 0])[:, None], axis=1).tolist() for share in shares]
    highest = min(2 * MOST_MODES + 1, rows - 2)
    return [
        [
            shown
            for basis, rank in zip(left, each, strict=True)
            if 2 <= rank <= highest and (shown := _shown_by(basis[:, :rank])) is not None
        ]
        for each in ranks
    ]


def _shown_by(space: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The modes of a signal subspace (rows, rank); None where it has others than they and a constant."""
    poles = np.linalg.eigvals(np.linalg.lstsq(space[:-1], space[1:])[0])
    logs = np.log(poles[np.abs(poles) > 0].astype(complex))
    pairs = logs[np.imag(logs) > 0]
    if space.shape[1] - 2 * pairs.size > 1 or not pairs.size:
        return None
    omega = np.abs(pairs)
    zeta = -np.real(pairs) / omega
    order = np.argsort(omega)
    if not np.all((zeta > _LEAST) & (zeta < _MOST) & (omega < np.pi)):
        return None
    return omega[order], np.abs(zeta[order])
