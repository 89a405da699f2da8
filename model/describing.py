"""Describing functions: the linear spring and damper that take the place of all laws in a harmonic motion.

For ``x = A cos(phi)``, ``v = -A omega sin(phi)`` the fundamental of the force f(x, v) per unit mass is that of the
spring ``k(A, omega)`` and the damper ``d(A, omega) = 2 h``:

    k = 1/(pi A) ∫ f cos(phi) dphi,    d = -1/(pi A omega) ∫ f sin(phi) dphi        over one cycle

(Krylov and Bogoliubov 1937; Gelb and Vander Velde 1968, section 2.2). Closed forms for the single laws: cubic
3/4 c A², quintic 5/8 c A⁴ (Eq. 6 of Feldman, Bucher, Rotberg), preload 4 P/(pi A), dry friction 4 D/(pi omega A).
Eq. 15 of that paper plots k(A) A and h(A) A omega as if they were the static force; they are these functions. Laws with
a memory are integrated to their periodic state (``harmonic``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .harmonic import Memory
from .inner_force import InnerForce, without_memory
from .quadrature import split_panels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .oscillator import Oscillator

_INTERVALS = 32  # of a cycle: a polynomial law is exact to rounding, friction of a hundredth of the speed to 1e-6
_TURNS, _FAR = 30, 0.3
_SETTLED, _TOLERABLE = 1e-10, 1e-6  # of omega²


def equivalent_stiffness(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Equivalent stiffness per unit mass k(A, omega), the squared natural frequency of the equivalent system.

    Args:
        oscillator: the model.
        amplitude: of the displacement, (n,), in its unit, above zero.
        omega: frequency of the motion, rad/s, (n,) or one for all.

    Returns:
        (n,), rad²/s². A mean force (from a static load or an asymmetric spring) has no part in it.

    Raises:
        BadInput: an amplitude or frequency is not positive, or the memory of a law does not become periodic.
    """
    return _periodic(oscillator, amplitude, omega)[0]


def equivalent_damping(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Equivalent viscous damping per unit mass d(A, omega) = 2 h, (n,), 1/s; arguments and errors as above.

    Twice the damping h that FREEVIB gives (Eq. 12) and ``damping_curve`` returns.
    """
    return _periodic(oscillator, amplitude, omega)[1]


def describing_functions(
    oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Both, k (n,) and d (n,); NaN where a law's memory is so much faster than the motion that it cannot be followed.

    Arguments and other errors as above.
    """
    return HarmonicMotion(oscillator)(amplitude, omega)


def natural_motion(oscillator: Oscillator, amplitude: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Mean natural frequency (n,), rad/s, and h (n,), 1/s, at the amplitudes (n,): ``omega² = k(A, omega)``.

    This is what FREEVIB and FORCEVIB measure. NaN where the spring has softened to nothing. Only with a law that has a
    memory does k depend on the frequency; of several solutions one near omega0 is taken, and NaN where none is found.
    Raises BadInput as above.
    """
    return HarmonicMotion(oscillator).natural(amplitude)


def _natural(harmonic: HarmonicMotion, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    omega = np.full(a.shape, harmonic.omega0)
    k, d = harmonic(a, omega)
    if not harmonic.remembers:
        omega = np.sqrt(np.where(k > 0, k, np.nan))
        return omega, np.where(k > 0, harmonic(a, np.where(k > 0, omega, 1.0))[1] / 2, np.nan)
    last, excess = omega, k - omega**2
    omega = np.sqrt(np.where(k > 0, k, omega**2))
    open_ = np.flatnonzero(k > 0)
    for _ in range(_TURNS):  # the secant, and where that goes far the plain repetition
        if not open_.size:
            break
        w = omega[open_]
        k[open_], d[open_] = harmonic(a[open_], w)
        now = k[open_] - w**2
        with np.errstate(divide="ignore", invalid="ignore"):
            new = w - now * (w - last[open_]) / (now - excess[open_])
        far = ~(np.abs(new - w) < _FAR * w)
        new = np.where(far, np.sqrt(np.where(k[open_] > 0, 0.5 * (k[open_] + w**2), np.nan)), new)
        done = np.abs(now) <= _SETTLED * w**2
        last[open_], excess[open_] = w, now
        omega[open_] = np.where(done, w, new)
        open_ = open_[~done & np.isfinite(new)]
    settled = np.abs(k - omega**2) <= _TOLERABLE * omega**2
    return np.where(settled, omega, np.nan), np.where(settled, d / 2, np.nan)


def _periodic(oscillator: Oscillator, amplitude: ArrayLike, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    equivalent = HarmonicMotion(oscillator)(amplitude, omega)
    if not np.all(np.isfinite(equivalent)):
        a = np.broadcast_to(positive(amplitude, "amplitude", ""), equivalent[0].shape)[~np.isfinite(equivalent[0])]
        raise BadInput(
            f"a law with a memory follows no periodic motion at amplitude {a[0] if a.size else 0.0:.3g} "
            f"{oscillator.response.displacement_unit}, or is far faster than it; choose other amplitudes, or simulate"
        )
    return equivalent


def positive(values: ArrayLike, what: str, unit: str) -> np.ndarray:
    """``values`` as an array (n,); raises BadInput where one is not a finite number above zero."""
    array = np.atleast_1d(np.asarray(values, dtype=float))
    wrong = ~(np.isfinite(array) & (array > 0))
    if array.ndim != 1:
        raise BadInput(f"{what} must be one number or a row of numbers, not an array of shape {array.shape}")
    if np.any(wrong):
        raise BadInput(f"{what} must be above zero, but one is {array[wrong][0]:g} {unit}; give one above zero")
    return array


class HarmonicMotion:
    """The laws of one oscillator in a harmonic motion, ready for any amplitudes and frequencies.

    Attributes:
        omega0: natural frequency of the linear spring, rad/s.
        remembers: whether a law has a memory or a mass, so that the stiffness depends on the frequency.
    """

    def __init__(self, oscillator: Oscillator) -> None:
        plain, memory = without_memory(oscillator)
        self.omega0 = oscillator.omega0.value
        self._unit = oscillator.response.displacement_unit
        self._force = InnerForce(plain)
        self.remembers = memory is not None or self._force.carries
        self._memory = None if memory is None else Memory(memory)

    def natural(self, amplitude: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Mean natural frequency (n,), rad/s, and h (n,), 1/s, as ``natural_motion`` gives them."""
        return _natural(self, positive(amplitude, "amplitude", self._unit))

    def __call__(self, amplitude: ArrayLike, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Equivalent stiffness k (n,) and damping d (n,), as ``describing_functions`` gives them."""
        a = positive(amplitude, "amplitude", self._unit)
        w = positive(omega, "omega", "rad/s")
        if w.size not in (1, a.size):
            raise BadInput(
                f"{a.size} amplitudes with {w.size} frequencies; give one frequency or one for each amplitude"
            )
        w = np.broadcast_to(w, a.shape)
        force = self._force

        def surfaces(phi: np.ndarray, row: np.ndarray) -> np.ndarray:
            return force.surfaces(a[row] * np.cos(phi), -a[row] * w[row] * np.sin(phi))

        panels = split_panels(surfaces, a.size, 2 * np.pi, _INTERVALS)
        cos, sin = np.cos(panels.angle), np.sin(panels.angle)
        x = a[:, None, None] * cos
        f = force(x, -(a * w)[:, None, None] * sin, -((w**2)[:, None, None]) * x)
        stiffness = panels.integral(f * cos) / (np.pi * a)
        damping = -panels.integral(f * sin) / (np.pi * a * w)
        if self._memory is not None:
            more = self._memory.fundamental(a, w)
            stiffness, damping = stiffness + more.stiffness, damping + more.damping
        return stiffness, damping
