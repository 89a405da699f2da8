"""How large a recording's motion is at each sample, how fast it swings, and how loud its noise is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...errors import BadInput
from ...recording.oscillation import strongest_line, without_slow
from ...recording.smoothing import convolved
from ..signals.hilbert import blackman, dominant_frequency
from ..signals.limits import FEWEST_CYCLES, ROUNDING, WINDOW_CYCLES
from ..signals.odds import HALF_AGAIN
from ..signals.signals import response_of
from .limits import FALLS

if TYPE_CHECKING:
    from ...recording.recording import Recording


@dataclass(frozen=True, eq=False)
class Envelope:
    """Motion of one recording, by sample.

    Attributes:
        size: (n,) amplitude, unit of the recording; an offset or slow drift does not count.
        period: samples a cycle, where the motion is strongest.
        floor: the level at which a decay ends, twice the envelope of the noise.
        noise: standard deviation of the white noise.
    """

    size: np.ndarray
    period: int
    floor: float
    noise: float


def envelope_of(recording: Recording, period: float | None = None) -> Envelope | None:
    """The envelope of a recording; None where it holds no five cycles of any motion, or too few samples a cycle.

    ``period``: samples a cycle; that of the strongest motion where None.
    """
    response = response_of(recording)
    x, fs, noise = response.samples, response.fs, response.noise
    if period is None:
        frequency = motion_frequency(x, fs)
        if frequency is None:
            return None
        period = fs / frequency
    period = max(2, round(period))
    if x.size < FEWEST_CYCLES * period or period < FEWEST_CYCLES:
        return None
    size = _size(x, period)
    return Envelope(size, period, 2 * _floor(noise, size, period), noise)


def motion_frequency(x: np.ndarray, fs: float) -> float | None:
    """Frequency in Hz of the strongest motion of (n,) samples; None where nothing moves.

    A sensor's offset, a rest position that changed and a drift are stronger than many a motion; they are left out.
    """
    swinging = without_slow(x)
    try:
        frequency = dominant_frequency(swinging, fs)
    except BadInput:
        return None
    if frequency * x.size / fs < FEWEST_CYCLES:  # its ends, where something was held, tilt the whole record
        return strongest_line(swinging) * fs / x.size
    return frequency


def smooth(signal: np.ndarray, length: int) -> np.ndarray:
    """(n,) signal under a Blackman kernel of `length` samples, its ends mirrored."""
    kernel = np.maximum(blackman(length)[0], 0)
    half = kernel.size // 2
    return convolved(np.pad(signal, half, mode="symmetric"), kernel, "valid")


def _size(x: np.ndarray, period: int) -> np.ndarray:
    """Amplitude (n,) from the local variance under a kernel of two cycles: an offset or slow drift does not count."""
    kernel = np.maximum(blackman(2 * period)[0], 0)
    half = kernel.size // 2
    padded = np.pad(x - np.median(x), half, mode="symmetric")
    mean, square = convolved(np.stack([padded, padded**2]), kernel, "valid")
    return np.sqrt(2 * np.maximum(square - mean**2, 0))


def _floor(noise: float, envelope: np.ndarray, period: int) -> float:
    """Envelope of the noise: of the white noise, or of the recording where it is at rest, whichever is larger."""
    top = float(np.max(envelope))
    white = np.sqrt(2) * noise
    # within a cycle of either end the kernel sees its own mirror image, which may be lower than any motion there is
    low = period + int(np.argmin(envelope[period:-period]))
    level = HALF_AGAIN * float(envelope[low])
    a, b = _run(envelope <= level, low)
    rest = 0.0
    if b - a >= WINDOW_CYCLES * period and b - a < envelope.size:  # what fills the record is its motion
        first, last = np.median(envelope[a : a + 2 * period]), np.median(envelope[b - 2 * period : b])
        if min(first, last) > FALLS * max(first, last):
            rest = float(np.median(envelope[a:b]))
    return max(white, rest, ROUNDING * top)


def _run(mask: np.ndarray, inside: int) -> tuple[int, int]:
    """The run of True in `mask` around the sample `inside`, as a slice."""
    after = np.flatnonzero(~mask[inside:])
    before = np.flatnonzero(~mask[: inside + 1])
    return (int(before[-1]) + 1 if before.size else 0), (inside + int(after[0]) if after.size else mask.size)
