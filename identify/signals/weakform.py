"""Products of a recording with short oscillating windows: the equation of motion without differentiating the data.

Multiplying the equation of motion by `phi(t) = w(t) exp(-i omega t)`, with a window w that vanishes at its ends
together with its first derivatives, and integrating by parts moves every derivative to the known window:

    int phi x'' = int phi'' x,    int phi x' = -int phi' x.

No filter and no end effect enters, and white noise is cut down to the band of the window. It is the low-passed Hilbert
transform (one window at one frequency passes positive frequencies only) in the form that a regression wants
(modulating functions: Shinbrot 1957; complex windows: Pearson and Lee 1985).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .limits import BELOW_NYQUIST
from .registry import budget, numerics

_SHORTEST = numerics(8, "samples", why="the shortest window that has bins")
_LOWEST = numerics(3, "bins", why="below the third an offset and a slow drift of the recording fall out")
_SEEN = numerics(1e-10, "part of the largest singular value", why="a direction that rows do not see at all")

_AT_ONCE = budget(100_000, "samples under windows", why="what a cache of a processor holds")


@dataclass(frozen=True)
class Windows:
    """A family of cos^4 windows: each begins at a sample of `starts`, is `length` samples long, at fs Hz."""

    fs: float
    length: int
    starts: np.ndarray  # (b,)
    omega: np.ndarray  # (k,), rad/s, whole multiples of 2 pi fs / length

    def project(self, y: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Integrals of phi times the `derivative`-th derivative (0, 1 or 2) of `y` (n,): complex, shape (b, k)."""
        u = np.arange(self.length) / self.length
        s, a = np.sin(np.pi * u), np.pi * self.fs / self.length
        w = s**4
        out = self._transform(y, w)
        if derivative == 0:
            return out
        first = self._transform(y, 4 * a * s**3 * np.cos(np.pi * u))
        if derivative == 1:
            return 1j * self.omega * out - first
        second = self._transform(y, 4 * a**2 * (3 * s**2 - 4 * s**4))
        return second - 2j * self.omega * first - self.omega**2 * out

    def mean(self, y: np.ndarray) -> np.ndarray:
        """Mean of `y` (n,) under each window, shape (b,)."""
        w = np.sin(np.pi * np.arange(self.length) / self.length) ** 4
        return np.array([w @ y[i : i + self.length] for i in self.starts]) / w.sum()

    def _transform(self, y: np.ndarray, w: np.ndarray) -> np.ndarray:
        bins = np.rint(self.omega * self.length / (2 * np.pi * self.fs)).astype(int)
        out = np.empty((self.starts.size, bins.size), complex)
        offsets = np.arange(self.length)
        chunk = max(1, _AT_ONCE // self.length)
        for i in range(0, self.starts.size, chunk):
            block = y[self.starts[i : i + chunk, None] + offsets] * w
            out[i : i + chunk] = np.fft.rfft(block, axis=1)[:, bins]
        return out / self.fs

    @property
    def energy(self) -> float:
        """int |phi|^2 dt, s: white noise of variance s^2 gives a product of variance s^2 * energy / fs."""
        return 35.0 / 128.0 * self.length / self.fs

    @property
    def width(self) -> float:
        """Root mean square width of a window's band, rad/s."""
        return 4 / np.sqrt(7.0) * np.pi * self.fs / self.length

    def upsampled(self, factor: int) -> Windows:
        """The same windows on a grid `factor` times as dense."""
        return Windows(self.fs * factor, self.length * factor, self.starts * factor, self.omega)


def windows(n: int, fs: float, seconds: float, low: float, high: float, overlap: int = 4) -> Windows:
    """Windows about `seconds` long over a recording of `n` samples, `overlap` deep, with the bins in `low`..`high` Hz.

    Bins below the third are left out, so that an offset and a slow drift of the recording fall out.
    """
    length = min(n, max(_SHORTEST, round(seconds * fs)))
    hop = max(1, length // overlap)
    starts = np.arange(0, n - length + 1, hop)
    first = max(_LOWEST, int(np.ceil(low * length / fs)))
    last = min(int(BELOW_NYQUIST * length), max(first, int(np.floor(high * length / fs))))
    omega = 2 * np.pi * fs / length * np.arange(min(first, last), last + 1)
    return Windows(fs, length, starts, omega)


@dataclass(frozen=True)
class Solution:
    """Of a weighted linear least-squares problem: values and covariance (p,), (p, p), weighted residual per row."""

    value: np.ndarray
    covariance: np.ndarray
    residual: float


def solve(columns: np.ndarray, target: np.ndarray, std: np.ndarray, independent: float) -> Solution:
    """Least squares of complex rows `columns` (r, p) against `target` (r,), each with standard deviation `std` (r,).

    `independent`: independent rows per row (overlapping windows say the same thing more than once).
    """
    a = columns * (np.sqrt(2) / std[:, None])  # the real and the imaginary part share the variance
    b = target * (np.sqrt(2) / std)
    a = np.concatenate([a.real, a.imag])
    b = np.concatenate([b.real, b.imag])
    scale = np.linalg.norm(a, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    u, s, vt = np.linalg.svd(a / scale, full_matrices=False)
    keep = s > _SEEN * s[0] if s.size else s > 0
    inverse = np.where(keep, 1 / np.where(keep, s, 1.0), 0.0)
    value = (vt.T * inverse) @ (u.T @ b) / scale
    misfit = float(np.sum((b - a @ value) ** 2) / max(1, b.size - value.size))
    # a direction that the rows do not see at all is unknown, not zero with certainty
    spread = np.where(keep, inverse, 1e8 / max(float(s[0]), 1e-300) if s.size else 1e8)
    covariance = (vt.T * spread**2) @ vt / np.outer(scale, scale)
    return Solution(value, covariance * max(misfit, 1e-12) / min(1.0, independent), misfit)
