"""The Eq. 17 family fitted to a backbone and to a damping curve.

Which form FREEVIB's low-passed values follow was checked on exact periodic solutions. The amplitude of the Hilbert
envelope, low-passed, is that of the fundamental, and on it the describing functions are exact for sgn terms:

    omega0^2(A) = omega0^2 + 3/4 cubic A^2 + 4 preload / (pi A)      (Eq. 6; the Hilbert average of Eq. 2)
    2 h0(A)     = viscous + 4 dry / (pi omega0(A) A)                 (Eq. 7)

Eq. 1 is as exact, on the peak displacement. With `A` at twice preload / omega0^2 the fundamental is 1.4 % larger than
the peak and Eq. 1 on it misses 1.4 % of the preload's part; at 30 times, both agree to 0.2 %.
The 3/4 of the cubic is exact to second order in cubic A^2 / omega0^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from .limits import CURVE_LEAST


@dataclass(frozen=True)
class BackboneFit:
    """Restoring parameters of Eq. 17 from a backbone; SI, per unit mass, each with its standard deviation."""

    omega0: float  # rad/s
    omega0_std: float
    cubic: float  # 1/(m2 s2)
    cubic_std: float
    preload: float  # m/s2
    preload_std: float
    misfit: float  # mean square of the weighted residual per independent value; 1 when the weights explain it


@dataclass(frozen=True)
class DampingFit:
    """Damping parameters of Eq. 17 from a damping curve; SI, per unit mass, each with its standard deviation."""

    viscous: float  # 1/s, 2 h
    viscous_std: float
    dry: float  # m/s2
    dry_std: float
    misfit: float


def backbone_omega0(amplitude: np.ndarray, omega0: float, cubic: float, preload: float) -> np.ndarray:
    """Natural frequency (n,) rad/s at the fundamental's `amplitude` (n,); NaN where the stiffness is negative."""
    a = np.asarray(amplitude, float)
    squared = omega0**2 + 0.75 * cubic * a**2 + 4 * preload / (np.pi * a)
    return np.sqrt(np.where(squared >= 0, squared, np.nan))


def fit_backbone(
    amplitude: np.ndarray, omega0: np.ndarray, weight: np.ndarray | None = None, independent: float | None = None
) -> BackboneFit:
    """Fit omega0, cubic and preload to points (`amplitude` (n,), `omega0` (n,) rad/s) of one or several backbones.

    `weight` (n,): 1 / variance of each omega0, in (s/rad)2; None: all the same, and the scatter gives the variance.
    `independent`: how many independent values the points stand for (curves are smoother than dense); default n.
    The preload shows itself at small and the cubic at large amplitudes; one that the points do not carry (smaller than
    twice its standard deviation) is 0, with the standard deviation it would have had. Raises BadInput below 4 points.
    """
    a, w0 = np.asarray(amplitude, float), np.asarray(omega0, float)
    basis = np.stack([np.ones_like(a), 0.75 * a**2, 4 / (np.pi * a)], axis=1)
    weight = None if weight is None else np.asarray(weight, float) / (2 * w0) ** 2
    value, std, misfit = _fit(basis, w0**2, weight, independent, optional=(1, 2))
    if not value[0] > 0:
        value, _, misfit = _fit(basis[:, :1], w0**2, weight, independent, optional=())
        value = np.array([value[0], 0.0, 0.0])
    base = float(np.sqrt(value[0]))
    return BackboneFit(
        omega0=base,
        omega0_std=float(std[0]) / (2 * base),
        cubic=float(value[1]),
        cubic_std=float(std[1]),
        preload=float(value[2]),
        preload_std=float(std[2]),
        misfit=misfit,
    )


def fit_damping(
    amplitude: np.ndarray,
    omega0: np.ndarray,
    damping: np.ndarray,
    weight: np.ndarray | None = None,
    independent: float | None = None,
) -> DampingFit:
    """Fit viscous and dry to a damping curve: `damping` h0 (n,) 1/s at `amplitude` (n,) and `omega0` (n,) rad/s.

    `weight` (n,): 1 / variance of each h0, in s2; `independent` and what is not carried as in `fit_backbone`.
    """
    a, w0, h = (np.asarray(v, float) for v in (amplitude, omega0, damping))
    basis = np.stack([np.ones_like(a), 4 / (np.pi * w0 * a)], axis=1)
    weight = None if weight is None else np.asarray(weight, float) / 4
    value, std, misfit = _fit(basis, 2 * h, weight, independent, optional=(1,))
    return DampingFit(float(value[0]), float(std[0]), float(value[1]), float(std[1]), misfit)


def _fit(
    basis: np.ndarray,
    target: np.ndarray,
    weight: np.ndarray | None,
    independent: float | None,
    optional: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray, float]:
    """Weighted linear fit; columns of `optional` that the data do not carry are set to zero, worst first."""
    good = np.isfinite(target) & np.all(np.isfinite(basis), axis=1)
    if weight is not None:
        good &= np.isfinite(weight) & (weight > 0)
    if np.count_nonzero(good) < CURVE_LEAST:
        raise BadInput(f"The curve has fewer than {CURVE_LEAST} points; a longer decay or sweep is needed to fit it.")
    root = np.sqrt(weight[good]) if weight is not None else np.ones(np.count_nonzero(good))
    a, b = basis[good] * root[:, None], target[good] * root
    count = float(independent) if independent is not None else float(b.size)
    active = list(range(basis.shape[1]))
    std = np.full(basis.shape[1], np.inf)
    while True:
        scale = np.linalg.norm(a[:, active], axis=0)
        u, s, vt = np.linalg.svd(a[:, active] / scale, full_matrices=False)
        s = np.maximum(s, 1e-12 * s[0])
        part = (vt.T / s) @ (u.T @ b) / scale
        rest = float(np.sum((b - a[:, active] @ part) ** 2))
        misfit = rest / max(1.0, count - len(active))
        spread = np.sqrt(np.sum((vt.T / s) ** 2, axis=1)) / scale
        spread = spread * np.sqrt(max(1.0, misfit) if weight is not None else misfit)
        for i, k in enumerate(active):
            # a parameter left out keeps the uncertainty it had while it was in
            std[k] = spread[i]
        weak = [(abs(part[active.index(k)]) / std[k], k) for k in optional if k in active and std[k] > 0]
        if not weak or min(weak)[0] >= 2:
            value = np.zeros(basis.shape[1])
            value[active] = part
            return value, std, misfit
        active.remove(min(weak)[1])
