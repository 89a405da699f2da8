"""The end of a decay, where the kernels reach beyond the stop that dry friction makes of it.

Amplitude and phase at an instant lean on the motion for half of both low-passes on either side. A decay that friction
ends within that has another shape there than anywhere before: the values are bent by far more than their noise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import BadInput
from ..signals.registry import budget
from .modal_fit import spring_and_friction
from .modal_mass import MassFit
from .modal_stretch import Stretch

_NO_MASS = MassFit(rows=(np.zeros(0),))
_FITS = budget(2, "fits", why="with the laws, and then with the harmonics that they make: their weights may stay rough")
_ROUNDS = budget(2, "rounds", why="the second without what leans on the stop; it ends where nothing changes")


def before_stop(decay: Stretch) -> Stretch:
    """A decay without the low-passed values that lean on its stop, as long as others are left.

    By Eq. 7 the envelope falls by h A + 2 dry / (pi omega) a second, until spring and preload no longer move the mass;
    what the values near the stop say bends the laws that foretell it, so it is foretold again without them.

    Args:
        decay: as ``decay_stretch`` has it.
    """
    reach = (decay.signal.kernel + decay.low_pass_kernel.size / 2) / decay.fs
    left = decay
    for _ in range(_ROUNDS):
        try:
            spring, friction = spring_and_friction([left], _NO_MASS, _FITS)
        except BadInput:  # nothing stands clear, or this is no oscillator: whoever fits it says so
            return left
        (viscous, dry), amplitude = friction.value, decay.amplitude[decay.keep]
        if not dry > 0:
            return decay
        lasts = time_to_stop(
            amplitude - held(spring.value[0], spring.value[2], dry), decay.signal.omega[decay.keep], viscous, dry
        )
        clear = np.flatnonzero(decay.clear)
        seen = clear[lasts[clear] > reach]
        if not seen.size:
            return decay
        run_out = int(clear[-1] - seen[-1])
        if run_out == left.run_out:
            break
        left = replace(decay, run_out=run_out)
    return left


def held(squared: float, preload: float, dry: float) -> float:
    """How far from its middle dry friction can hold a mass, with omega0² in 1/s², preload and friction in m/s²."""
    return max(0.0, dry - max(0.0, preload)) / squared


def time_to_stop(amplitude: np.ndarray, omega: np.ndarray, viscous: float, dry: float) -> np.ndarray:
    """Seconds (n,) that a decay of these amplitudes and frequencies goes on by Eq. 7, with friction ``dry`` > 0."""
    pure = np.maximum(amplitude, 0.0) * np.pi * np.maximum(omega, 0.0) / (2 * dry)
    h = max(viscous, np.finfo(float).tiny) / 2
    return np.minimum(pure, np.log1p(h * pure) / h)
