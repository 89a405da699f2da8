"""What happens within a cycle of a decay: harmonics, the natural frequency's oscillation, congruent curves, half-waves.

A low-passed backbone knows the fundamental alone. The harmonics that go with it,

    x = u_0 + Re( A exp(i psi) + sum u_n exp(i n psi) ),    n = 2, 3, ...

are found as the fundamental is: turned back, by n psi, and low-passed. From them follow

* Eq. 5 of Feldman, Bucher, Rotberg 2009: with X the whole analytic signal,
  ``omega0²(t) + i delta(t) = -(X'' + 2 h0 X')/X`` swings about its mean (Eq. 6), of
  a cubic by ``cubic A²/4 cos(2 psi)`` but for the harmonics in X;
* congruent curves (Feldman 1997, 2007): at the instant at which the harmonics add up to the peak, the forces of all of
  them add up to the static force there: no factor of 3/4 or 4/pi is left to invert;
* half-waves apart: of an asymmetric rig each side has its own amplitude, and its own frequency, half the inverse of the
  time spent there; of a bilinear spring these are the two frequencies of its two springs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...recording.smoothing import convolved
from ..signals.hilbert import blackman
from ..signals.odds import BY_CHANCE
from ..signals.registry import budget, numerics
from .instantaneous import free_modal_parameters
from .limits import KERNELS_A_VALUE
from .modal_stretch import Stretch

_MOST = budget(9, "harmonics", why="that are looked for")
_LEAST_SAMPLES = numerics(4.0, "samples a cycle", why="of the highest of them")
_ANGLES = numerics(
    720,
    "angles of a cycle",
    why="at which crossings are looked for; between them a straight line is good to 1e-6 of the cycle",
)
_AT_ONCE = budget(2000, "cycles", why="that are interpolated at once")


@dataclass(frozen=True, eq=False)
class WithinTheCycle:
    """Of one decay, at the times of its curve; every array has shape (n,), but for the harmonics.

    Attributes:
        orders: of the harmonics, 0, 2, 3, ...
        harmonics: u_n, complex, (orders, n), in the displacement's unit; zero where noise alone may be as
            large. u_0 is the centre of the motion over that at rest.
        harmonics_std: standard error of their real and imaginary parts, (n,).
        omega0: natural frequency of Eq. 5 at each instant, rad/s; NaN where omega0²(t) is negative.
        hysteresis: delta(t) of Eq. 5, 1/s²; its mean over a cycle is zero.
        amplitude: congruent amplitude, half the distance of the two peaks.
        restoring: congruent restoring force per unit mass at that amplitude, of the symmetric part of the spring.
        restoring_std: its standard error.
        peaks: (2, n), of the half-waves above and below rest, both positive.
        omega: (2, n), rad/s, of the half-waves above and below rest.
    """

    orders: tuple[int, ...]
    harmonics: np.ndarray
    harmonics_std: np.ndarray
    omega0: np.ndarray
    hysteresis: np.ndarray
    amplitude: np.ndarray
    restoring: np.ndarray
    restoring_std: np.ndarray
    peaks: np.ndarray
    omega: np.ndarray


def within_the_cycle(stretch: Stretch, samples: np.ndarray, good: np.ndarray, held: float = 0.0) -> WithinTheCycle:
    """The harmonics of a decay and what follows from them.

    Args:
        stretch: the decay.
        samples: (m,), of the displacement, which the stretch was made from the beginning of.
        good: of its low-passed values those that are asked for, (k,) of bool.
        held: how far from its middle friction can hold the mass, in the displacement's unit: a centre that moves by no
            more is no asymmetry, unless an even harmonic says so too.
    """
    s = stretch.signal
    squared, damping = free_modal_parameters(s)
    by_sample = squared, damping
    low = stretch.low_pass(np.stack([squared, damping, s.omega, s.growth]))[:, good]
    squared, damping, omega, growth = low
    a, phase = stretch.smooth_motion
    a, phase = a[good], phase[good]
    orders = np.array([0, *range(2, 1 + max(1, min(_MOST, int(s.period / _LEAST_SAMPLES))))])
    u, spread = _harmonics(stretch, samples[: s.time.size], orders, good)
    if np.max(np.abs(u[0]), initial=0.0) <= held and not np.any(u[(orders % 2 == 0) & (orders > 0)]):
        u[0] = 0.0
    order = orders[:, None]
    turned = u[1:] * np.exp(1j * order[1:] * phase)
    fundamental = a * np.exp(1j * phase)
    # a harmonic falls about as many times faster as its order
    rate = order[1:] * (growth + 1j * omega)
    force = (squared + 0j) * fundamental - np.sum((rate**2 + 2 * damping * rate) * turned, axis=0)
    stiffness = force / (fundamental + np.sum(turned, axis=0))
    odd = (orders % 2 == 1)[:, None]
    amplitude = a + np.sum(np.where(odd, np.real(u), 0.0), axis=0)
    restoring = squared * a + np.sum(np.where(odd, (order * omega) ** 2 * np.real(u), 0.0), axis=0)
    counted = odd & np.any(u != 0, axis=1, keepdims=True)
    of_curve = stretch.point_variance(*by_sample, 0.0)[good] * a**2
    of_harmonics = np.sum(np.where(counted, (order * omega) ** 4, 0.0), axis=0) * spread**2
    peaks, halves = _half_waves(a, omega, u, orders)
    return WithinTheCycle(
        orders=tuple(map(int, orders)),
        harmonics=u,
        harmonics_std=spread,
        omega0=np.sqrt(np.where(stiffness.real > 0, stiffness.real, np.nan)),
        hysteresis=stiffness.imag,
        amplitude=amplitude,
        restoring=restoring,
        restoring_std=np.sqrt(of_curve + of_harmonics),
        peaks=peaks,
        omega=halves,
    )


def _harmonics(
    stretch: Stretch, samples: np.ndarray, orders: np.ndarray, good: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """u_n (orders, n) where asked, zero where noise may be all, and the standard error of a part of them (n,)."""
    from scipy.special import gammaincinv

    s, keep = stretch.signal, stretch.keep
    kernel, envelope = blackman(s.kernel)[0], stretch.smooth_amplitude
    amplitude, phase = stretch.amplitude.copy(), s.phase.copy()
    amplitude[keep], phase[keep] = stretch.smooth_motion
    # without the fundamental, of which some would pass where the frequency is not the one that the kernel was made for;
    # over the envelope: what is left changes so slowly that the kernels bend it little
    beside = samples - amplitude * np.cos(phase)
    # what the sensor shows at zero does not fall with the envelope: over it, it would be bent where that falls fast
    rest = (beside - float(np.median(beside[keep][good]))) / envelope
    passed = convolved(rest * np.exp(-1j * np.outer(orders, s.carrier)), kernel)
    u = stretch.low_pass(passed)[:, good] * envelope[keep][good]
    u *= np.exp(-1j * np.outer(orders, (phase - s.carrier)[keep][good])) * np.where(orders == 0, 1.0, 2.0)[:, None]
    a = amplitude[keep][good]
    both = np.convolve(kernel, stretch.low_pass_kernel)
    spread = np.full(a.size, stretch.noise * np.sqrt(2 * np.sum(both**2)))
    u[0] = _over_rest(u[0].real, a)
    independent = max(1.0, KERNELS_A_VALUE * a.size / both.size)
    for i, order in enumerate(orders):
        degrees = independent * (1 if order == 0 else 2)
        most = 2 * gammaincinv(degrees / 2, 1 - BY_CHANCE) / degrees
        size = np.mean(np.abs(u[i]) ** 2) / (1 if order == 0 else 2)
        if size < most * float(np.mean(spread**2)):
            u[i] = 0.0
    return u, spread


def _over_rest(centre: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
    """The centre (n,) of the motion less that at no amplitude, which is the sensor's zero and not the rig's."""
    basis = np.stack([np.ones_like(amplitude), amplitude, amplitude**2]) / amplitude.max() ** np.arange(3)[:, None]
    return centre - np.linalg.lstsq(basis.T, centre, rcond=None)[0][0]


def _half_waves(a: np.ndarray, omega: np.ndarray, u: np.ndarray, orders: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Peaks (2, n) and frequencies (2, n), rad/s, of the motion above and below rest."""
    angle = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
    waves = np.exp(1j * np.outer(orders, angle))
    peaks, share = np.empty((2, a.size)), np.empty(a.size)
    for start in range(0, a.size, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        x = a[part, None] * np.cos(angle) + np.real(u[:, part].T @ waves)
        peaks[:, part] = x.max(axis=1), -x.min(axis=1)
        after = np.roll(x, -1, axis=1)
        # of each step the part above zero: a straight line between its two ends
        low, high = np.minimum(x, after), np.maximum(x, after)
        share[part] = np.mean(np.clip(high / np.where(high > low, high - low, 1.0), 0.0, 1.0), axis=1)
    share = np.clip(share, 1 / _ANGLES, 1 - 1 / _ANGLES)
    return peaks, omega / 2 / np.stack([share, 1 - share])
