"""Backbone and damping curves: natural frequency and damping as functions of the amplitude.

The backbone has two meanings: the frequency of the undamped free vibration (``exact_backbone``, ``preload_backbone``)
and the mean natural frequency of the Hilbert transform, which is a describing function (``polynomial_backbone``,
``describing.equivalent_stiffness``). Where one law is the whole spring the second is higher: by 2.2 % for a cubic and
1.6 % for a preload; where the linear spring prevails the difference is of second order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .describing import positive
from .quadrature import Panels, split_panels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .inner_force import InnerForce
    from .oscillator import Oscillator

_INTERVALS = 32  # of the half cycle
_MOST_INTERVALS = 1024
_ACCURACY = 1e-10  # relative change by doubling the intervals; the error itself is far less
_TOLERABLE = 1e-6  # the same where _MOST_INTERVALS do not settle it
_ROUNDING = 1e-13


def exact_backbone(oscillator: Oscillator, amplitude: ArrayLike) -> np.ndarray:
    """Frequency of the undamped free vibration of a given amplitude, by the energy integral.

    With ``x = c + A cos(phi)`` between the turning points c ± A and V the potential of the static restoring force,

        T = 2 ∫ A sin(phi) dphi / sqrt(2 (V(c + A) - V(x)))        for phi from 0 to pi

    (Nayfeh and Mook 1979, section 2.1). The integrand is smooth between the switches of the laws, where the
    intervals are split, so preload and clearance are exact too. An asymmetric spring shifts the centre c; the
    amplitude is always half the distance of the turning points. Damping and friction are left out.

    Args:
        oscillator: the model.
        amplitude: of the displacement, (n,), in its unit, above zero.

    Returns:
        omega, (n,), rad/s.

    Raises:
        BadInput: an amplitude is not positive, a law has a memory, or there is no free vibration of that amplitude
            because the restoring force does not pull back (a softening spring, a negative preload).
    """
    from .inner_force import InnerForce

    a = positive(amplitude, "amplitude", oscillator.response.displacement_unit)
    force = InnerForce(oscillator)
    centre = _centre(force, a)
    omega = np.full(a.shape, np.nan)
    held = np.isfinite(centre)
    omega[held] = _frequency(force, centre[held], a[held], _INTERVALS)
    change = np.where(np.isfinite(omega), np.inf, np.nan)
    intervals = _INTERVALS
    while intervals < _MOST_INTERVALS and np.any(change > _ACCURACY):  # close to where the spring lets go, x lingers
        intervals *= 2
        rough = np.flatnonzero(change > _ACCURACY)
        finer = _frequency(force, centre[rough], a[rough], intervals)
        change[rough] = np.abs(finer - omega[rough]) / finer
        omega[rough] = finer
    lost = ~(change <= _TOLERABLE)
    if np.any(lost):
        raise BadInput(
            f"there is no free vibration of amplitude {a[lost][0]:.4g} {oscillator.response.displacement_unit}: the "
            "restoring force does not pull back all the way, or only just; choose an amplitude within the model's "
            "validity"
        )
    return omega


def _frequency(force: InnerForce, centre: np.ndarray, a: np.ndarray, intervals: int) -> np.ndarray:
    """Frequency (n,), rad/s, of the motions between centre ± a; NaN where the force does not pull back all the way."""
    panels, work = _work(force, centre, a, intervals)
    left, right = panels.from_start(work), -panels.to_end(work)
    energy = np.where(panels.angle < np.pi / 2, left, right)  # V(c + A) - V(x), from the nearer turning point
    x = centre[:, None, None] + a[:, None, None] * np.cos(panels.angle)
    rate = 2 * energy / force.moving(x) / (a[:, None, None] * np.sin(panels.angle)) ** 2
    there = (panels.width > 0)[..., None]
    held = np.all((rate > 0) | ~there, axis=(1, 2))
    half = panels.integral(1 / np.sqrt(np.where((rate > 0) & there, rate, 1.0)))
    return np.where(held, np.pi / half, np.nan)


def _work(force: InnerForce, centre: np.ndarray, a: np.ndarray, intervals: int) -> tuple[Panels, np.ndarray]:
    """Nodes over the half cycle, and there the work of the restoring force per angle, falling from c + A to c - A."""

    def surfaces(phi: np.ndarray, row: np.ndarray) -> np.ndarray:
        return force.surfaces(centre[row] + a[row] * np.cos(phi), np.zeros(phi.size))

    panels = split_panels(surfaces, a.size, np.pi, intervals)
    x = centre[:, None, None] + a[:, None, None] * np.cos(panels.angle)
    return panels, force.static(x) * a[:, None, None] * np.sin(panels.angle)


def _centre(force: InnerForce, a: np.ndarray) -> np.ndarray:
    """Middle between turning points of equal potential, (n,), by Newton's method; NaN where there is none."""
    centre = np.zeros_like(a)
    off = np.ones(a.shape, dtype=bool)
    for _ in range(60):
        panels, work = _work(force, centre, a, _INTERVALS)
        surplus, scale = panels.integral(work), panels.integral(np.abs(work))
        off = np.abs(surplus) > _ROUNDING * scale
        if not np.any(off):
            return centre
        slope = force.static(centre + a) - force.static(centre - a)
        step = np.full_like(a, np.nan)
        np.divide(surplus, slope, out=step, where=slope > 0)
        step[~off] = 0.0
        centre = centre - np.clip(step, -a, a)
        if np.all(~np.isfinite(step) | (np.abs(step) <= _ROUNDING * a)):
            return centre
    return np.where(off, np.nan, centre)


def preload_backbone(omega0: float, preload: float, amplitude: ArrayLike) -> np.ndarray:
    """Backbone of the preloaded spring, exact: Feldman, Bucher, Rotberg, Eq. 1 (Feldman and Braun 1993).

    ``omega = pi omega0 / (2 arccos(1 / (1 + A k/F0)))`` with ``F0/k = preload / omega0²``. The frequency is twice
    omega0 at A = 0.414 F0/k, not at half of F0/k as the paper's text has it.

    Args:
        omega0: of the spring beyond the preload, rad/s.
        preload: F0/m, displacement's unit per s²; zero is allowed, a negative one (two wells) at large amplitudes.
        amplitude: of the displacement, (n,), in its unit, above zero.

    Returns:
        omega, (n,), rad/s.

    Raises:
        BadInput: an amplitude or omega0 is not positive, or a negative preload keeps the motion in one well.
    """
    a = positive(amplitude, "amplitude", "")
    lifted = positive(omega0, "omega0", "rad/s") ** 2 * a
    if np.any(2 * preload + lifted <= 0):
        raise BadInput(f"with the negative preload {preload:g} the motion of amplitude {np.min(a):g} stays on one side")
    # arccos(P / (P + k A)), written so that small amplitudes lose no digits
    return np.pi * omega0 / (4 * np.arctan2(np.sqrt(lifted), np.sqrt(2 * preload + lifted)))


def polynomial_backbone(omega0: float, cubic: float, amplitude: ArrayLike, quintic: float = 0.0) -> np.ndarray:
    """Mean natural frequency of the polynomial spring: Feldman, Bucher, Rotberg, Eq. 6.

    ``omega² = omega0² + 3/4 cubic A² + 5/8 quintic A⁴``: the Hilbert average, which is the describing function, and
    the first approximation of the free vibration's frequency.

    Args:
        omega0: linear natural frequency, rad/s (alpha1 of the paper is its square).
        cubic, quintic: alpha3 and alpha5 per unit mass, 1/(m² s²) and 1/(m⁴ s²) for metres.
        amplitude: of the displacement, (n,), in its unit, above zero.

    Returns:
        omega, (n,), rad/s.

    Raises:
        BadInput: an amplitude is not positive, or the spring softens to nothing there.
    """
    a = positive(amplitude, "amplitude", "")
    squared = omega0**2 + 0.75 * cubic * a**2 + 0.625 * quintic * a**4
    if np.any(squared <= 0):
        raise BadInput(f"the spring has softened to nothing at amplitude {a[squared <= 0][0]:g}; choose smaller ones")
    return np.sqrt(squared)


def damping_curve(viscous: float, dry: float, amplitude: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Damping h(A) of viscous and dry friction together: Feldman, Bucher, Rotberg, Eq. 7, as FREEVIB sees it.

    ``h = viscous / 2 + 2 dry / (pi omega A)``: half the equivalent viscous damping ``viscous + 4 dry/(pi omega A)``,
    the factor 4/pi being the describing function of sgn(x'), which Eq. 15 leaves out. The paper's h is half of the
    factor of x' in Eqs. 7 and 16 (Eq. 11 as printed has h for 2 h).

    Args:
        viscous: factor of x', 1/s.
        dry: factor of sgn(x'), displacement's unit per s².
        amplitude: of the displacement, (n,), in its unit, above zero.
        omega: frequency of the motion, rad/s, (n,) or one for all; usually the backbone.

    Returns:
        h, (n,), 1/s.

    Raises:
        BadInput: an amplitude or frequency is not positive.
    """
    a, w = positive(amplitude, "amplitude", ""), positive(omega, "omega", "rad/s")
    return viscous / 2 + 2 * dry / (np.pi * w * a)
