"""The beginning of a driven stretch, while the rig still rings at its own frequency beside the one it is driven at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...errors import BadInput
from .modal_fit import spring_and_friction
from .modal_mass import MassFit
from .modal_stretch import Stretch

#: Motion is left out where noise would make it miss the laws as far with this chance.
_CHANCE = 1 / 400
_ROUNDS = 10
#: The laws are fitted, and then with the harmonics that they make.
_FITS = 2


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
            fits = spring_and_friction([left], mass_of(left), _FITS)
        except BadInput:  # no mass, no motion above the noise: the ringing may be why
            fits = None
        if fits is not None:
            noise = fits[0].curves[0].noise
            off = fits[0].left()[0] ** 2 + fits[1].left()[0] ** 2
            step = int(noise.points[1] - noise.points[0])
            count = max(1, round(kernels / step))
            first, window = int(np.searchsorted(noise.points, left.rung_in)), count * step
            sums = np.array([np.sum(off[a : a + count]) for a in range(first, noise.points.size - count, count)])
            bad = window * int(np.argmin(np.append(sums, 0.0) > 2 * gammaincinv(count, 1 - _CHANCE)))
        if bad == 0:
            return left
        # where more than half is off, the ringing may have led the fit itself astray: as far again
        until = left.rung_in + (bad if left.rung_in + bad <= half else max(window, left.rung_in))
        if until > half:
            return stretch
        left = replace(left, rung_in=until)
    return left
