"""Smoothing as one banded least-squares problem: what a Rauch-Tung-Striebel smoother computes, without its loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class PenalisedStates:
    """The problem of one stretch, states z: z[k + 1] = phi[k] z[k] + given[k] + w[k], seen[k] = h[k] z[k] + e[k].

    Attributes:
        band: (6, 3 n) lower bands of the precision matrix of all states.
        carried: (n - 1, 3, 3) phi' times the precision of w.
        inverse: (n - 1, 3, 3) precision of w.
        h: (n, 3) what is measured of the states.
        seen: (n,) measured, in units of its noise.
        given: (n - 1, 3) known input.
        force_noise: what the noise of the force adds to a speed.
        prior: log-determinant of the prior's precision.
    """

    band: np.ndarray
    carried: np.ndarray
    inverse: np.ndarray
    h: np.ndarray
    seen: np.ndarray
    given: np.ndarray
    force_noise: float
    prior: float

    def right(self, seen: np.ndarray, given: np.ndarray) -> np.ndarray:
        """(3 n,) right-hand side of the normal equations."""
        right = self.h * seen[:, None]
        right[1:] += np.einsum("kc,kca->ka", given, self.inverse)
        right[:-1] -= np.einsum("kac,kc->ka", self.carried, given)
        return right.ravel()

    def noise(self, seed: int) -> np.ndarray:
        """The same for sensor and force noise alone."""
        random = np.random.default_rng(seed)
        kick = self.force_noise * random.standard_normal(self.given.shape[0])
        given = np.column_stack([kick / 2, kick, np.zeros_like(kick)])
        return self.right(random.standard_normal(self.seen.size), given)

    def log_likelihood(self) -> float:
        """Logarithm of the likelihood of what was seen, but for a constant; -inf where the numbers do not carry it."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        try:
            factor = cholesky_banded(self.band, lower=True, check_finite=False)
        except np.linalg.LinAlgError:
            return -np.inf
        right = self.right(self.seen, self.given)
        states = cho_solve_banded((factor, True), right, check_finite=False)
        misfit = self.constant() - float(right @ states)
        value = -0.5 * (misfit + 2 * float(np.sum(np.log(factor[0]))) - self.prior)
        return value if np.isfinite(value) else -np.inf

    def constant(self) -> float:
        """What the misfit holds whatever the states are."""
        return float(self.seen @ self.seen) + float(np.einsum("ka,kab,kb->", self.given, self.inverse, self.given))
