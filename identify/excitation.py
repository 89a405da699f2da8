"""What kind of excitation a recording holds, and which band it covers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..recording.recording import Recording
from .decays import Decay
from .signals import drive_of

_WINDOWS = 24
#: A line counts where white noise would make one as large anywhere in a window with this chance.
_CHANCE = 1 / 400


def band_of(recording: Recording) -> tuple[float, float] | None:
    """Band in which the force has power, Hz: see ``excited_band``; None without a force."""
    drive = drive_of(recording)
    return drive.band if drive is not None and np.any(drive.samples) else None


def kind_of(recording: Recording, decays: Sequence[Decay], noise: float = 0.0) -> str:
    """``decay``, ``bursts``, ``sine``, ``sweep`` or ``broadband``, from the signals alone.

    Args:
        recording: with the force.
        decays: in it.
        noise: standard deviation of white noise on the force that is not to count: spread over all frequencies, a per
            cent of it makes a sine look broad.
    """
    force = recording.force
    if force is None or not np.any(force):
        return "decay"
    if decays:
        return "bursts"
    size = max(recording.n // _WINDOWS, 16)
    centres, narrow = [], 0
    for start in range(0, recording.n - size + 1, size):
        piece = np.asarray(force[start : start + size])
        window = np.hanning(size)
        power = np.abs(np.fft.rfft((piece - piece.mean()) * window)) ** 2
        if noise:  # the power of white noise in a bin is exponentially distributed
            power[power < noise**2 * np.sum(window**2) * np.log(power.size / _CHANCE)] = 0.0
        if not np.any(power):
            continue
        frequency = np.fft.rfftfreq(size, recording.dt)
        centre = float(np.sum(frequency * power) / np.sum(power))
        width = float(np.sqrt(np.sum((frequency - centre) ** 2 * power) / np.sum(power)))
        centres.append(centre)
        narrow += width < 0.15 * centre
    if not centres or narrow < 0.8 * len(centres):
        return "broadband"
    return "sweep" if max(centres) > 1.2 * min(centres) else "sine"
