"""What kind of excitation a recording holds, and which band it covers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...recording.recording import Recording
from ..signals.odds import BY_CHANCE
from ..signals.registry import numerics
from ..signals.signals import drive_of
from .decays import Decay
from .limits import NARROW

_WINDOWS = numerics(24, "windows a recording", why="in each of which a force has one frequency, or many")
_LEAST = numerics(16, "samples", why="of a window")
_SILENT = numerics(1e-2, "of the power of a window and its neighbours", why="less is what they leave in a pause")


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
    size = max(recording.n // _WINDOWS, _LEAST)
    centres, narrow = [], 0
    for start in range(0, recording.n - size + 1, size):
        line = _line(np.asarray(force[max(0, start - size) : start + 2 * size], float), min(start, size), size, noise)
        if line is not None:
            centres.append(line[0] * recording.fs)
            narrow += line[1] < NARROW * line[0]
    if not centres or narrow < (1 - NARROW) * len(centres):
        return "broadband"
    return "sweep" if max(centres) > (1 + NARROW) * min(centres) else "sine"


def _line(force: np.ndarray, start: int, size: int, noise: float) -> tuple[float, float] | None:
    """Mean and spread of the frequency, cycles a sample, of `size` samples of a force (n,) from `start`; None: none.

    From the analytic signal z: the spread is that of z'/(i z), weighed by its power (Cohen 1989). That of a spectrum
    would be as wide as the window is short, and so take a short sweep for many frequencies at once.
    """
    middle = slice(start + size // 4, start + size - size // 4)  # what lies beside it reaches over its edges
    sample = np.arange(force.size)
    beside = np.maximum(
        (middle.start - sample) / max(middle.start, 1), (sample - middle.stop) / (force.size - middle.stop)
    )
    taper = np.cos(0.5 * np.pi * np.clip(beside, 0.0, 1.0)) ** 2
    spectrum = np.fft.fft(taper * (force - np.mean(force)))
    frequency = np.fft.fftfreq(force.size)
    quiet = np.abs(spectrum) ** 2 <= noise**2 * force.size * np.log(force.size / BY_CHANCE)
    spectrum[quiet | (frequency <= 0)] = 0.0  # the power of white noise in a bin is exponentially distributed
    z, turning = (np.fft.ifft(values)[middle] for values in (spectrum, spectrum * frequency))
    power = float(np.sum(np.abs(z) ** 2))
    if not power > _SILENT * float(np.sum(np.abs(spectrum) ** 2)) / force.size:
        return None
    centre = float(np.sum(np.real(np.conj(z) * turning))) / power
    return centre, float(np.sqrt(np.sum(np.abs(turning - centre * z) ** 2) / power))
