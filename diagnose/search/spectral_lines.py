"""Frequencies that stand out of what a model leaves over."""

from __future__ import annotations

import numpy as np

from ...identify.data import Data, noise_spectra
from ...identify.structure import Fitted

#: Above the logarithm of the number of frequencies by this much, a line of a periodogram is no chance (one in 400)
#: and a place where a search may begin, which costs little and decides nothing.
_BEYOND_CHANCE = 6.0
_MOST = 4
#: A segment of fewer samples has too few frequencies for a line to stand out of.
_FEWEST = 64


def residual_lines(fitted: Fitted, data: Data) -> tuple[float, ...]:
    """Angular frequencies, rad/s, the strongest line first.

    The periodogram over the smooth spectrum around it is exponentially distributed where there is only noise (Fisher
    1929). A line is placed between the bins by a parabola through its logarithms.
    """
    peaks: list[tuple[float, float]] = []
    resolution = max((2 * np.pi / (s.n * s.dt) for s in data.segments if s.n > _FEWEST), default=0.0)
    for segment, residual, noise in zip(
        data.segments, fitted.residuals, noise_spectra(fitted.residuals, fitted.model, data), strict=True
    ):
        if segment.n <= _FEWEST:
            continue
        window = np.hanning(segment.n)
        power = np.abs(np.fft.rfft(residual * window)) ** 2 / np.sum(window**2) / noise.density
        power[:3] = 0.0
        for place in np.argsort(power)[::-1][:3]:
            if power[place] < np.log(power.size) + _BEYOND_CHANCE or not 0 < place < power.size - 1:
                continue
            left, middle, right = np.log(power[place - 1 : place + 2] + 1e-300)
            bend = left - 2 * middle + right
            shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
            peaks.append((float(power[place]), 2 * np.pi * (place + shift) / (segment.n * segment.dt)))
    lines: list[float] = []
    for _, omega in sorted(peaks, reverse=True):
        if all(abs(omega - known) > 2 * resolution for known in lines):
            lines.append(float(omega))
    return tuple(lines[:_MOST])
