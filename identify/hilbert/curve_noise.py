"""The noise of low-passed curves, point against point: white in the samples, it is anything but white in a curve.

Instantaneous frequency and damping are derivatives of phase and logarithm of the amplitude, so that their noise grows
with its own frequency: neighbouring points are off to opposite sides, and what all points say of a slow law is far
better than a mean of independent points would be. Least squares weighed by the whole covariance (Aitken 1936) use that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..signals.hilbert import blackman
from .modal_stretch import Stretch

#: Points a cycle: both low-passes together pass nothing faster than the frequency itself.
_A_CYCLE = 2
#: Part of a point's variance that is its own, so that no combination of points passes for free of noise.
_OWN = 1e-3


@dataclass(frozen=True, eq=False)
class CurveNoise:
    """Points (q,) among a stretch's low-passed values, and the Cholesky factor of their covariance, banded."""

    points: np.ndarray
    used: np.ndarray  # (q,) of bool: those that stand clear of the noise
    factor: np.ndarray  # (bands, q), lower

    def weigh(self, values: np.ndarray) -> np.ndarray:
        """The inverse covariance times (..., k) low-passed values, as (..., k): zero but at the points."""
        from scipy.linalg import cho_solve_banded

        out = np.zeros(values.shape)
        given = np.where(self.used, values[..., self.points], 0.0)
        solved = cho_solve_banded((self.factor, True), given.reshape(-1, self.points.size).T).T
        out[..., self.points] = np.where(self.used, solved.reshape(given.shape), 0.0)
        return out

    def whitened(self, values: np.ndarray) -> np.ndarray:
        """Of (k,) low-passed values what each point adds to those before it, (q,), over its own error.

        Noise alone leaves ones, each by itself (less where the kernels pass nothing); zero where no point counts.
        """
        from scipy.linalg import solve_banded

        bands = self.factor.shape[0] - 1
        return np.asarray(solve_banded((bands, 0), self.factor, np.where(self.used, values[self.points], 0.0)))

    @property
    def count(self) -> int:
        """How many points count."""
        return int(np.count_nonzero(self.used))


def curve_noise(
    stretch: Stretch,
    equation: np.ndarray,
    amplitude: np.ndarray,
    squared: np.ndarray,
    damping: np.ndarray,
    inverse_mass: float,
) -> CurveNoise:
    """Covariance of a low-passed value that changes by the real part of `equation` de plus `amplitude` dA/A.

    Args:
        stretch: of n samples.
        equation: (n,), complex; de is the error of the equation of motion over X (``modal_stretch``).
        amplitude: (n,), real.
        squared, damping, inverse_mass: omega0² (n,), h (n,) and 1/m, as ``Stretch.noise_weights`` has them.
    """
    from scipy.linalg import cholesky_banded

    step = max(1, round(stretch.signal.period / _A_CYCLE))
    points = np.arange(0, stretch.clear.size, step)
    used = stretch.clear[points]
    moved, drive = _rows(stretch, points, equation, amplitude, squared, damping, inverse_mass)
    width = moved.shape[1]
    bands = np.zeros((min(1 + (width - 1) // step, points.size), points.size))
    for rows, noise in ((moved, stretch.noise), (drive, stretch.force_noise)):
        if rows is None:
            continue
        rows = np.where(used[:, None], rows, 0.0)
        for apart in range(len(bands)):
            shared = rows[: points.size - apart, apart * step :] * rows[apart:, : width - apart * step]
            bands[apart, : points.size - apart] += noise**2 * np.sum(shared, axis=1)
    bands[0] = np.where(used, (1 + _OWN) * bands[0], 1.0)
    scale = 1 / np.sqrt(bands[0])
    for apart in range(len(bands)):
        bands[apart, : points.size - apart] *= scale[: points.size - apart] * scale[apart:]
    factor = cholesky_banded(bands, lower=True)
    for apart in range(len(factor)):  # row i of the factor back to its own unit
        factor[apart, : points.size - apart] /= scale[apart:]
    return CurveNoise(points, used, factor)


def _rows(
    stretch: Stretch,
    points: np.ndarray,
    equation: np.ndarray,
    amplitude: np.ndarray,
    squared: np.ndarray,
    damping: np.ndarray,
    inverse_mass: float,
) -> tuple[np.ndarray, np.ndarray | None]:
    """How the noise of the samples about each point enters it: (q, samples) of displacement and of force."""
    from scipy.signal import fftconvolve

    s, low = stretch.signal, stretch.low_pass_kernel
    at = stretch.inside.start + points[:, None] + np.arange(low.size)
    first, zeroth = stretch.of_displacement(squared, damping)
    kernels, half = blackman(s.kernel), blackman(s.kernel)[0].size // 2
    samples = stretch.inside.start + points[:, None] - half + np.arange(low.size + 2 * half)
    inside = np.clip(samples, 0, s.time.size - 1)
    back = np.exp(s.undecay * s.time - 1j * s.carrier)[inside] * (samples == inside)

    def spread(weights: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        return np.asarray(fftconvolve(low * (weights / s.slow)[at], kernel[None, ::-1], mode="full", axes=-1))

    fs = stretch.fs
    moved = spread(equation * zeroth + amplitude, kernels[0]) + spread(equation * first, kernels[1]) * fs
    moved = moved + spread(equation, kernels[2]) * fs**2
    if stretch.ratio is None:
        return 2 * np.real(moved * back), None
    return 2 * np.real(moved * back), 2 * np.real(spread(-inverse_mass * equation, kernels[0]) * back)
