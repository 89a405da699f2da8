"""Instantaneous modal parameters, sample by sample: the paper's formulas as they are, neither low-passed nor fitted.

With the analytic signals X = A exp(i psi) of the response and F of the force, per unit mass

    X'' + 2 h0 X' + omega0² X = F / m.

Divided by X, real and imaginary part each give one of the two parameters (Feldman, Bucher, Rotberg 2009, Eqs. 9-12;
with a force Feldman 1994, part II). Eq. 9's cross term is `2 i (A'/A) psi'`; Eq. 11 as printed has h for `2 h0`.
"""

from __future__ import annotations

import numpy as np

from ..signals.hilbert import AnalyticSignal
from ..signals.registry import numerics

_STILL = numerics(1e-12, "rad/s", why="a phase that stands still has no frequency to divide by")


def free_modal_parameters(signal: AnalyticSignal) -> tuple[np.ndarray, np.ndarray]:
    """FREEVIB, Eq. 12: omega0² (n,) in rad²/s² and h0 (n,) in 1/s of a free vibration, at every sample.

        omega0² = omega² - A''/A + 2 (A'/A)² + A' omega' / (A omega),    h0 = -A'/A - omega' / (2 omega)

    For a linear system `viscous = 2 h0`.
    """
    growth, omega = signal.growth, _moving(signal.omega)
    squared = omega**2 - signal.curvature + 2 * growth**2 + growth * signal.chirp / omega
    return squared, -growth - signal.chirp / (2 * omega)


def forced_modal_parameters(signal: AnalyticSignal, ratio: np.ndarray, mass: float) -> tuple[np.ndarray, np.ndarray]:
    """FORCEVIB (Feldman 1994): omega0² (n,) in rad²/s² and h0 (n,) in 1/s under a force, at every sample.

    With F/X = alpha + i beta:

        omega0² = omega² + alpha/m - beta A'/(A omega m) - A''/A + 2 (A'/A)² + A' omega' / (A omega)
        h0      = beta/(2 omega m) - A'/A - omega'/(2 omega)

    Args:
        signal: of the displacement.
        ratio: F/X (n,), complex, N/m: the force's analytic signal over the displacement's (``hilbert.turned_alike``).
        mass: kg; it comes from two instants of one amplitude, or from many (``modal_mass``).
    """
    squared, h0 = free_modal_parameters(signal)
    omega = _moving(signal.omega)
    drive = ratio / mass
    return squared + drive.real - drive.imag * signal.growth / omega, h0 + drive.imag / (2 * omega)


def modal_parameters(
    signal: AnalyticSignal, ratio: np.ndarray | None, inverse_mass: float
) -> tuple[np.ndarray, np.ndarray]:
    """Those of a free vibration where there is no `ratio`, else of a forced one; 1/m in 1/kg."""
    if ratio is None or not inverse_mass:
        return free_modal_parameters(signal)
    return forced_modal_parameters(signal, ratio, 1 / inverse_mass)


def _moving(omega: np.ndarray) -> np.ndarray:
    return np.where(np.abs(omega) > _STILL, omega, _STILL)
