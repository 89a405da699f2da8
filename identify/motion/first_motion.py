"""Displacement and velocity at the first sample of a stretch, and whether it begins at rest."""

from __future__ import annotations

import numpy as np

from ..signals.odds import BEYOND_ERRORS
from ..signals.registry import numerics

_PART = numerics(0.15, "of a cycle", why="that a parabola follows")
_FEWEST = numerics(4, "samples", why="of a parabola and what it leaves")


def motion_length(n: int, dt: float, pace: float) -> int:
    """Samples, of so many, from which the first motion is measured: a seventh of a cycle."""
    return int(np.clip(_PART * 2 * np.pi / pace / dt, _FEWEST, n))


def first_motion(segment_response: np.ndarray, dt: float, pace: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and velocity (2,) at the first sample, by a parabola through the first seventh of a cycle.

    The second array holds their standard deviations for a noise of one.
    """
    count = motion_length(segment_response.size, dt, pace)
    columns = np.vander(np.arange(count) * dt, 3, increasing=True)
    inverse = np.linalg.pinv(columns)
    return (inverse @ segment_response[:count])[:2], np.sqrt(np.sum(inverse[:2] ** 2, axis=1))


def starts_at_rest(response: np.ndarray, dt: float, pace: float, noise: float) -> bool:
    """Whether neither displacement nor velocity at the first sample stands out of the noise."""
    motion, spread = first_motion(response, dt, pace)
    return bool(np.all(np.abs(motion) < BEYOND_ERRORS * noise * spread))
