"""Where measured curves go, so that pictures show nothing between them: there a value is only interpolated."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

#: Least and largest value of each curve.
Spans = Sequence[tuple[float, float]]


def spans_of(curves: Iterable[np.ndarray]) -> Spans:
    """Least and largest finite value of each curve (n,); none of one without any."""
    finite = [values[np.isfinite(values)] for values in curves]
    return [(float(values.min()), float(values.max())) for values in finite if values.size]


def covered(at: np.ndarray, spans: Spans) -> np.ndarray:
    """Whether some curve passes each of the values (n,)."""
    inside = [(low <= at) & (at <= high) for low, high in spans]
    return np.any(inside, axis=0) if inside else np.zeros(at.shape, bool)


def parted(at: np.ndarray, spans: Spans, *lines: np.ndarray) -> list[np.ndarray]:
    """Abscissae (n,), rising, and ordinates (n,) of lines, with nan where no curve passes between two neighbours."""
    gaps = np.flatnonzero(~covered((at[1:] + at[:-1]) / 2, spans)) + 1
    return [np.insert(values, gaps, np.nan) for values in (at, *lines)]
