"""Describing functions: the linear spring and damper that take the place of all laws in a harmonic motion.

For ``x = A cos(phi)``, ``v = -A omega sin(phi)`` the fundamental of the force f(x, v) per unit mass is that of the
spring ``k(A, omega)`` and the damper ``d(A, omega) = 2 h``:

    k = 1/(pi A) ∫ f cos(phi) dphi,    d = -1/(pi A omega) ∫ f sin(phi) dphi        over one cycle

(Krylov and Bogoliubov 1937; Gelb and Vander Velde 1968, section 2.2). Closed forms for the single laws: cubic
3/4 c A², quintic 5/8 c A⁴ (Eq. 6 of Feldman, Bucher, Rotberg), preload 4 P/(pi A), dry friction 4 D/(pi omega A).
Eq. 15 of that paper plots k(A) A and h(A) A omega as if they were the static force; they are these functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .inner_force import InnerForce
from .quadrature import split_panels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .oscillator import Oscillator

_INTERVALS = 64  # of a cycle: a polynomial law is then exact to rounding


def equivalent_stiffness(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Equivalent stiffness per unit mass k(A, omega), the squared natural frequency of the equivalent system.

    Args:
        oscillator: the model.
        amplitude: of the displacement, (n,), in its unit, above zero.
        omega: frequency of the motion, rad/s, (n,) or one for all.

    Returns:
        (n,), rad²/s². A mean force (from a static load or an asymmetric spring) has no part in it.

    Raises:
        BadInput: an amplitude or frequency is not positive, or a law has a memory.
    """
    return _describing(oscillator, amplitude, omega)[0]


def equivalent_damping(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Equivalent viscous damping per unit mass d(A, omega) = 2 h, (n,), 1/s; arguments and errors as above.

    Twice the damping h that FREEVIB gives (Eq. 12) and ``damping_curve`` returns.
    """
    return _describing(oscillator, amplitude, omega)[1]


def positive(values: ArrayLike, what: str, unit: str) -> np.ndarray:
    """``values`` as an array (n,); raises BadInput where one is not a finite number above zero."""
    array = np.atleast_1d(np.asarray(values, dtype=float))
    wrong = ~(np.isfinite(array) & (array > 0))
    if array.ndim != 1:
        raise BadInput(f"{what} must be one number or a row of numbers, not an array of shape {array.shape}")
    if np.any(wrong):
        raise BadInput(f"{what} must be above zero, but one is {array[wrong][0]:g} {unit}; leave it out")
    return array


def _describing(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    a = positive(amplitude, "amplitude", oscillator.response.displacement_unit)
    w = positive(omega, "omega", "rad/s")
    if w.size not in (1, a.size):
        raise BadInput(f"{a.size} amplitudes with {w.size} frequencies; give one frequency or one for each amplitude")
    w = np.broadcast_to(w, a.shape)
    force = InnerForce(oscillator)

    def surfaces(phi: np.ndarray, row: np.ndarray) -> np.ndarray:
        return force.surfaces(a[row] * np.cos(phi), -a[row] * w[row] * np.sin(phi))

    panels = split_panels(surfaces, a.size, 2 * np.pi, _INTERVALS)
    cos, sin = np.cos(panels.angle), np.sin(panels.angle)
    f = force(a[:, None, None] * cos, -(a * w)[:, None, None] * sin)
    stiffness = panels.integral(f * cos) / (np.pi * a)
    damping = -panels.integral(f * sin) / (np.pi * a * w)
    return stiffness, damping
