"""How a signal oscillates: its dominant frequency, amplitude, noise, cycles, and whether it decays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .fact import fact
from .recording import Recording
from .smoothing import convolved

NOISE_BAND = 0.8  # of Nyquist: above it a vibration record holds little but noise
SMALLEST = 1e-3  # of the peak: -60 dB, below it no cycle is counted even without noise
LEAST_FALL = 0.10  # relative: a steady tone's amplitude stays within a few percent
LEAST_SWINGS = 5  # what swings fewer times in a record is no oscillation of it
SLOW_PARTS = 3  # a held position, a rest position and a drift
LUCK = 0.01  # chance of calling noise a decay


@dataclass(frozen=True)
class Oscillation:
    """Dominant frequency in Hz, amplitude (half the peak-to-peak range), noise (rms), number of cycles in sight."""

    frequency: float
    amplitude: float
    noise: float
    cycles: float


def oscillation(signal: np.ndarray, fs: float) -> Oscillation:
    """Describe a signal (n,) sampled at `fs` Hz. The noise is the upper fifth of the spectrum, taken as white."""
    centred = without_slow(signal)
    n = len(signal)
    straight = _without_line(centred)
    power = np.abs(np.fft.rfft(straight)) ** 2 / n
    frequency = np.fft.rfftfreq(n, 1 / fs)
    # the Hann window keeps a slow, strong oscillation from leaking into the band of the noise
    tapered = np.abs(np.fft.rfft(straight * np.hanning(n))) ** 2 / (0.375 * n)
    noise = float(np.sqrt(np.median(tapered[int(NOISE_BAND * len(tapered)) :]) / np.log(2)))
    slowest = LEAST_SWINGS if strongest_line(centred) >= LEAST_SWINGS else 1
    strongest = float(frequency[slowest + int(np.argmax(power[slowest:]))])
    threshold = max(4 * noise, SMALLEST * float(np.max(np.abs(centred))))
    side = np.sign(centred[np.abs(centred) > threshold])
    cycles = np.count_nonzero(side[1:] != side[:-1]) / 2
    return Oscillation(strongest, float(np.ptp(signal)) / 2, noise, float(cycles))


@fact("response", "fs")
def oscillation_of(recording: Recording) -> Oscillation:
    """How the response of a recording oscillates."""
    return oscillation(recording.response, recording.fs)


def without_slow(signal: np.ndarray) -> np.ndarray:
    """The signal (n,) about its median or, where what is slower than a fifth of it outweighs the rest, about that.

    A hand that holds the thing aside before it lets go, a rest position that changed, and a drifting sensor are often
    larger than the motion itself. What swings fewer than five times is none; it is taken off by the mean under a window
    of two fifths of the record, where something that swings stands out then.
    """
    centred = signal - np.median(signal)
    if len(signal) < 4 * LEAST_SWINGS:  # too short to tell slow from fast
        return centred
    rest = centred
    for _ in range(SLOW_PARTS):
        if strongest_line(rest) >= LEAST_SWINGS:
            return rest
        rest = rest - _window_mean(rest, len(signal) // LEAST_SWINGS)
        rest = rest - np.median(rest)
    return rest if strongest_line(rest) >= LEAST_SWINGS else centred


def strongest_line(signal: np.ndarray) -> int:
    """How often the strongest line of the signal (n,) swings in it; its ends are tapered a little, for a trend."""
    straight = _without_line(signal)
    return 1 + int(np.argmax(np.abs(np.fft.rfft(straight * np.hanning(len(signal) + 2)[1:-1] ** 0.25)[1:])))


def _without_line(signal: np.ndarray) -> np.ndarray:
    """The signal (n,) about the straight line of least squares through it."""
    place = np.linspace(-1.0, 1.0, len(signal))
    place *= place @ signal / (place @ place)
    return signal - np.mean(signal) - place


def _window_mean(signal: np.ndarray, half: int) -> np.ndarray:
    """Mean of the signal (n,) under a Hann window of 2 half + 1 samples, the ends continued by point reflection."""
    window = np.hanning(2 * half + 3)[1:-1]
    before, after = 2 * signal[0] - signal[half:0:-1], 2 * signal[-1] - signal[-2 : -half - 2 : -1]
    wide = np.concatenate([before, signal, after])
    return convolved(wide, window / window.sum(), "valid")


def is_white(signal: np.ndarray) -> bool:
    """Whether the signal (n,) is uncorrelated noise.

    Neighbouring samples must be uncorrelated (within 4 standard errors) and no spectral line may stand out beyond
    chance (Fisher 1929: of m lines of white noise one exceeds g times the mean with probability m exp(-g)).
    """
    noise = signal - signal.mean()
    power = np.abs(np.fft.rfft(noise)[1:]) ** 2
    flat = power.max() < (np.log(len(power)) - np.log(1e-3)) * power.mean()
    return bool(flat and abs(noise[1:] @ noise[:-1]) < 4 / np.sqrt(len(noise)) * (noise @ noise))


def is_one_decay(signal: np.ndarray, fs: float, frequency: float) -> bool:
    """Whether the signal (n,) is one release: it is loud at once, or after at most 3 cycles, and ends quiet.

    Quiet is a fifth of the loudest cycle (rms), over the last tenth of the record.
    """
    rms = _cycle_rms(signal, fs, frequency)
    loudest = int(np.argmax(rms))
    quiet = 0.2 * rms[loudest]
    sudden = loudest < 3 or rms[loudest - 3 : loudest].min() < quiet
    return bool(sudden and np.median(rms[-max(len(rms) // 10, 1) :]) < quiet)


def _cycle_rms(signal: np.ndarray, fs: float, frequency: float) -> np.ndarray:
    block = min(max(round(fs / frequency), 3), len(signal))
    blocks = len(signal) // block
    return np.std(signal[: blocks * block].reshape(blocks, block), axis=1)
