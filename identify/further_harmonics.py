"""What the motion's own harmonics do to the fundamental of the force: harmonic balance to the second order.

Eqs. 6 and 7 of Feldman, Bucher, Rotberg take the motion for a sine. Preload, dry friction and cubic give it harmonics

    x = A cos(psi) + sum a_n cos(n psi) + b_n sin(n psi),    n = 3, 5, ...

whose size follows from the force along the sine; they move the instants at which the signs change, and meet the cubic,
and so add to the fundamental of the force in turn (Krylov and Bogoliubov 1937, second approximation). Near rest, where
friction is much of the force, and with a strong cubic this is more than the error of the curves.
"""

from __future__ import annotations

import numpy as np

_ORDERS = np.arange(3, 400, 2)
_SIGNS = np.where(_ORDERS % 4 == 1, 1.0, -1.0)
#: Sums over the odd harmonics of a sign: of 1/(n² - 1), and of the same over n with alternating sign.
_SLOPE = float(np.sum(1.0 / (_ORDERS**2 - 1.0)))
_PLACE = float(np.sum(_SIGNS / (_ORDERS * (_ORDERS**2 - 1.0))))


def further_harmonics(
    amplitude: np.ndarray, omega: np.ndarray, cubic: float, preload: float, dry: float
) -> tuple[np.ndarray, np.ndarray]:
    """Further stiffness (n,), 1/s², and further damping 2 h (n,), 1/s, per unit mass, of Eq. 17 beyond Eqs. 6 and 7.

    Args:
        amplitude: of the fundamental (n,), in the displacement's unit.
        omega: of the motion (n,), rad/s.
        cubic, preload, dry: of Eq. 17, per unit mass.
    """
    a, squared = np.asarray(amplitude, float), np.asarray(omega, float) ** 2
    p, d = 4 * preload / np.pi, 4 * dry / np.pi
    third_cosine = (0.25 * cubic * a**3 - p / 3) / (8 * squared)
    third_sine = -d / (24 * squared)
    stiffness = 0.75 * cubic * a * third_cosine - d**2 * _SLOPE / (squared * a**2)
    damping = (p * d * _PLACE / (squared * a**2) - 0.75 * cubic * a * third_sine) / np.sqrt(squared)
    return stiffness, damping


def peak_of(amplitude: np.ndarray, omega: np.ndarray, preload: float) -> np.ndarray:
    """Peak displacement (n,) of a motion whose fundamental is `amplitude` (n,), which a preload makes pointed."""
    return amplitude + _PLACE * 4 * preload / (np.pi * np.asarray(omega, float) ** 2)
