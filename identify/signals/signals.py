"""The two signals of a recording, each with what is measured of it: noise, largest line, band."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ...errors import BadInput
from ...files.computed_once import computed_once
from ...recording.fact import fact
from ...recording.recording import Recording
from ...recording.resolution import converter_step
from ...recording.smoothing import fewer
from .hilbert import LONG, STEP_NOISE, dominant_frequency, noise_level
from .limits import SILENT
from .noise_beside_edges import noise_beside_edges
from .odds import ABOVE_NOISE, DECISIVE, HALF_AGAIN, SIGNIFICANT
from .registry import numerics
from .unexplained import unexplained


def _unbounded() -> float:
    return np.inf


@dataclass(frozen=True, eq=False)
class Signal:
    """Samples (n,) at `fs` Hz; what is measured of them is measured when first asked for, and once.

    ``most`` says how much noise it can hold at most, as far as another signal explains it: see ``unexplained``.
    """

    samples: np.ndarray
    fs: float
    most: Callable[[], float] = _unbounded
    _parts: dict[tuple[int, int], Signal] = field(default_factory=dict, init=False, repr=False)

    @property
    def n(self) -> int:
        """Number of samples."""
        return self.samples.size

    @computed_once
    def noise(self) -> float:
        """Standard deviation of its white noise: see ``noise_level``, and ``noise_beside_edges``.

        A force in steps leaps, and with it an acceleration; so do both at a release, and a velocity at a blow. Of a few
        dozen samples a spectrum tells nothing: zero. And no more than another signal leaves unexplained: a random
        command has power at every frequency, as has the acceleration under it.
        """
        if not self.hides_its_noise:
            return self._noise_alone
        return max(self.most(), converter_step(self.samples) / STEP_NOISE)

    @computed_once
    def hides_its_noise(self) -> bool:
        """Whether it shows signal where noise is measured; the least of several estimates is low by chance."""
        return self._noise_alone > HALF_AGAIN * self.most()

    @computed_once
    def _noise_alone(self) -> float:
        shown, least = noise_level(self.samples, self.fs), noise_beside_edges(self.samples)
        if 0.0 < shown <= ABOVE_NOISE * least or not np.isfinite(least):
            return shown
        return max(least, converter_step(self.samples) / STEP_NOISE)

    @computed_once
    def frequency(self) -> float:
        """Its largest line, Hz; raises BadInput where it does not oscillate: see ``dominant_frequency``."""
        return dominant_frequency(self.samples, self.fs)

    @computed_once
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency in Hz of what has power in it: see ``excited_band``."""
        return excited_band(self.samples, self.fs, 0.0 if self.is_silent else self.noise)

    @computed_once
    def is_silent(self) -> bool:
        """Whether it holds nothing but an offset and white noise, in which no sample stands alone as a blow does."""
        if np.ptp(self.samples) == 0:  # of an offset the standard deviation is rounding
            return True
        spread = float(np.std(self.samples))
        if float(np.max(np.abs(self.samples - np.median(self.samples)))) > spread * np.sqrt(
            2.0 * (np.log(self.n) + DECISIVE)  # Gaussian tails: of n samples none is beyond but once in a thousand
        ):
            return False
        return bool(self.noise > SILENT * spread)

    def thinned(self, factor: int) -> Signal:
        """Every so manieth sample: see ``thinned``."""
        thin = Signal(thinned(self.samples, factor), self.fs / factor)
        # as measured where all samples are: near its highest frequency the thinned one has lost some of its noise
        known = {name: self.__dict__[name] for name in ("band", "frequency", "is_silent") if name in self.__dict__}
        thin.__dict__.update(known, noise=self.noise / np.sqrt(factor))
        return thin

    def part(self, start: int, stop: int) -> Signal:
        """The samples from `start` to `stop`, the same ones the same signal."""
        if (start, stop) == (0, self.n):
            return self
        if (start, stop) not in self._parts:
            self._parts[start, stop] = Signal(self.samples[start:stop], self.fs, self.most)
        return self._parts[start, stop]


def thinned(samples: np.ndarray, factor: int) -> np.ndarray:
    """Every so manieth of (n,) samples, without what these would not tell; what counts must lie well below that."""
    middle = float(np.mean(samples))
    return fewer(samples - middle, factor) + middle


@fact("response", "force", "fs")
def response_of(recording: Recording) -> Signal:
    """The recorded response."""
    return Signal(np.asarray(recording.response, float), recording.fs, partial(_of_response, recording))


@fact("force", "fs")  # which has the noise that it was recorded with, whatever is made of the response
def drive_of(recording: Recording) -> Signal | None:
    """The recorded force, None without one."""
    if recording.force is None:
        return None
    return Signal(np.asarray(recording.force, float), recording.fs, partial(_of_force, recording))


def _of_response(recording: Recording) -> float:
    return unexplained(recording).response


def _of_force(recording: Recording) -> float:
    return unexplained(recording).force


def noise_levels(recording: Recording) -> tuple[float, float]:
    """Standard deviations of the white noise on response and force, the latter 0 without a force."""
    drive = drive_of(recording)
    if drive is None:
        return response_of(recording).noise, 0.0
    known = recording.force_noise if recording.rides else 0.0
    return response_of(recording).noise, known or drive.noise


def resting(x: np.ndarray, sigma: float, period: int) -> np.ndarray:
    """Where `x` (n,) moves no more than its noise `sigma` over a period: at rest or stuck, where signs mean nothing."""
    period = min(period, x.size)
    kernel = np.ones(period) / period
    mean = np.convolve(x, kernel, mode="same")
    spread = np.convolve((x - mean) ** 2, kernel, mode="same") * x.size / np.convolve(np.ones(x.size), kernel, "same")
    return spread / x.size < (SIGNIFICANT * sigma) ** 2


# The band of frequencies in which a force has power.

_INSIDE = numerics(
    0.99, "part of the power", why="that lies in the excited band; half of the rest is below it, half above"
)
_CREST = numerics(2.0, "times the mean power", why="that a sine has at most")


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
    n = force.size
    power = np.abs(np.fft.rfft((force - np.mean(force)).astype(np.float32 if n >= LONG else float)))
    power **= 2
    if not np.any(power > 0):
        return 0.0, 0.0
    power -= n * noise**2
    held = np.cumsum(power, dtype=float)
    edge = 0.5 * (1 - _INSIDE) * held[-1]
    return float(np.argmax(held >= edge)) * fs / n, float(np.argmax(held >= held[-1] - edge)) * fs / n


def _whole_cycles(force: np.ndarray, fs: float) -> int:
    """Samples in the whole cycles of the largest line; all of them where more would be lost than an end of a sine."""
    try:
        period = fs / dominant_frequency(force, fs)
    except BadInput:
        return force.size
    whole = min(force.size, round(force.size // period * period))
    lost, mean = float(np.sum(force[whole:] ** 2)), float(np.mean(force**2))
    return whole if lost <= _CREST * (force.size - whole) * mean else force.size
