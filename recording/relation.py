"""Whether the recorded force has anything to do with the recorded response."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LINES = 16  # spectral lines in a local band
ORDER = 3  # coefficients of each local polynomial: constant, slope, curvature
IN_BAND = 1e-3  # of the strongest line: the force's own band reaches down to -30 dB
ABOVE_FLOOR = 30.0  # or to this many times its noise floor
ROUND_OFF = 1e-9  # of the strongest line: below it there is no force, only arithmetic
CHANCE = 0.01  # of calling unrelated signals related; stricter would reject short, noisy but related records
STANDS_OUT = 10.0  # times the noise: 10 dB
ENOUGH = 5  # bands, for a mean of shares to be told from chance
HALF = 0.5
LASTING = 0.05  # of the record: a shorter force looks like an initial condition and is not judged


@dataclass(frozen=True)
class Reach:
    """`coherence`: the mean share of the response that the force explains linearly, over the bands judged.

    `related`: whether the force explains more than an unrelated one would, by chance and by half of what stands out.
    A strongly nonlinear system passes: the frequencies that are driven answer all the same.
    """

    coherence: float
    related: bool


def lasting(force: np.ndarray) -> bool:
    """Whether the force (n,) acts over a fair part of the record; a single blow does not."""
    power = (force - np.median(force)) ** 2
    return bool(np.sum(power) ** 2 > LASTING * len(force) * np.sum(power**2))


def reach(force: np.ndarray, response: np.ndarray) -> Reach | None:
    """Compare force and response, both (n,), by their coherence in the force's own band; None for fewer than
    100 samples or a constant force.

    Local polynomial method (Schoukens, Vandersteen, Barbé, Pintelon 2009): in bands of 16 spectral lines the response
    is fitted by X = H F + T with H and T parabolas in frequency. T takes up free vibration and the ends of the record.
    The share of the rest that H F explains follows Beta(3, 10) when the signals are unrelated and random; Fisher's sum
    of logarithms joins the bands. Smooth signals of separate origin (two sweeps) can share more than that by their
    shape alone, so the force must also explain half of the bands that stand out of the response's noise, on average
    and each counting alike: at a sharp resonance H is no parabola, on its flanks it is.
    """
    from scipy.special import betainc, gammaincc

    if len(force) < 100 or not np.ptp(force):
        return None
    f, x = (np.fft.rfft(signal - signal.mean())[1:] for signal in (force, response))
    index = _own_lines(np.abs(f) ** 2)
    k = index - index.mean(axis=1, keepdims=True)
    powers = (k / np.abs(k).max(axis=1, keepdims=True))[:, :, None] ** np.arange(ORDER)
    transient = np.linalg.qr(powers)[0].astype(complex)
    rest = _without(transient, x[index][:, :, None])
    through = _without(transient, powers * f[index][:, :, None])
    basis, size, _ = np.linalg.svd(through, full_matrices=False)
    basis = basis * (size > 1e-9 * size[:, :1])[:, None, :]
    power = np.sum(np.abs(rest) ** 2, axis=(1, 2))
    explained = np.sum(np.abs(_adjoint(basis) @ rest) ** 2, axis=(1, 2))
    share = np.clip(explained / np.maximum(power, np.finfo(float).tiny), 0.0, 1.0)
    chance = np.maximum(betainc(LINES - 2 * ORDER, ORDER, 1 - share), 1e-300)
    related = float(gammaincc(len(index), -np.log(chance).sum())) < CHANCE
    noise = np.percentile(np.abs(x) ** 2, 10) / -np.log(0.9)  # mean power of a line, were all the response noise
    driven = np.mean(np.abs(f[index]) ** 2, axis=1)
    outstanding = (power > STANDS_OUT * LINES * noise) & (
        driven > IN_BAND * driven.max()
    )  # no harmonics: F is weak there
    if np.count_nonzero(outstanding) < ENOUGH:
        return Reach(float(explained.sum() / max(power.sum(), np.finfo(float).tiny)), related)
    coherence = float(share[outstanding].mean())
    return Reach(coherence, related and coherence > HALF)


def _own_lines(power: np.ndarray) -> np.ndarray:
    """Return the indices (bands, 16) of the lines that carry the force, or of the stretch around a few lone ones."""
    strongest = power.max()
    floor = max(ABOVE_FLOOR * float(np.percentile(power, 10)), ROUND_OFF * strongest)
    index = np.flatnonzero((power > IN_BAND * strongest) | (power > floor))
    if len(index) < 2 * LINES:
        index = np.arange(max(index[0] - LINES, 0), min(index[-1] + LINES, len(power)))
    bands = len(index) // LINES
    return index[: bands * LINES].reshape(bands, LINES)


def _adjoint(matrices: np.ndarray) -> np.ndarray:
    return np.conj(np.swapaxes(matrices, 1, 2))


def _without(basis: np.ndarray, values: np.ndarray) -> np.ndarray:
    return values - basis @ (_adjoint(basis) @ values)
