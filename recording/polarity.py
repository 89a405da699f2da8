"""Whether force and response have signs that belong together: a passive thing takes up work, it does not give any."""

from __future__ import annotations

import numpy as np

from .recording import QUANTITIES

IN_BAND = 1e-3  # of the strongest line: the force's own band reaches down to -30 dB
#: Energy can only be dissipated or stored, so the mean cosine cannot stay negative. The margin is for what was
#: stored before the record began, for noise, and for a late sensor.
REVERSED = -0.2


def power_cosine(force: np.ndarray, response: np.ndarray, fs: float, quantity: str) -> float:
    """Mean cosine of the phase between force and velocity, both (n,), weighted by |F| |V| over the force's own band.

    Its sign is that of the work that the force does on the thing: the integral of F v dt, by Parseval's theorem, with
    a Hann window so that the ends of the record do not count. A velocity comes from the response by powers of i omega.
    """
    window = np.hanning(len(force))
    f, x = (np.fft.rfft((signal - signal.mean()) * window)[1:] for signal in (force, response))
    omega = 2 * np.pi * np.fft.rfftfreq(len(force), 1 / fs)[1:]
    v = x * (1j * omega) ** (1 - QUANTITIES.index(quantity))
    band = np.abs(f) ** 2 > IN_BAND * np.max(np.abs(f) ** 2)
    work = np.conj(f[band]) * v[band]
    return float(np.sum(work.real) / max(np.sum(np.abs(work)), np.finfo(float).tiny))
