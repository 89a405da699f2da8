"""Frequencies that stand out of what a model leaves over."""

from __future__ import annotations

import numpy as np

from ...identify.problem.data import Data, noise_spectra
from ...identify.problem.structure import Fitted

#: Above the logarithm of the number of frequencies by this much, a line of a periodogram is no chance (one in 400)
#: and a place where a search may begin, which costs little and decides nothing.
_BEYOND_CHANCE = 6.0
_MOST = 4
#: A segment of fewer samples has too few frequencies for a line to stand out of.
_FEWEST = 64


def residual_lines(fitted: Fitted, data: Data) -> tuple[float, ...]:
    """Angular frequencies, rad/s: the loudest line, then those that stand out most.

    The periodogram over the smooth spectrum around it is exponentially distributed where there is only noise (Fisher
    1929). A line is placed between the bins by a parabola through its logarithms. The loudest, by its power
    over the sensor's noise, comes first: of a tone friction makes harmonics, which stand out where less is left over.
    """
    peaks: list[tuple[float, float]] = []
    loudest: list[tuple[float, float]] = []
    resolution = max((2 * np.pi / (s.n * s.dt) for s in data.segments if s.n > _FEWEST), default=0.0)
    spectra = noise_spectra(fitted.residuals, fitted.model, data)
    for segment, residual, noise, sensor in zip(data.segments, fitted.residuals, spectra, data.sensor, strict=True):
        if segment.n <= _FEWEST:
            continue
        window = np.hanning(segment.n)
        loudness = np.abs(np.fft.rfft(residual * window)) ** 2
        power = loudness / np.sum(window**2) / noise.density
        power[:3] = 0.0
        standing = np.flatnonzero(power >= np.log(power.size) + _BEYOND_CHANCE)
        standing = standing[standing < power.size - 1]  # the highest bin has no neighbour to place it by
        if not standing.size:
            continue
        placed = {place: _placed(power, int(place)) * 2 * np.pi / (segment.n * segment.dt) for place in standing}
        loud = standing[np.argmax(loudness[standing])]
        loudest.append((float(loudness[loud] / np.sum(window**2)) / sensor**2, placed[loud]))
        peaks += [(float(power[place]), placed[place]) for place in np.argsort(power)[::-1][:3] if place in placed]
    lines: list[float] = []
    for _, omega in [*sorted(loudest, reverse=True)[:1], *sorted(peaks, reverse=True)]:
        if all(abs(omega - known) > 2 * resolution for known in lines):
            lines.append(omega)
    return tuple(lines[:_MOST])


def _placed(power: np.ndarray, place: int) -> float:
    """Where a line lies, in bins."""
    left, middle, right = np.log(power[place - 1 : place + 2] + 1e-300)
    bend = left - 2 * middle + right
    return place + (0.5 * (left - right) / bend if bend < 0 else 0.0)
