"""The white noise on a force that may leap: edges, and where a tone starts and stops, are signal.

A force in steps has power at every frequency, and its spectrum shows no noise alone. Between its edges it does: short
filters that let through what is near the highest frequency see an edge for as long as they are, and the noise
everywhere. What a filter lets through of the signal can only add to the noise. So of filters of several lengths, the
short ones for edges that lie close and the long ones for tones of few samples a cycle, that which shows least is
right. Samples that repeat each other bit for bit have no noise: a command that was never measured.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb

import numpy as np

from ...recording.smoothing import harris
from .odds import BEYOND_ERRORS
from .registry import numerics

_DIFFERENCES = numerics((1, 2, 4), "times", why="a signal is taken its difference of: polynomials up to the third go")
_LENGTHS = numerics((8, 16, 32), "samples", why="of windows that pass tones of 10, 7 and 5 samples a cycle by 1e-5")
_PASSED = numerics(0.4375, "of the sampling rate", why="the middle of the quarter in which noise is measured")
_BLOCKS = numerics(16, "blocks", why="in which noise has a level of its own: a force that is off may be quieter")
_FEWEST = numerics(64, "samples", why="of a block, so that its level is good to a tenth")
_QUIETEST = numerics(0.25, "part of the samples", why="from which the level is found: as many lie beside no edge")
_OF_NORMAL = numerics(0.31864, "standard deviations", why="below which so many absolute values of normal variables lie")
_SETTLED = numerics(1e-3, "part of the level", why="far below its error")
OF_MEDIAN = numerics(1.4826, "times the median size", why="the standard deviation of normal noise")


def noise_beside_edges(x: np.ndarray) -> float:
    """Standard deviation of the white noise on `x` (n,), edges and sine starts left out; inf where it is too short."""
    x = np.asarray(x, float) - np.mean(x)
    levels = []
    for taps in _filters():
        if x.size < 2 * taps.size:
            continue
        passed = np.abs(np.convolve(x, taps, "valid"))
        blocks = np.array_split(passed, max(1, min(_BLOCKS, passed.size // _FEWEST)))
        levels.append(np.sqrt(np.mean([_level(block) ** 2 for block in blocks])))
    return float(min(levels, default=np.inf))


@lru_cache(maxsize=1)
def _filters() -> tuple[np.ndarray, ...]:
    """Taps of unit energy, short ones first: differences, and these through windows about a high frequency."""
    differences = [np.array([(-1.0) ** k * comb(order, k) for k in range(order + 1)]) for order in _DIFFERENCES]
    made = list(differences)
    for length in _LENGTHS:
        turned = np.cos(2 * np.pi * _PASSED * (np.arange(length) - 0.5 * (length - 1)))
        made.append(np.convolve(differences[-1], harris(length, periodic=True) * turned))
    return tuple(taps / np.linalg.norm(taps) for taps in made)


def _level(size: np.ndarray) -> float:
    """Standard deviation of normal values of which (m,) are the absolute ones, but for those far beyond it."""
    level = float(np.quantile(size, _QUIETEST)) / _OF_NORMAL
    while True:
        wider = float(np.sqrt(np.mean(size[size <= BEYOND_ERRORS * level] ** 2)))
        if not wider > (1.0 + _SETTLED) * level:
            return wider
        level = wider
