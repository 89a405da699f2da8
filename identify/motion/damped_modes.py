"""Damped modes that several pieces of a recording share, fitted to all of them by variable projection.

Frequencies, damping ratios and the sensor's drift are common; the amplitudes and the constant of each piece are its own
and linear, so that only the former are searched for (Golub and Pereyra 1973, with the Jacobian of Kaufman 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...simulate.recursion import powers
from ..signals.registry import budget, numerics

_STEPS = budget(10, "steps", why="of a search that begins near its end")
_CONVERGED = numerics(1e-5, "part of what is left", why="gained by a step, below which the search has converged")
_DAMPED, _STUCK = numerics((1e-3, 1e6), "of the diagonal", why="Marquardt's damping at first, and at most")
_GROWN = numerics(50.0, "nepers", why="over a piece: what grows by more is not looked at")
_TURN = numerics(0.3, "of ln omega and zeta", why="a step is at most that long")
_FASTEST, _GROWS, _OVER = numerics((3.1, -0.5, 0.99), "rad, ratios", why="the half turn, growth and critical damping")


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes, and the drift of the sensor that shows them.

    Attributes:
        omega: (K,) undamped natural frequencies in radians a sample.
        zeta: (K,) damping ratios.
        covariance: (2K, 2K) of ln omega and zeta.
        drift: of the constant, a sample.
    """

    omega: np.ndarray
    zeta: np.ndarray
    covariance: np.ndarray
    drift: float = 0.0

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.omega.size

    @property
    def cycle(self) -> float:
        """Samples of a cycle of the slowest mode."""
        return float(2 * np.pi / np.min(self.omega))

    @property
    def unknown(self) -> float:
        """Standard deviation of ln omega and zeta together, the mean over the modes."""
        return float(np.sqrt(np.trace(self.covariance) / self.count))

    def by_blocks(self, ratio: float) -> Modes:
        """The same modes by means of so many times as many samples."""
        return replace(self, omega=self.omega * ratio, drift=self.drift * ratio)

    def columns(self, n: int) -> np.ndarray:
        """(n, 2K + 1) cosine and sine of each mode, and a constant, over a piece of n samples."""
        return _columns(_waves(_poles(self.omega, self.zeta), n))


def fit_modes(pieces: Sequence[np.ndarray], start: Modes, deviation: Sequence[float]) -> tuple[Modes, np.ndarray]:
    """Fit modes to pieces, each (n,), whose residuals have these standard deviations.

    Returns:
        The modes, and the sum of squares that each piece leaves, in its own unit.
    """
    count = start.count
    unknown = np.concatenate([np.log(start.omega), start.zeta, [start.drift]])
    low = np.concatenate([np.full(count, -np.inf), np.full(count, _GROWS), [-np.inf]])
    high = np.concatenate([np.full(count, np.log(_FASTEST)), np.full(count, _OVER), [np.inf]])
    normal, gradient, rss = _linearised(pieces, unknown, deviation)
    damping, cost = _DAMPED, float(np.sum(rss / np.square(deviation)))
    for _ in range(_STEPS):
        diagonal = np.diag(normal)
        scale = np.sqrt(np.maximum(diagonal, 1e-300))
        raised = normal / np.outer(scale, scale) + damping * np.eye(scale.size)
        step = np.linalg.lstsq(raised, gradient / scale)[0] / scale
        step[:-1] = np.clip(step[:-1], -_TURN, _TURN)
        tried_at = np.clip(unknown + step, low, high)
        new = _linearised(pieces, tried_at, deviation)
        tried = float(np.sum(new[2] / np.square(deviation)))
        if tried < cost:
            done = cost - tried < _CONVERGED * cost
            (normal, gradient, rss), unknown, cost, damping = new, tried_at, tried, damping / 10
            if done:
                break
        else:
            damping = 10 * damping
            if damping > _STUCK:
                break
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    covariance = np.linalg.pinv(normal / np.outer(scale, scale), hermitian=True) / np.outer(scale, scale)
    modes = Modes(np.exp(unknown[:count]), unknown[count:-1], covariance[:-1, :-1], float(unknown[-1]))
    return modes, rss


def _linearised(
    pieces: Sequence[np.ndarray], unknown: np.ndarray, deviation: Sequence[float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Normal equations of ln omega, zeta and drift, the unknowns of each piece eliminated, and what is left of each."""
    count = unknown.size // 2
    omega, zeta, drift = np.exp(unknown[:count]), unknown[count:-1], unknown[-1]
    poles = _poles(omega, zeta)
    slopes = np.concatenate([poles, -omega * (1.0 + 1j * zeta / np.sqrt(1 - zeta**2))])  # by ln omega and by zeta
    normal, gradient, rss = np.zeros((unknown.size, unknown.size)), np.zeros(unknown.size), np.zeros(len(pieces))
    for k, (piece, spread) in enumerate(zip(pieces, deviation, strict=True)):
        times = np.arange(piece.size, dtype=float)
        waves = _waves(poles, piece.size)
        columns = _columns(waves)
        scale = np.linalg.norm(columns, axis=0)
        basis, triangle = np.linalg.qr(columns / scale)
        steady = piece - drift * times
        seen = basis.T @ steady
        residual = steady - basis @ seen
        weights = (np.linalg.lstsq(triangle, seen)[0] / scale)[: 2 * count]
        moving = times[:, None] * waves * (weights[0::2] - 1j * weights[1::2])  # by the poles
        jacobian = np.empty((piece.size, unknown.size))
        jacobian[:, :-1] = np.real(np.concatenate([moving, moving], axis=1) * slopes)
        jacobian[:, -1] = times
        jacobian -= basis @ (basis.T @ jacobian)
        normal += jacobian.T @ jacobian / spread**2
        gradient += jacobian.T @ residual / spread**2
        rss[k] = residual @ residual
    return normal, gradient, rss


def _poles(omega: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """(K,) of damped modes, by the sample."""
    return omega * (-zeta + 1j * np.sqrt(1 - zeta**2))


def _waves(poles: np.ndarray, n: int) -> np.ndarray:
    """(n, K) one as it rings with each pole."""
    return powers(np.minimum(np.real(poles), _GROWN / n) + 1j * np.imag(poles), n)


def _columns(waves: np.ndarray) -> np.ndarray:
    """(n, 2 K + 1) cosine and sine of each, and a constant."""
    columns = np.ones((len(waves), 2 * waves.shape[1] + 1))
    columns[:, :-1] = waves.view(float)
    return columns
