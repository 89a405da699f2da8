"""Smooth driving forces as Taylor polynomials over each step, exact to rounding.

At 20 Hz and 1 kHz the phase advances by 0.126 rad a step: what the polynomial of degree 10 leaves out is
0.126^11 / 11! = 3e-18 of the amplitude. Sampling such a force and holding it (first-order hold) would be off by 1e-3.
"""

from __future__ import annotations

from math import factorial

import numpy as np

DEGREE = 10


def chirp(amplitude: float, start_hz: float, rate: float, times: np.ndarray, dt: float) -> np.ndarray:
    """Give amplitude sin 2 pi (start_hz t + rate t²/2), N, over the steps that begin at `times` (n,) s: (n, 11) in s.

    `rate` in Hz/s; zero makes a plain sine. The Taylor coefficients of exp(i phase) follow from z' = i phase' z.
    """
    phase = 2 * np.pi * (start_hz * times + 0.5 * rate * times**2)
    first = 2 * np.pi * (start_hz + rate * times) * dt
    second = np.pi * rate * dt**2
    z = np.zeros((DEGREE + 1, len(times)), dtype=complex)
    z[0] = np.exp(1j * phase)
    for k in range(1, DEGREE + 1):
        z[k] = 1j * first * z[k - 1] / k
        if k > 1:
            z[k] += 2j * second * z[k - 2] / k
    return amplitude * np.imag(z).T


def multisine(amplitude: float, lines_hz: np.ndarray, phases: np.ndarray, times: np.ndarray, dt: float) -> np.ndarray:
    """Give the sum over lines of amplitude sin(2 pi f t + phase), N, over the steps that begin at `times`: (n, 11).

    `times` (n,) s; `lines_hz` (lines,) Hz; `phases` (lines,) rad.
    """
    omega = 2 * np.pi * lines_hz
    order = np.arange(DEGREE + 1)
    scale = np.array([factorial(k) for k in order], dtype=float)
    weights = (1j * omega[:, None] * dt) ** order / scale
    pieces = [
        (np.exp(1j * (np.outer(some, omega) + phases)) @ weights).imag
        for some in np.array_split(times, max(1, len(times) // 2000))
    ]
    return amplitude * np.concatenate(pieces)
