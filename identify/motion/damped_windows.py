"""One damped mode about a constant, fitted to many short windows of a recording at once.

Variable projection would do it window by window (Golub and Pereyra 1973); here all five unknowns of every window take
Levenberg's and Marquardt's steps together, a step of the whole batch being one product of arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Steps of a search, and what its damping is divided or multiplied by (Marquardt 1963).
_STEPS, _FACTOR = 10, 6.0
#: Damping ratios where a search begins: one swings on, one is over at once.
_STARTS = (0.02, 0.35)
#: Limits of a damping ratio: what grows is pushed; beyond critical damping the model would be two exponentials.
_LEAST, _MOST = -0.5, 0.97


@dataclass(frozen=True, eq=False)
class Windows:
    """Fits of B windows.

    Attributes:
        rss: (B,) sum of squares that is left.
        omega: (B,) undamped natural frequency in radians a sample.
        zeta: (B,) damping ratio.
        weights: (B, 3 or 4) of cosine, sine, constant and slope; time runs from the first sample of each window.
        information: (B, p, p) of ln omega, zeta and the weights, for a noise of one.
    """

    rss: np.ndarray
    omega: np.ndarray
    zeta: np.ndarray
    weights: np.ndarray
    information: np.ndarray

    def value(self, which: int, times: np.ndarray) -> np.ndarray:
        """(n,) of one window's model at times in samples from its first one, also before and after it."""
        columns = _columns(self.omega[which, None, None], self.zeta[which, None, None], times[None, :])[0][0]
        slope = self.weights[which, 3:]
        return columns @ self.weights[which, :3] + (slope[0] * times if slope.size else 0.0)

    def amplitude(self, at: float) -> np.ndarray:
        """(B,) size of each window's oscillation at a time in samples from its first one."""
        return np.hypot(self.weights[:, 0], self.weights[:, 1]) * np.exp(-self.zeta * self.omega * at)


def fit_windows(samples: np.ndarray, omega: float, *, slope: bool) -> Windows:
    """Fit windows (B, n), each beginning about at ``omega`` radians a sample; n is five or more.

    ``slope``: whether the constant may drift.
    """
    best: Windows | None = None
    for zeta in _STARTS:
        fitted = _searched(samples, np.full(samples.shape[0], omega), np.full(samples.shape[0], zeta), slope)
        best = fitted if best is None else _better(best, fitted)
    assert best is not None
    return best


def _columns(omega: np.ndarray, zeta: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(B, n, 3) cosine, sine, constant, and (B, n, 2, 2) what cosine and sine change with ln omega and zeta."""
    ringing = omega * np.sqrt(1 - zeta**2)
    size = np.exp(-np.clip(zeta * omega * times, -50, 50))
    cosine, sine = size * np.cos(ringing * times), size * np.sin(ringing * times)
    columns = np.stack([cosine, sine, np.ones_like(cosine)], axis=-1)
    faster, slower = -zeta * omega * times, -omega * times  # of the envelope's logarithm, by ln omega and by zeta
    turn, back = ringing * times, -omega * zeta / np.sqrt(1 - zeta**2) * times
    of_cosine = np.stack([faster * cosine - turn * sine, slower * cosine - back * sine], axis=-1)
    of_sine = np.stack([faster * sine + turn * cosine, slower * sine + back * cosine], axis=-1)
    return columns, np.stack([of_cosine, of_sine], axis=-1)


def _searched(samples: np.ndarray, omega: np.ndarray, zeta: np.ndarray, slope: bool) -> Windows:
    count, n = samples.shape
    times = np.arange(n, dtype=float)[None, :]
    least, most = omega / 4, np.minimum(omega * 4, np.pi)
    damping = np.full(count, 1e-2)
    now = _linear(samples, omega, zeta, times, slope)
    for _ in range(_STEPS):
        rss, weights, jacobian, residual = now
        gradient = np.einsum("bnp,bn->bp", jacobian, residual)
        normal = np.einsum("bnp,bnq->bpq", jacobian, jacobian)
        diagonal = np.einsum("bpp->bp", normal)
        floor = 1e-12 * np.max(diagonal, axis=1, keepdims=True) + 1e-300
        raised = normal + np.einsum("bp,pq->bpq", damping[:, None] * diagonal + floor, np.eye(diagonal.shape[1]))
        step = np.linalg.solve(raised, gradient[..., None])[..., 0]
        tried_omega = np.clip(omega * np.exp(np.clip(step[:, 0], -0.3, 0.3)), least, most)
        tried_zeta = np.clip(zeta + np.clip(step[:, 1], -0.3, 0.3), _LEAST, _MOST)
        tried = _linear(samples, tried_omega, tried_zeta, times, slope)
        gains = tried[0] < rss
        omega, zeta = np.where(gains, tried_omega, omega), np.where(gains, tried_zeta, zeta)
        damping = np.clip(np.where(gains, damping / _FACTOR, damping * _FACTOR), 1e-9, 1e6)
        now = tuple(
            np.where(gains.reshape(-1, *[1] * (new.ndim - 1)), new, old) for new, old in zip(tried, now, strict=True)
        )
    rss, weights, jacobian, _ = now
    return Windows(rss, omega, zeta, weights, np.einsum("bnp,bnq->bpq", jacobian, jacobian))


def _linear(
    samples: np.ndarray, omega: np.ndarray, zeta: np.ndarray, times: np.ndarray, slope: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What is left with the best weights, these, the Jacobian (B, n, p) and the residual (B, n)."""
    columns, slopes = _columns(omega[:, None], zeta[:, None], times)
    if slope:
        columns = np.concatenate([columns, np.broadcast_to(times[..., None], (*columns.shape[:2], 1))], axis=-1)
    normal = np.einsum("bnp,bnq->bpq", columns, columns)
    diagonal = np.einsum("bpp->bp", normal)
    normal = normal + 1e-10 * np.einsum("bp,pq->bpq", diagonal, np.eye(diagonal.shape[1]))
    weights = np.linalg.solve(normal, np.einsum("bnp,bn->bp", columns, samples)[..., None])[..., 0]
    residual = samples - np.einsum("bnp,bp->bn", columns, weights)
    moving = np.einsum("bnpk,bk->bnp", slopes, weights[:, :2])
    return np.sum(residual**2, axis=1), weights, np.concatenate([moving, columns], axis=-1), residual


def _better(one: Windows, other: Windows) -> Windows:
    wins = other.rss < one.rss

    def chosen(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.where(wins.reshape(-1, *[1] * (a.ndim - 1)), b, a)

    return Windows(
        chosen(one.rss, other.rss),
        chosen(one.omega, other.omega),
        chosen(one.zeta, other.zeta),
        chosen(one.weights, other.weights),
        chosen(one.information, other.information),
    )
