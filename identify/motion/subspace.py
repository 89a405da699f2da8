"""Poles of many short windows of a recording at once, each from the signal subspace of its Hankel matrix.

A sum of damped modes and a constant obeys one linear recurrence, so that the Hankel matrix of its samples has twice as
many singular values above the noise as there are modes, and one more for the constant. The subspace that belongs to
them, moved by one sample, gives the poles (Kung 1978; ESPRIT: Roy and Kailath 1989).
"""

from __future__ import annotations

import numpy as np

from ..signals.odds import ABOVE_NOISE
from ..signals.registry import budget, numerics

MOST_MODES = budget(3, "modes", why="of which a window is asked")
_LEAST, _MOST = numerics(
    (-0.02, 0.97), "damping ratios", why="what grows or is over at once is no oscillation of a window"
)


def poles_of_windows(windows: np.ndarray, noise: float, share: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """The modes of each window (B, n) that shows one to three and nothing else beside a constant.

    Args:
        windows: samples, any unit.
        noise: standard deviation of their white noise.
        share: part of the largest singular value below which one is no mode's.

    Returns:
        Undamped natural frequencies in radians a sample and damping ratios, (K,) each, in order of frequency.
    """
    n = windows.shape[1]
    rows = n // 2
    hankel = np.lib.stride_tricks.sliding_window_view(windows, n - rows + 1, axis=1)
    left, sizes, _ = np.linalg.svd(hankel, full_matrices=False)
    # the largest singular value of noise alone (Davidson and Szarek 2001, theorem II.13)
    floor = ABOVE_NOISE * noise * (np.sqrt(rows) + np.sqrt(n - rows + 1)) + share * sizes[:, 0]
    ranks = np.sum(sizes > floor[:, None], axis=1)
    found = []
    for basis, rank in zip(left, ranks.tolist(), strict=True):
        if not 2 <= rank <= min(2 * MOST_MODES + 1, rows - 2):
            continue
        space = basis[:, :rank]
        poles = np.linalg.eigvals(np.linalg.lstsq(space[:-1], space[1:])[0])
        logs = np.log(poles[np.abs(poles) > 0].astype(complex))
        pairs = logs[logs.imag > 0]
        if rank - 2 * pairs.size > 1 or not pairs.size:
            continue
        omega = np.abs(pairs)
        zeta = -pairs.real / omega
        order = np.argsort(omega)
        if np.all((zeta > _LEAST) & (zeta < _MOST) & (omega < np.pi)):
            found.append((omega[order], np.abs(zeta[order])))
    return found
