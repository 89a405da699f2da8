"""The spectrum of what a fit leaves over, and whitening by it.

Sensor noise is white; force noise reaches the response through the resonance and is not. Least squares that
takes it for white is too sure of itself by the ratio of the two at resonance. Weighing every frequency by the
residual's own spectrum makes it a maximum-likelihood fit again (Whittle 1953).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...files.computed_once import computed_once
from .odds import DECISIVE
from .registry import numerics

_FLOOR = numerics(1e-9, "part of the mean power", why="what a spectrum has at least, so that its inverse is a number")
_SMOOTHED = numerics(8, "lines on either side", why="over which a spectrum is smoothed at least")
_TURN = numerics(
    (0.3, 10.0), "times its value", why="by how much a part may change in a step, so that it stays positive"
)
_SETTLED = numerics(1e-3, "part of its value", why="a step below which both parts are settled")
_HALF_A_LINE = numerics(0.5, "lines", why="what has less than one degree of freedom left says nothing of the noise")


@dataclass(frozen=True, eq=False)
class NoiseSpectrum:
    """Variance per sample at each frequency of ``numpy.fft.rfft`` over n samples: for white noise all are sigma².

    ``force_share`` is the part of it (0 to 1) that noise on the force causes.
    """

    density: np.ndarray
    n: int
    force_share: np.ndarray | float = 0.0

    def whiten(self, signals: np.ndarray) -> np.ndarray:
        """(..., n) signals with every frequency divided by the noise's standard deviation there."""
        if self._flat:
            return signals / np.sqrt(self.density[0])
        return self._filter(signals, 1.0 / np.sqrt(self.density))

    def lines(self, signals: np.ndarray, *, overwrite: bool = False) -> np.ndarray:
        """(..., n) the whitened signals' inner products and no more: their Fourier lines as real numbers (Parseval).

        Half the work of ``whiten``, none where the spectrum is flat; with ``overwrite`` in the signals' own place.
        """
        made = signals if overwrite else np.array(signals, float)
        if self._flat:
            made /= np.sqrt(self.density[0])
            return made
        from scipy import fftpack

        made = np.asarray(fftpack.rfft(made, axis=-1, overwrite_x=True))
        return self._scaled(made, self._weights)

    def whitened_twice(self, lines: np.ndarray) -> np.ndarray:
        """(..., n) signals of given ``lines``, whitened once more: what a residual's inner product with these is."""
        if self._flat:
            return lines / np.sqrt(self.density[0])
        from scipy import fftpack

        # back through the weights of ``lines``, once more through the noise's standard deviation
        made = self._scaled(lines.copy(), 1.0 / np.sqrt(self._counted / self.n * self.density))
        return np.asarray(fftpack.irfft(made, axis=-1, overwrite_x=True))

    def of_sensor(self, lines: np.ndarray) -> np.ndarray:
        """(..., n) lines times the share of the noise at each that is not due to force noise."""
        share = 1.0 - self.force_share + np.zeros_like(self.density)
        return lines * share[0] if self._flat else self._scaled(lines.copy(), share)

    def widened(self, taken: np.ndarray) -> np.ndarray:
        """(n,) factors at each of the ``lines``: mean of squared weights, times the noise's variance, over weights.

        The weights are one over what is left, smoothed over few lines. A fit takes noise for motion where it has
        freedom, at the lines about the resonance: what is left is less by the diagonal of the hat matrix there (Hoaglin
        and Welsch 1978). And a mean of m exponential variables scatters: that of one over its square is m² / ((m - 1)
        (m - 2)), so that lines that happen to be quiet, and are believed for it, make errors larger than they say. Of a
        flat spectrum neither is to be seen.

        Args:
            taken: (n,) diagonal of the hat matrix, over the lines.
        """
        from scipy import ndimage

        if self._flat:
            return np.ones(self.n)
        even, width = self.n % 2 == 0, 2 * smoothing(self.n) + 1
        inner = taken[1 : self.n - even].reshape(-1, 2).mean(axis=1)
        by_line = np.concatenate([taken[:1], inner, taken[self.n - even :]])
        left = width * (1.0 - ndimage.uniform_filter1d(by_line, width, mode="mirror"))
        # what has less than one degree of freedom, half a line, left says nothing of the noise
        return self._scaled(np.ones(self.n), width / np.maximum(left - 2.0, _HALF_A_LINE))

    def _scaled(self, lines: np.ndarray, factors: np.ndarray) -> np.ndarray:
        """Lines (..., n), in their place, each times its factor (n // 2 + 1,): real part and imaginary part alike."""
        even = self.n % 2 == 0
        lines[..., 0] *= factors[0]
        inner = lines[..., 1 : self.n - even]
        inner.reshape(*inner.shape[:-1], -1, 2)[...] *= factors[1 : factors.size - even, None]
        if even:
            lines[..., -1] *= factors[-1]
        return lines

    @computed_once
    def _weights(self) -> np.ndarray:
        return np.sqrt(self._counted / (self.n * self.density))

    @computed_once
    def _flat(self) -> bool:
        return bool(np.all(self.density == self.density[0]))

    @property
    def _counted(self) -> np.ndarray:
        """How often each line counts: with its mirror image, where it has one."""
        weights = np.full(self.density.size, 2.0)
        weights[0] = 1.0
        if self.n % 2 == 0:
            weights[-1] = 1.0
        return weights

    def colour(self, signals: np.ndarray) -> np.ndarray:
        """(..., n) signals with every frequency multiplied by the noise's standard deviation there."""
        return self._filter(signals, np.sqrt(self.density))

    def _filter(self, signals: np.ndarray, gain: np.ndarray) -> np.ndarray:
        from scipy import fft

        spectrum = np.asarray(fft.rfft(signals, axis=-1))
        return np.asarray(fft.irfft(spectrum * gain, n=self.n, axis=-1))

    def log_determinant(self) -> float:
        """Logarithm of the noise covariance's determinant."""
        return float(np.sum(self._counted * np.log(self.density)))


def concentrated_likelihood(spectra: Iterable[NoiseSpectrum]) -> float:
    """Log-likelihood of residuals whose noise has the spectra that they show (Whittle 1953), but for a constant.

    Each residual, whitened by its own spectrum, has the same mean square whatever it is: the determinants alone decide.
    """
    return -0.5 * sum(spectrum.log_determinant() for spectrum in spectra)


def white(residual: np.ndarray) -> NoiseSpectrum:
    """Flat spectrum with the residual's mean square."""
    level = max(float(np.mean(residual**2)), np.finfo(float).tiny)
    return NoiseSpectrum(np.full(residual.size // 2 + 1, level), residual.size)


def estimate(residual: np.ndarray, resonance: np.ndarray | None = None, there: float = 1.0) -> NoiseSpectrum:
    """Spectrum of a fit's residual.

    First ``a + b resonance`` by maximum likelihood: sensor noise, and force noise as the rig passes it on. Then the
    periodogram over that, smoothed, corrects what neither explains. A periodogram smoothed alone would flatten the
    resonance of a short record, whose lines lie as far apart as the resonance is wide (prewhitening: Daniell 1946,
    Blackman and Tukey 1958).

    Args:
        residual: (n,) measured minus simulated.
        resonance: (n // 2 + 1,) squared magnitude of the rig's frequency response; None for a free decay.
        there: share of the samples that were measured; the residual is zero at the others.
    """
    from scipy import fft, ndimage

    n = residual.size
    periodogram = np.abs(np.asarray(fft.rfft(residual))) ** 2 / (n * there)
    floor = max(float(np.mean(periodogram)) * _FLOOR, np.finfo(float).tiny)
    shape, share = np.full(periodogram.size, max(float(np.mean(periodogram)), floor)), 0.0
    if resonance is not None:
        sensor, force = two_sources(periodogram, resonance)
        shape, share = np.maximum(sensor + force, floor), force / np.maximum(sensor + force, floor)
    correction = ndimage.uniform_filter1d(periodogram / shape, 2 * smoothing(n) + 1, mode="mirror")
    return NoiseSpectrum(np.maximum(shape * correction, floor), n, share)


def smoothing(n: int) -> int:
    """To how many lines on either side the spectrum of n samples is smoothed."""
    return max(_SMOOTHED, round(n**0.3))


def two_sources(periodogram: np.ndarray, resonance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """``a`` and ``b resonance`` whose sum makes the periodogram most likely; a and b stay positive.

    Minimises sum(log S + I / S) by Fisher scoring; where that would leave the positive values, by halving.
    """
    parts = np.stack([np.ones_like(resonance), resonance / max(float(np.max(resonance)), np.finfo(float).tiny)])
    level = float(np.median(periodogram)) / np.log(2) or float(np.mean(periodogram))
    weights = np.array([level, level])
    for _ in range(40):
        inverse = 1.0 / (weights @ parts)
        weighed = parts * inverse
        step = np.linalg.lstsq(weighed @ weighed.T, weighed @ (periodogram * inverse - 1.0))[0]
        after = np.clip(weights + step, _TURN[0] * weights, _TURN[1] * weights)
        settled = np.all(np.abs(after - weights) < _SETTLED * weights)
        weights = after
        if settled:
            break
    return weights[0] * parts[0], weights[1] * parts[1]


def force_noise_left(residual: np.ndarray, resonance: np.ndarray, level: float, there: float = 1.0) -> float:
    """Standard deviation of the noise on a force: as that shows it, or as a residual does that leaves no room for it.

    What a force shows near its highest frequency is noise only where it holds no signal, which a random command does.

    Args:
        residual: (n,) measured minus simulated.
        resonance: (n // 2 + 1,) squared magnitude of the rig's frequency response to the force.
        level: standard deviation of the noise that the force shows.
        there: share of the samples that were measured.
    """
    from scipy import fft, optimize

    periodogram = np.abs(np.asarray(fft.rfft(residual))) ** 2 / (residual.size * there)
    sensor, force = two_sources(periodogram, resonance)
    passed = level**2 * resonance
    if not np.sum(force) < np.sum(passed):
        return level

    def misfit(density: np.ndarray) -> float:
        return float(np.sum(np.log(density) + periodogram / density))

    least = np.log(np.finfo(float).tiny ** 0.5 + np.min(sensor))
    most = np.log(np.finfo(float).tiny ** 0.5 + np.mean(periodogram))
    beside = optimize.minimize_scalar(
        lambda log: misfit(np.exp(log) + passed), bounds=(min(least, most) - 10.0, most + 1.0), method="bounded"
    )
    if beside.fun - misfit(sensor + force) <= DECISIVE:
        return level
    return float(np.sqrt(np.sum(force) / np.sum(resonance)))


def resonance_of(omega: np.ndarray, omega0_squared: float, damping: float) -> np.ndarray:
    """Squared magnitude of a linear oscillator's response to a force per unit mass, at angular frequencies ``omega``.

    Args:
        omega: rad/s.
        omega0_squared: equivalent stiffness, rad²/s².
        damping: equivalent damping (2 h), 1/s.
    """
    with np.errstate(over="ignore"):  # a search that ran away: no response at all
        return 1.0 / ((omega0_squared - omega**2) ** 2 + (damping * omega) ** 2)
