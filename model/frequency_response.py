"""Steady response to a harmonic force, from the curves omega0(A) and h(A).

Feldman, Bucher, Rotberg, Eqs. 13 and 14, in terms of the force amplitude per unit mass f, which replaces their
A_max by f = 2 A_max h omega0. Eq. 13 as printed is dimensionally wrong: the last term under its root must be
4 h² omega² / omega0⁴. Eq. 14 is the right inverse of the corrected Eq. 13. Written in f neither divides by h.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .describing import natural_motion, positive
from .inner_force import without_memory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .oscillator import Oscillator

_FINE = 1e-12
_A_DECADE = 12


@dataclass(frozen=True)
class FrequencyResponse:
    """Both branches of the steady response; every array has shape (n,).

    Attributes:
        amplitude: of the displacement, in its unit, rising.
        omega0: natural frequency at that amplitude, rad/s: the backbone between the branches.
        lower: frequency below resonance with that amplitude, rad/s; NaN where the amplitude is never that small.
        upper: frequency above resonance, rad/s; NaN on both branches where the amplitude is never that large.
    """

    amplitude: np.ndarray
    omega0: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """Frequency and amplitude (m,) along one line for plotting: up the lower branch, down the upper one."""
        omega = np.concatenate([self.lower, self.upper[::-1]])
        amplitude = np.concatenate([self.amplitude, self.amplitude[::-1]])
        there = np.isfinite(omega)
        return omega[there], amplitude[there]


def steady_amplitude(omega: ArrayLike, omega0: ArrayLike, h: ArrayLike, force: ArrayLike) -> np.ndarray:
    """Corrected Eq. 13: ``A = f / (omega0² sqrt((1 - omega²/omega0²)² + 4 h² omega²/omega0⁴))``.

    Args:
        omega: frequency of the force, rad/s.
        omega0: natural frequency at the amplitude A, rad/s.
        h: damping at the amplitude A (viscous = 2 h), 1/s.
        force: amplitude of the force per unit mass f, displacement's unit per s².

    Returns:
        A of the broadcast shape, in the displacement's unit. With curves that depend on A this is one step of a
        fixed-point iteration, not the solution; ``branches`` is the solution.
    """
    w, w0, damping = (np.asarray(value, dtype=float) for value in (omega, omega0, h))
    return np.asarray(force, dtype=float) / np.sqrt((w0**2 - w**2) ** 2 + 4 * damping**2 * w**2)


def branches(amplitude: ArrayLike, omega0: ArrayLike, h: ArrayLike, force: float) -> FrequencyResponse:
    """Eq. 14: the two frequencies at which a force of amplitude f keeps up the amplitude A.

    ``omega² = omega0² - 2 h² ± sqrt(f²/A² - 4 h² (omega0² - h²))``

    Args:
        amplitude: of the displacement, (n,), in its unit, rising.
        omega0: backbone at these amplitudes, (n,), rad/s.
        h: damping curve at these amplitudes, (n,), 1/s; half the equivalent viscous damping.
        force: amplitude of the force per unit mass, displacement's unit per s².

    Raises:
        BadInput: an amplitude, a frequency or the force is not positive, or the lengths differ.
    """
    a, w0 = positive(amplitude, "amplitude", ""), positive(omega0, "omega0", "rad/s")
    damping, f = np.atleast_1d(np.asarray(h, dtype=float)), positive(force, "the force amplitude", "")[0]
    if not a.shape == w0.shape == damping.shape:
        raise BadInput(f"{a.size} amplitudes, {w0.size} frequencies and {damping.size} dampings; give equal lengths")
    inside = (f / a) ** 2 - 4 * damping**2 * (w0**2 - damping**2)
    # at the very peak the two terms cancel: rounding must not lose it
    inside = np.where(np.abs(inside) < _FINE * (f / a) ** 2, 0.0, inside)
    middle = w0**2 - 2 * damping**2
    root = np.sqrt(np.where(inside >= 0, inside, np.nan))
    lower, upper = middle - root, middle + root
    return FrequencyResponse(
        amplitude=a,
        omega0=w0,
        lower=np.sqrt(np.where(lower >= 0, lower, np.nan)),
        upper=np.sqrt(np.where(upper >= 0, upper, np.nan)),
    )


def frequency_response(
    oscillator: Oscillator, force: float, amplitude: ArrayLike | None = None, points: int = 300
) -> FrequencyResponse:
    """Steady response of a model to ``force · cos(omega t)``, by its describing functions (first harmonic balance).

    Args:
        oscillator: the model.
        force: amplitude of the force in ``oscillator.force_unit``; per unit mass where the mass is null.
        amplitude: of the displacement, (n,), rising; by default ``points`` of them up to the peak itself, dense there.
        points: how many amplitudes by default.

    Returns:
        Both branches. h is taken at the natural frequency of each amplitude, as in Eqs. 13 and 14.

    Raises:
        BadInput: the force or an amplitude is not positive, friction holds the mass against this force, there is no
            peak (the damping is not positive, or the spring softens to nothing first).
    """
    f = positive(force, "the force amplitude", oscillator.force_unit)[0]
    if oscillator.mass is not None:
        f /= oscillator.mass.value
    a = _up_to_peak(oscillator, f, points) if amplitude is None else positive(amplitude, "amplitude", "")
    stiffness, h = _curves(oscillator)(a)
    there = stiffness > 0
    if not np.all(there):
        raise BadInput(f"the spring has softened to nothing at amplitude {a[~there][0]:g}; stay below it")
    return branches(a, np.sqrt(stiffness), h, float(f))


#: Squared natural frequency and h at amplitudes (n,), NaN where there is none.
_Curves = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def _curves(oscillator: Oscillator) -> _Curves:
    """The curves by which the response is found; known amplitudes are kept where a memory makes them costly."""
    if without_memory(oscillator)[1] is None:

        def exact(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            omega, h = natural_motion(oscillator, a)
            return omega**2, h

        return exact
    return _interpolated(oscillator)


def _interpolated(oscillator: Oscillator) -> _Curves:
    """The same with a law that has a memory: from ``_A_DECADE`` amplitudes a decade, each computed once."""
    known: dict[int, tuple[float, float]] = {}

    def at(places: np.ndarray) -> np.ndarray:
        new = [int(i) for i in np.unique(places) if int(i) not in known]
        if new:
            omega, h = natural_motion(oscillator, 10.0 ** (np.array(new) / _A_DECADE))
            known.update(zip(new, zip((omega**2).tolist(), h.tolist(), strict=True), strict=True))
        return np.array([known[int(i)] for i in places])

    def curves(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        from scipy.interpolate import PchipInterpolator

        place = np.log10(a) * _A_DECADE
        grid = np.arange(np.floor(place.min()) - 1, np.ceil(place.max()) + 2)
        samples = at(grid)
        there = np.isfinite(samples[:, 0])
        if np.count_nonzero(there) < 2:
            return np.full(a.shape, np.nan), np.full(a.shape, np.nan)
        curve = PchipInterpolator(grid[there], samples[there], extrapolate=False)(place)
        curve[np.isnan(np.interp(place, grid, np.where(there, 0.0, np.nan)))] = np.nan
        return curve[:, 0], curve[:, 1]

    return curves


def _up_to_peak(oscillator: Oscillator, f: float, points: int) -> np.ndarray:
    """Amplitudes from a hundredth of the peak to the peak, where f²/A² = 4 h² (omega0² - h²)."""

    curves = _curves(oscillator)

    def surplus(a: np.ndarray) -> np.ndarray:
        """Positive where the force drives more than the damping takes; NaN where the spring has gone."""
        stiffness, h = curves(a)
        takes = np.where(h > 0, 4 * h**2 * (stiffness - h**2) * a**2, 0.0)
        return np.where(stiffness > 0, f**2 - takes, np.nan)

    a = f / oscillator.omega0.value**2 * np.geomspace(1e-4, 1e5, 91)
    sign = surplus(a)
    driven = np.flatnonzero(sign > 0)
    if not driven.size:
        raise BadInput("friction holds the mass against this force: there is no steady vibration; raise the force")
    first = driven[0]
    ends = np.flatnonzero(~(sign[first:] > 0))
    if not ends.size or not np.isfinite(sign[first + ends[0]]):
        raise BadInput(
            "the response has no peak: the damping is not positive or the spring softens to nothing before the damping "
            "limits the amplitude; choose a smaller force, or amplitudes of your own"
        )
    low, high = a[first + ends[0] - 1], a[first + ends[0]]
    for _ in range(6):  # each round narrows the bracket to a 32nd: all points of a round are one evaluation
        a = np.geomspace(low, high, 33)
        beyond = np.append(~(surplus(a[1:-1]) > 0), True)
        last = int(np.argmax(beyond))
        low, high = a[last], a[last + 1]
    return low * np.maximum(np.sin(np.linspace(0, np.pi / 2, points)), 0.01)[1:]
