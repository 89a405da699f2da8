"""The spectrum of what a fit leaves over, and whitening by it.

Sensor noise is white; force noise reaches the response through the resonance and is not. Least squares that
takes it for white is too sure of itself by the ratio of the two at resonance. Weighing every frequency by the residual's own
spectrum makes it a maximum-likelihood fit again (Whittle 1953).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class NoiseSpectrum:
    """Variance per sample at each frequency of ``numpy.fft.rfft`` over n samples: for white noise all are sigma²."""

    density: np.ndarray
    n: int

    def whiten(self, signals: np.ndarray) -> np.ndarray:
        """(..., n) signals with every frequency divided by the noise's standard deviation there."""
        from scipy import fft

        spectrum = fft.rfft(signals, axis=-1)
        return np.asarray(fft.irfft(spectrum / np.sqrt(self.density), n=self.n, axis=-1))

    def log_determinant(self) -> float:
        """Logarithm of the noise covariance's determinant."""
        weights = np.full(self.density.size, 2.0)
        weights[0] = 1.0
        if self.n % 2 == 0:
            weights[-1] = 1.0
        return float(np.sum(weights * np.log(self.density)))


def white(residual: np.ndarray) -> NoiseSpectrum:
    """Flat spectrum with the residual's mean square."""
    level = max(float(np.mean(residual**2)), np.finfo(float).tiny)
    return NoiseSpectrum(np.full(residual.size // 2 + 1, level), residual.size)


def estimate(residual: np.ndarray) -> NoiseSpectrum:
    """Smoothed periodogram: running mean over 2 m + 1 lines, m growing slowly with the length of the record.

    Daniell (1946). Each value then stands on some twenty to sixty degrees of freedom.
    """
    from scipy import fft, ndimage

    n = residual.size
    periodogram = np.abs(fft.rfft(residual)) ** 2 / n
    half_width = max(8, round(n**0.3))
    smooth = ndimage.uniform_filter1d(periodogram, 2 * half_width + 1, mode="mirror")
    floor = max(float(np.mean(periodogram)) * 1e-6, np.finfo(float).tiny)
    return NoiseSpectrum(np.maximum(smooth, floor), n)
