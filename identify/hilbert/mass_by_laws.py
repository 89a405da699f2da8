"""FORCEVIB's mass where no two instants show one amplitude: that with which the laws hold.

Below its resonance a rig moves the more the faster it is driven. Each amplitude is then met once, and any mass has some
smooth backbone and damping curve that go with it (``modal_mass``): only laws, Eqs. 1, 6 and 7, tell them apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ..signals.odds import BY_CHANCE, SIGNIFICANT
from ..signals.registry import budget, numerics
from .further_harmonics import further_harmonics
from .modal_fit import EQ17, spring_and_friction
from .modal_mass import MassFit, Slopes, mass_fit, moving, regressed
from .modal_stretch import Stretch

_STILL = numerics(1e-4, "part of the largest", why="slower or smaller motion has no phase to divide by")

_SMOOTHED = numerics(
    1 / 4, "of a stretch", why="over which the columns are smoothed: far more cycles than the noise of a curve lasts"
)
_FITS = budget(3, "fits", why="the harmonics of the laws move the mass, and it them")
_ADVICE = (
    "It meets no amplitude twice, and what it meets hardly tells the mass: drive it through the resonance, or nearer "
    "to it."
)
_ASKED_ALONE = numerics(
    1 / 12,
    "of a stretch",
    why="the same where smooth functions are all there is: less, or nothing is left to tell them by",
)


@dataclass(frozen=True, eq=False)
class DrivenMass:
    """A driven stretch without its ringing, with its mass.

    Attributes:
        stretch: without its ringing.
        mass: of it alone.
        by_laws: whether the laws were needed for it.
        hold: whether they leave noise.
        misfit: mean square of what they leave over that of the noise, of stiffness or damping, whichever is larger.
    """

    stretch: Stretch
    mass: MassFit
    by_laws: bool
    hold: bool
    misfit: float


def driven_mass(whole: Stretch) -> DrivenMass:
    """The mass of a driven stretch by smooth functions, or by the laws where it meets no amplitude twice.

    Raises:
        BadInput: neither way leads to a mass.
    """
    found: list[DrivenMass] = []
    problem: BadInput | None = None
    for way in (mass_beside_harmonics, mass_by_laws):
        try:
            found.append(_found(whole, way))
        except BadInput as p:
            problem = problem or p
        else:
            if found[-1].hold:
                return found[-1]
        if _meets_amplitudes_twice(whole):
            break
    if _meets_amplitudes_twice(whole):
        if problem is not None:
            raise problem
        return found[0]
    # no law says whether the smooth functions took the noise for the mass: how far it may be off without their help
    alone = mass_fit(whole, _ASKED_ALONE)
    if not found or not found[0].mass.inverse > SIGNIFICANT * alone.std:
        raise BadInput(_ADVICE)
    return replace(found[0], mass=replace(found[0].mass, std=max(alone.std, found[0].mass.std)))


def _meets_amplitudes_twice(stretch: Stretch) -> bool:
    """Whether the motion passes a resonance: down to its half-power points on either side of its peak."""
    amplitude = stretch.amplitude[stretch.keep][moving(stretch)]
    peak = int(np.argmax(amplitude))
    valleys = float(np.min(amplitude[: peak + 1])), float(np.min(amplitude[peak:]))
    return float(amplitude[peak]) > np.sqrt(2.0) * max(valleys)


def _found(whole: Stretch, way: Callable[[Stretch], MassFit]) -> DrivenMass:
    stretch = rung_in(whole, way)
    mass = way(stretch)
    if not mass.inverse > SIGNIFICANT * mass.std:
        raise BadInput("The noise of force and motion hides the mass; force it harder, longer or nearer its resonance.")
    fits = spring_and_friction([stretch], mass)  # no positive stiffness: that mass is none
    hold = all(fit.holds for fit in fits)
    return DrivenMass(stretch, mass, way is mass_by_laws, hold, max(fit.misfit for fit in fits))


def mass_beside_harmonics(stretch: Stretch) -> MassFit:
    """1/m by smooth functions of the amplitude, less what the harmonics of the laws do to the force's fundamental.

    How far a harmonic is from the rig's own frequency depends on where the motion is driven: at one amplitude they are
    two stiffnesses below and above the resonance, which no function of the amplitude is, and the mass would take it.

    Raises:
        BadInput: as ``mass_fit``.
    """
    try:
        further = _beside_laws(stretch)[1]
    except BadInput:  # no laws, no harmonics
        further = 0.0
    return mass_fit(stretch, further=further)


def mass_by_laws(stretch: Stretch) -> MassFit:
    """1/m beside Eqs. 1, 6 and 7 in one regression, with the harmonics that these make.

    Raises:
        BadInput: too little motion above the noise, or no positive mass.
    """
    return _beside_laws(stretch)[0]


def _beside_laws(stretch: Stretch) -> tuple[MassFit, np.ndarray]:
    """The mass beside Eqs. 1, 6 and 7, and what their harmonics add to the force over X, (n,), complex, 1/s²."""
    clear, first = moving(stretch), stretch.signal.equation_first
    a = np.maximum(stretch.amplitude, _STILL * float(np.max(stretch.amplitude[stretch.keep][clear])))
    springs = np.stack([np.ones_like(a), 0.75 * a**2, 4 / (np.pi * a)])
    dampers = np.stack([np.ones_like(a), 4 / (np.pi * a * np.abs(first))])
    # noise lasts as long as the kernels: smoothed over less than that, the columns would share it still
    lasts = stretch.signal.kernel + stretch.low_pass_kernel.size
    smoothed, slopes = _SMOOTHED, None
    if _SMOOTHED * np.count_nonzero(clear) < lasts:
        none = np.zeros_like(dampers)
        slopes = Slopes(springs * np.array([[0.0], [2.0], [-1.0]]), none, dampers * np.array([[0.0], [-1.0]]))
        smoothed = 0.0
    mass, value = regressed(stretch, springs, dampers, smoothed=smoothed, slopes=slopes)
    further = np.zeros(first.size, complex)
    for _ in range(_FITS - 1):
        if not value[0] > 0:
            raise BadInput("FORCEVIB finds no positive stiffness: this is not the motion of one oscillator.")
        names = dict(zip(EQ17, [np.sqrt(value[0]), *value[1:]], strict=True))
        stiff, damping = further_harmonics(stretch, names)
        further = stiff + damping * first
        mass, value = regressed(stretch, springs, dampers, further, smoothed, slopes)
    return mass, further


# The beginning of a driven stretch, while the rig still rings at its own frequency beside the one it is driven at.

_ROUNDS = budget(10, "rounds", why="of leaving motion out; it ends where nothing changes")
_FITS_RUNG_IN = budget(2, "fits", why="with the laws, and then with the harmonics that they make")


def rung_in(stretch: Stretch, mass_of: Callable[[Stretch], MassFit]) -> Stretch:
    """A driven stretch without its beginning, as long as that misses the laws that the rest follows.

    A force that comes on sets the rig ringing: for so long there is no single amplitude. Windows of one independent
    value each are asked, one after the other from the beginning, whether what the laws leave there is noise: of each
    point what it adds to those before it, over its own error, so that a curve that is off by less than its points
    are, but off for long, is seen. Where half of it must go and the rest is still off it is not the ringing, and all
    stays.

    Args:
        stretch: driven.
        mass_of: finds the mass of one.
    """
    from scipy.special import gammaincinv

    kernels, half = stretch.signal.kernel + stretch.low_pass_kernel.size, stretch.clear.size // 2
    left, window = stretch, kernels
    for _ in range(_ROUNDS):
        bad = half
        try:
            fits = spring_and_friction([left], mass_of(left), _FITS_RUNG_IN)
        except BadInput:  # no mass, no motion above the noise: the ringing may be why
            fits = None
        if fits is not None:
            noise = fits[0].curves[0].noise
            off = fits[0].left()[0] ** 2 + fits[1].left()[0] ** 2
            step = int(noise.points[1] - noise.points[0])
            count = max(1, round(kernels / step))
            first, window = int(np.searchsorted(noise.points, left.rung_in)), count * step
            sums = np.array([np.sum(off[a : a + count]) for a in range(first, noise.points.size - count, count)])
            bad = window * int(np.argmin(np.append(sums, 0.0) > 2 * gammaincinv(count, 1 - BY_CHANCE)))
        if bad == 0:
            return left
        # where more than half is off, the ringing may have misled the fit itself: as far again
        until = left.rung_in + (bad if left.rung_in + bad <= half else max(window, left.rung_in))
        if until > half:
            return stretch
        left = replace(left, rung_in=until)
    return left
