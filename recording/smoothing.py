"""Linear filters of a recorded signal: convolution by Fourier transform, polynomials over windows, a window's taps.

``scipy.signal`` has all of these, and takes a quarter of a second of processor to import, for the sake of
``scipy.stats``: as long as it takes to identify a short decay.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

_HALF = 10
_KAISER = 5.0
_HARRIS = (0.35875, 0.48829, 0.14128, 0.01168)


def convolved(signal: np.ndarray, kernel: np.ndarray, mode: Literal["full", "same", "valid"] = "same") -> np.ndarray:
    """Signals (..., n), real or complex, under a real kernel (k,), k <= n; modes as ``numpy.convolve`` has them."""
    from scipy.fft import next_fast_len

    n = signal.shape[-1]
    size = n + kernel.size - 1
    if np.iscomplexobj(signal):
        length = next_fast_len(size)
        whole = np.fft.ifft(np.fft.fft(signal, length) * np.fft.fft(kernel, length))
    else:
        length = next_fast_len(size, real=True)
        whole = np.fft.irfft(np.fft.rfft(signal, length) * np.fft.rfft(kernel, length), length)
    count = {"full": size, "same": n, "valid": n - kernel.size + 1}[mode]
    first = (size - count) // 2
    return whole[..., first : first + count]


def with_polynomials(signal: np.ndarray, span: int, order: int, derivative: int = 0) -> np.ndarray:
    """The signal (n,), or a derivative by its samples, from polynomials over ``span`` samples (Savitzky, Golay 1964).

    In the middle of each window its polynomial is taken, at either end that of the last whole window. ``span`` is odd.
    """
    half, rows = span // 2, weights_of_polynomials(span, order, derivative)
    middle = np.convolve(signal, rows[half, ::-1], mode="valid")
    return np.concatenate([rows[:half] @ signal[:span], middle, rows[half + 1 :] @ signal[-span:]])


def weights_of_polynomials(span: int, order: int, derivative: int = 0) -> np.ndarray:
    """(span, span) weights of a window's samples in what ``with_polynomials`` makes of each place in it."""
    half = span // 2
    place = np.arange(-half, half + 1.0) / max(half, 1)
    fit = np.linalg.pinv(np.vander(place, order + 1, increasing=True))  # samples of a window to coefficients
    slopes = np.polynomial.polynomial.polyder(np.eye(order + 1), derivative, max(half, 1) ** -1.0)
    return np.vander(place, len(slopes), increasing=True) @ slopes @ fit


def harris(size: int, *, periodic: bool = False) -> np.ndarray:
    """(size,) window whose side lobes are 92 dB down (Harris 1978: minimum four-sample Blackman-Harris)."""
    turn = 2 * np.pi * np.arange(size) / (size - (not periodic))
    return np.asarray(sum((-1) ** k * a * np.cos(k * turn) for k, a in enumerate(_HARRIS)))


def fewer(signal: np.ndarray, factor: int) -> np.ndarray:
    """Every so manieth sample of a signal (n,) behind a low-pass of no delay, with zeros beyond its ends.

    A sinc of ten zeros on either side under Kaiser's window, which has unit sum (Oppenheim and Schafer 2010, sec. 7.5).
    """
    if factor == 1:
        return signal.copy()
    half = _HALF * factor
    taps = np.sinc(np.arange(-half, half + 1) / factor) * np.kaiser(2 * half + 1, _KAISER)
    rows = np.pad(taps / np.sum(taps), (0, factor - 1)).reshape(-1, factor)
    count = -(-signal.size // factor)
    padded = np.zeros((count + 2 * _HALF + 1) * factor)
    padded[half : half + signal.size] = signal
    phases = padded.reshape(-1, factor)
    return np.asarray(sum(phases[i : i + count] @ row for i, row in enumerate(rows)))


def analytic_of(signal: np.ndarray) -> np.ndarray:
    """(n,) complex: a signal (n,) without its negative frequencies, its positive ones twice, as one period."""
    lines = np.fft.fft(signal)
    lines[1 : (signal.size + 1) // 2] *= 2.0
    lines[signal.size // 2 + 1 :] = 0.0
    return np.fft.ifft(lines)
