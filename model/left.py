"""How much a model leaves of a motion: two figures, each made here and nowhere else.

Both compare the same root mean square, of what is left of the samples that were simulated, with that of something else
over the same samples: the motion about its mean, and what noise alone leaves of a perfect model. One over the other is
the noise as a share of the motion, so that any two of the three figures give the third.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np


def rms(rows: Sequence[np.ndarray]) -> float:
    """Root mean square of the samples of all rows (n,) together; inf where one is not finite, 0 without any."""
    size = math.sqrt(_mean([float(np.sum(np.square(row))) for row in rows], rows))
    return size if math.isfinite(size) else math.inf


def share_of_motion(left: Sequence[np.ndarray], measured: Sequence[np.ndarray]) -> float:
    """Rms of what is left over the standard deviation of what was measured (the NRMSE), stretches (n,) together.

    A share, not a percentage; inf where nothing moves or something left is not finite.
    """
    spread = float(np.std(np.concatenate(measured))) if measured else 0.0
    return rms(left) / spread if spread > 0 else math.inf


def times_the_noise(left: Sequence[np.ndarray], noise: Sequence[float]) -> float:
    """Rms of what is left of stretches (n,) together over that of the noise.

    Args:
        left: of each stretch.
        noise: rms that noise alone leaves of each, in the same unit.
    """
    expected = math.sqrt(_mean([len(row) * level**2 for row, level in zip(left, noise, strict=True)], left))
    return over(rms(left), expected)


def over(left: float, noise: float) -> float:
    """One rms, or share of a motion, over that which noise leaves of the same; inf where no noise is known."""
    ratio = left / noise if noise > 0 else math.inf
    return ratio if math.isfinite(ratio) else math.inf


def _mean(squares: Sequence[float], rows: Sequence[np.ndarray]) -> float:
    """Mean of what the sums of squares of the rows' samples are of."""
    count = sum(len(row) for row in rows)
    return sum(squares) / count if count else 0.0
