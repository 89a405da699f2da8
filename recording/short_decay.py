"""Whether a few swings are enough: a damped sine fitted to them, and what its standard errors say.

Not the number of cycles tells whether a decay can be identified but what is known of its frequency and of its fall; of
a damped sine of N cycles in white noise both errors fall with noise / amplitude and with the root of the samples (Kay
1993, example 3.14). Three turning points are the least: from two of them an offset of the sensor cannot be
distinguished from a loss.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .oscillation import LEAST_FALL, LUCK

#: Swings back and forth within a record that the fit looks at; what swings more often is found otherwise.
MOST_CYCLES = 6.0
#: Three turning points.
LEAST_CYCLES = 1.5
#: A frequency is known from a tenth on, and one motion is one damped sine but for this part of it: what is left is
#: then of its size and phase.
_KNOWN, _ONE_MOTION = 0.1, 0.3
#: Steady tones stay within ``LEAST_FALL`` over so many cycles; of fewer, a fall at that rate is asked.
_FALL_CYCLES = 5.0
#: A sine is told by so many samples a cycle.
_SAMPLES = 64.0
#: Frequencies in cycles a record, and falls from its beginning to its end (natural logarithm), where the fit starts.
_CYCLES = np.arange(LEAST_CYCLES, MOST_CYCLES, 0.25)
_FALLS = (0.05, 0.5, 2.0, 5.0)


@dataclass(frozen=True)
class DampedSine:
    """A damped sine about a constant, with standard errors.

    Attributes:
        frequency, frequency_std: Hz.
        rate, rate_std: of its fall, 1/s.
        nrmse: rms of what it leaves over the signal's standard deviation.
        duration: of the record, s.
    """

    frequency: float
    frequency_std: float
    rate: float
    rate_std: float
    nrmse: float
    duration: float

    @property
    def cycles(self) -> float:
        """In the record."""
        return self.frequency * self.duration

    @property
    def decays(self) -> bool:
        """Whether frequency and fall are known: neither noise nor a steady tone shows so much by chance."""
        from scipy.special import ndtri

        least = -np.log(1.0 - LEAST_FALL) * min(self.cycles / _FALL_CYCLES, 1.0)
        return bool(
            self.cycles >= LEAST_CYCLES
            and self.nrmse < _ONE_MOTION
            and self.frequency_std < _KNOWN * self.frequency
            and self.rate * self.duration > least
            and self.rate > -float(ndtri(LUCK)) * self.rate_std
        )


def is_short_decay(signal: np.ndarray, fs: float) -> bool:
    """Whether a signal (n,) at `fs` Hz is a free decay of few swings, as far as its errors tell."""
    sine = damped_sine(np.asarray(signal, float), fs)
    return sine is not None and sine.decays


def damped_sine(signal: np.ndarray, fs: float) -> DampedSine | None:
    """Fit a damped sine of few cycles to a signal (n,) sampled at `fs` Hz; None where there are fewer than 16 samples.

    Its errors count what is left as noise with the level that it has at the frequencies of the motion.
    """
    from scipy.optimize import least_squares

    n, spread = signal.size, float(np.std(signal))
    width = max(1, int(n / (_SAMPLES * MOST_CYCLES)))
    count = n // width
    if count < 16 or not spread > 0.0:
        return None
    means = (signal[: count * width] - np.mean(signal)).reshape(count, width).mean(axis=1) / spread
    time = (np.arange(count) + 0.5) / count  # in parts of the record

    def columns(cycles: float, fall: float) -> np.ndarray:
        envelope = np.exp(-fall * time)
        turn = 2.0 * np.pi * cycles * time
        return np.column_stack([envelope * np.cos(turn), envelope * np.sin(turn), np.ones(count)])

    def remainder(theta: np.ndarray) -> np.ndarray:
        made = columns(*theta)
        return made @ np.linalg.lstsq(made, means)[0] - means

    starts = [np.array([cycles, fall]) for cycles in _CYCLES for fall in _FALLS]
    begin = min(starts, key=lambda theta: float(np.sum(remainder(theta) ** 2)))
    bounds = ([0.5 * LEAST_CYCLES, -5.0], [2.0 * MOST_CYCLES, 50.0])
    cycles, fall = least_squares(remainder, begin, bounds=bounds).x
    made = columns(cycles, fall)
    weights = np.linalg.lstsq(made, means)[0]
    residual = means - made @ weights
    power = np.abs(np.fft.rfft(residual))[1 : int(np.ceil(3.0 * MOST_CYCLES)) + 1] ** 2 / count
    level = max(float(np.mean(power)), float(np.mean(residual**2)) / width)  # of the means; no less than white noise's
    moved = 1e-6
    slopes = [
        (columns(cycles + moved, fall) - made) @ weights / moved,
        (columns(cycles, fall + moved) - made) @ weights / moved,
    ]
    jacobian = np.column_stack([*slopes, made])
    spreads = np.sqrt(np.diag(np.linalg.pinv(jacobian.T @ jacobian)) * level)
    duration = count * width / fs
    rest = float(np.sqrt(np.mean(residual**2)))
    return DampedSine(
        float(cycles) / duration,
        float(spreads[0]) / duration,
        float(fall) / duration,
        float(spreads[1]) / duration,
        rest,
        duration,
    )
