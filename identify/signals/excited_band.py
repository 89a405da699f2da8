"""The band of frequencies in which a force has power."""

from __future__ import annotations

import numpy as np

from ...errors import BadInput
from .hilbert import dominant_frequency

#: Part of the power that lies in the band; half of the rest is below it, half above.
_INSIDE = 0.99
#: A sine has at most this many times its mean power.
_CREST = 2.0


def excited_band(force: np.ndarray, fs: float, noise: float = 0.0) -> tuple[float, float]:
    """Lowest and highest frequency in Hz of the band that holds 99 % of the power of `force` (n,) at `fs` Hz.

    Every instant of the record counts alike: a window over it would take off both ends of a sweep, and a blow at the
    beginning. What a window is for, a line that leaks into the others because the record ends within a cycle, is
    mended by taking whole cycles of the largest line.

    Args:
        force: samples; where they are constant, the band is (0, 0).
        fs: sampling rate, Hz.
        noise: standard deviation of the sensor's white noise, whose power is none of the force's.
    """
    force = force - np.mean(force)
    force = force[: _whole_cycles(force, fs)]
    power = np.abs(np.fft.rfft(force - np.mean(force))) ** 2
    if not np.any(power > 0):
        return 0.0, 0.0
    held = np.cumsum(power - force.size * noise**2)
    frequency = np.fft.rfftfreq(force.size, 1 / fs)
    edge = 0.5 * (1 - _INSIDE) * held[-1]
    return float(frequency[np.argmax(held >= edge)]), float(frequency[np.argmax(held >= held[-1] - edge)])


def _whole_cycles(force: np.ndarray, fs: float) -> int:
    """Samples in the whole cycles of the largest line; all of them where more would be lost than an end of a sine."""
    try:
        period = fs / dominant_frequency(force, fs)
    except BadInput:
        return force.size
    whole = min(force.size, round(force.size // period * period))
    lost, mean = float(np.sum(force[whole:] ** 2)), float(np.mean(force**2))
    return whole if lost <= _CREST * (force.size - whole) * mean else force.size
