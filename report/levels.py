"""At which levels a rig was driven by a sine: what Eq. 14 needs to draw a resonance curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..recording.recording import Recording

#: A sine swept or burst has a steady envelope; that of noise or a multisine scatters by half its mean.
_STEADY = 0.2
_ON = 0.3
#: Levels closer together than this are drawn as one.
_SAME = 0.1


def sine_level(recording: Recording) -> float | None:
    """Amplitude of a force that is a sine (swept, or in bursts), in its unit; None for any other."""
    if recording.force is None or not np.ptp(recording.force) > 0:
        return None
    force = np.asarray(recording.force, float)
    size = np.abs(_analytic(force - np.mean(force)))
    on = size[size > _ON * np.quantile(size, 0.99)]
    if on.size < 8 or np.std(on) > _STEADY * np.mean(on):
        return None
    return float(np.median(on))


def sine_levels(recordings: Sequence[Recording]) -> tuple[float, ...]:
    """Different levels among the recordings, rising."""
    levels: list[float] = []
    for level in sorted(level for r in recordings if (level := sine_level(r)) is not None):
        if not levels or level > (1 + _SAME) * levels[-1]:
            levels.append(level)
    return tuple(levels)


def _analytic(signal: np.ndarray) -> np.ndarray:
    spectrum = np.fft.fft(signal)
    n = signal.size
    gain = np.zeros(n)
    gain[0] = 1.0
    gain[1 : (n + 1) // 2] = 2.0
    if n % 2 == 0:
        gain[n // 2] = 1.0
    return np.fft.ifft(spectrum * gain)
