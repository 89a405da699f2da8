"""Displacement and velocity at the first sample of a stretch, and whether it begins at rest."""

from __future__ import annotations

import numpy as np

#: Initial values within this many standard errors of zero are those of a mass at rest.
_AT_REST = 4.0
#: The part of a cycle that a parabola follows.
_PART = 0.15


def motion_length(n: int, dt: float, pace: float) -> int:
    """Samples, of so many, from which the first motion is measured: a seventh of a cycle."""
    return int(np.clip(_PART * 2 * np.pi / pace / dt, 4, n))


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
    return bool(np.all(np.abs(motion) < _AT_REST * noise * spread))
