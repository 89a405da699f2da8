"""Smoothing as one banded least-squares problem: what a Rauch-Tung-Striebel smoother computes, without its loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Change:
    """How a problem changes with one number of its model.

    Attributes:
        phi: (n - 1, 3, 3) of the transitions; 0 where they do not.
        spread: (3, 3) of the covariance of each w.
        begin: (3,) of the logarithm of the variance of the first state.
    """

    phi: np.ndarray | float
    spread: np.ndarray
    begin: np.ndarray


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
        return self._solved()[0]

    def _solved(self) -> tuple[float, np.ndarray, np.ndarray]:
        """The same with the banded factor and the (3 n,) most likely states."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        try:
            factor = cholesky_banded(self.band, lower=True, check_finite=False)
        except np.linalg.LinAlgError:
            return -np.inf, self.band, self.band[0]
        right = self.right(self.seen, self.given)
        states = cho_solve_banded((factor, True), right, check_finite=False)
        misfit = self.constant() - float(right @ states)
        value = -0.5 * (misfit + 2 * float(np.sum(np.log(factor[0]))) - self.prior)
        return value if np.isfinite(value) else -np.inf, factor, states

    def constant(self) -> float:
        """What the misfit holds whatever the states are."""
        return float(self.seen @ self.seen) + float(np.einsum("ka,kab,kb->", self.given, self.inverse, self.given))

    def slopes(self, phi: np.ndarray, begin: np.ndarray, changes: Sequence[Change]) -> tuple[float, np.ndarray]:
        """``log_likelihood``, and its derivatives by the numbers of the model.

        That of a likelihood is the mean, over the states as the measured ones leave them, of that of the likelihood of
        states and measured together (Fisher's identity: Dempster, Laird, Rubin 1977); it needs the covariance of each
        state and its successor, which the banded factor has (``_covariances``).

        Args:
            phi: (n - 1, 3, 3) transitions.
            begin: (3,) prior variance of the first state.
            changes: by each number.

        Returns:
            -inf and zeros where the numbers do not carry it.
        """
        value, factor, states = self._solved()
        slopes = np.zeros(len(changes))
        if not np.isfinite(value):
            return value, slopes
        states = states.reshape(-1, 3)
        own, beside = _covariances(factor)
        kick = states[1:] - np.einsum("kab,kb->ka", phi, states[:-1]) - self.given
        # mean of w w', and of z w': by the means, and by the covariances
        carried = phi @ beside
        power = kick[:, :, None] * kick[:, None, :] + own[1:] + phi @ own[:-1] @ np.swapaxes(phi, 1, 2)
        power -= carried + np.swapaxes(carried, 1, 2)
        along = states[:-1, :, None] * kick[:, None, :] + beside - own[:-1] @ np.swapaxes(phi, 1, 2)
        excess = self.inverse @ power @ self.inverse - self.inverse
        first = (states[0] ** 2 + np.diag(own[0])) / begin - 1.0
        for k, change in enumerate(changes):
            slopes[k] = 0.5 * float(np.einsum("kab,ba->", excess, change.spread) + first @ change.begin)
            slopes[k] += float(np.sum(np.einsum("kab,kbc->kac", self.inverse, np.swapaxes(along, 1, 2)) * change.phi))
        return value, slopes


def _covariances(factor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3, 3) covariance of each state, and (n - 1, 3, 3) of each with the next, from the banded factor (6, 3 n).

    With L the factor's diagonal blocks and G = M L^-1, M those below, the covariances are S[k] = (L L')^-1 + G' S[k+1]
    G and -G' S[k+1] (Takahashi, Fagan, Chin 1973): a linear recursion from the last state to the first, which is
    written as one banded triangular system.
    """
    from scipy.linalg import get_lapack_funcs

    n = factor.shape[1] // 3
    lower, below = np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
    for i in range(3):
        for j in range(3):
            if i >= j:
                lower[:, i, j] = factor[i - j, j::3]
            below[:, i, j] = factor[3 + i - j, j::3]
    inverse = np.linalg.inv(lower)
    own = np.swapaxes(inverse, 1, 2) @ inverse
    gain = below[:-1] @ inverse[:-1]
    bands = np.zeros((18, 9 * n))
    bands[0] = 1.0
    # vec(G' S G) of state k, which stands n - 1 - k blocks from the first
    turned = np.einsum("kca,kdb->kabcd", gain, gain).reshape(-1, 9, 9)[::-1]
    for row in range(9):
        for column in range(9):
            bands[9 + row - column, column : 9 * (n - 1) : 9] = -turned[:, row, column]
    (solved,) = get_lapack_funcs(("tbtrs",), (bands,))
    covariance, _ = solved(bands, own[::-1].reshape(-1, 1), uplo="L", diag="U")
    covariance = covariance.reshape(n, 3, 3)[::-1]
    return covariance, -np.swapaxes(gain, 1, 2) @ covariance[1:]
