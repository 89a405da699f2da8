"""What share of a free motion's power each of its modes holds, with its error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..signals.registry import numerics
from .damped_modes import Modes

_FELT = numerics(0.1, "standard errors", why="the step of a difference quotient")


def mode_shares(
    pieces: Sequence[np.ndarray], modes: Modes, deviation: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Shares (K,) of the power of all pieces, and their standard errors (K,).

    The amplitudes follow the noise at given frequencies and damping ratios, and what these are off by; least squares
    makes the two independent (Golub and Pereyra 1973).

    Args:
        pieces: (n,) samples of each.
        modes: fitted to them.
        deviation: of the white noise on each.
    """
    if modes.count == 1:
        return np.ones(1), np.zeros(1)
    power, by_noise = _powers(pieces, modes, deviation)
    theta, spread = np.concatenate([np.log(modes.omega), modes.zeta]), np.sqrt(np.diag(modes.covariance))
    slopes = np.zeros((modes.count, theta.size))
    for k in range(theta.size):
        h = _FELT * min(spread[k], 1.0)  # of a logarithm, or of a damping ratio: one is all of it
        moved = [theta + sign * h * (np.arange(theta.size) == k) for sign in (1.0, -1.0)]
        up, down = (
            _powers(pieces, replace(modes, omega=np.exp(at[: modes.count]), zeta=at[modes.count :]), deviation)[0]
            for at in moved
        )
        slopes[:, k] = (up - down) / (2 * h) if h > 0 else 0.0
    covariance = by_noise + slopes @ modes.covariance @ slopes.T
    shares = power / np.sum(power)
    to_shares = (np.eye(modes.count) - shares[:, None]) / np.sum(power)
    return shares, np.sqrt(np.diag(to_shares @ covariance @ to_shares.T))


def _powers(pieces: Sequence[np.ndarray], modes: Modes, deviation: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """(K,) sums of squares of what each mode shows, and their covariance at these frequencies and damping ratios."""
    count = modes.count
    power, covariance = np.zeros(count), np.zeros((count, count))
    for piece, spread in zip(pieces, deviation, strict=True):
        columns = modes.columns(piece.size)
        if not np.all(np.isfinite(columns)):  # what grows so fast is no mode, and has no share
            return np.full(count, np.nan), np.full((count, count), np.nan)
        scale = np.linalg.norm(columns, axis=0)
        columns = columns / scale
        inverse = np.linalg.pinv(columns.T @ columns, hermitian=True)
        weights = inverse @ (columns.T @ (piece - modes.drift * np.arange(piece.size)))
        slopes = np.zeros((count, columns.shape[1]))
        for k in range(count):
            own = slice(2 * k, 2 * k + 2)
            pull = columns[:, own].T @ columns[:, own] @ weights[own]
            power[k] += weights[own] @ pull
            slopes[k, own] = 2 * pull
        covariance += spread**2 * slopes @ inverse @ slopes.T
    return power, covariance
