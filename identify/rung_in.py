"""The beginning of a driven stretch, while the rig still rings at its own frequency beside the one it is driven at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .modal_fit import spring_and_friction
from .modal_mass import mass_fit
from .modal_stretch import Stretch

#: Motion is left out where noise would make it miss the laws as far with this chance.
_CHANCE = 1 / 400
_ROUNDS = 4
#: The laws are fitted, and then with the harmonics that they make.
_FITS = 2


def rung_in(stretch: Stretch) -> Stretch:
    """A driven stretch without its beginning, as long as that misses the laws that the rest follows.

    A force that comes on sets the rig ringing: for so long there is no single amplitude. Windows of one independent
    value each are asked, one after the other from the beginning, whether what the laws leave there is noise: of each
    point what it adds to those before it, over its own error, so that a curve that is off by less than its points
    are, but off for long, is seen. Where more than half is off it is not the ringing, and all stays.

    Raises:
        BadInput: as ``modal_fit``.
    """
    from scipy.special import gammaincinv

    kernels = stretch.signal.kernel + stretch.low_pass_kernel.size
    for _ in range(_ROUNDS):
        fits = spring_and_friction([stretch], mass_fit([stretch]), _FITS)
        noise = fits[0].curves[0].noise
        off = fits[0].left()[0] ** 2 + fits[1].left()[0] ** 2
        count = max(1, round(kernels / (noise.points[1] - noise.points[0])))
        first = int(np.searchsorted(noise.points, stretch.rung_in))
        sums = np.array([np.sum(off[a : a + count]) for a in range(first, noise.points.size - count, count)])
        bad = int(np.argmin(np.append(sums, 0.0) > 2 * gammaincinv(count, 1 - _CHANCE)))
        until = stretch.rung_in + bad * count * int(noise.points[1])
        if bad == 0 or until > stretch.clear.size // 2:
            break
        stretch = replace(stretch, rung_in=until)
    return stretch
