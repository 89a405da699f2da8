"""Linear filters of a recording, by the transform of it and of rest before and after."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def filtered(
    signal: np.ndarray,
    fs: float,
    transfer: Callable[[np.ndarray], np.ndarray],
    before: float = 0.0,
    settles: float = 0.0,
) -> np.ndarray:
    """Pass a signal, (n,) at `fs` Hz, through `transfer(s)`, s in rad/s, (k,) complex.

    Before its first sample the signal was `before`; after its last it returns there along a straight line. The
    filter has settled after `settles` s.
    """
    count = len(signal)
    rest = max(count, int(settles * fs))
    padded = np.concatenate([np.zeros(rest), signal - before, np.linspace(signal[-1] - before, 0.0, count)])
    s = 2j * np.pi * np.fft.rfftfreq(len(padded), 1 / fs)
    passed = np.fft.irfft(np.fft.rfft(padded) * transfer(s), len(padded))[rest : rest + count]
    return passed + before * float(np.real(transfer(np.zeros(1, dtype=complex))[0]))
