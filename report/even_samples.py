"""Samples at even steps in few letters, so that a page keeps a recording as it is and enlarges it to its cycles.

Sixteen bits a sample, in base64: a two-hundredth of a pixel of a panel as high as a screen, in 2.7 letters. Of more
samples than a page has room for, the least and the largest of every stretch stay, at even steps again.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

#: Samples at even steps that all charts of a page keep together, half a megabyte, and the fewest that a line keeps.
ROOM, FEWEST = 180_000, 2_000
#: Steps between the least and the largest value, and the number that stands for no value.
_STEPS, _NONE = 65_000, -32_768
#: Part of a step by which instants that were rounded may be off.
_ROUNDED = 0.02


def is_even(x: np.ndarray) -> bool:
    """Whether x (n,) rises in even steps, to what rounding leaves."""
    if x.size < 3 or not np.all(np.isfinite(x)) or not x[-1] > x[0]:
        return False
    step = (x[-1] - x[0]) / (x.size - 1)
    return bool(np.max(np.abs(x - x[0] - step * np.arange(x.size))) < _ROUNDED * step)


def packed(x: np.ndarray, y: np.ndarray, room: int) -> dict[str, Any]:
    """A line through y (n,) at even x (n,) as a browser unpacks it, of at most ``room`` samples.

    Returns:
        ``from`` and ``step`` of x, ``least`` and ``unit`` of y, and ``samples``: y is least + unit (32767 + sample),
        little-endian 16-bit numbers in base64; -32768 where there is none.
    """
    first, step = float(x[0]), float(x[-1] - x[0]) / (x.size - 1)
    if y.size > room:
        first, step, y = _extremes(first, step, y, room)
    there = np.isfinite(y)
    low, high = (float(y[there].min()), float(y[there].max())) if np.any(there) else (0.0, 0.0)
    unit = (high - low) / _STEPS or 1.0
    counts = np.full(y.size, _NONE, "<i2")
    counts[there] = np.round((y[there] - low) / unit) - 32_767
    text = base64.b64encode(counts.tobytes()).decode("ascii")
    return {"from": first, "step": step, "least": low, "unit": unit, "samples": text}


def _extremes(first: float, step: float, y: np.ndarray, room: int) -> tuple[float, float, np.ndarray]:
    """Two samples of each stretch, its extremes in their order, at even steps; a stretch with a gap keeps one."""
    size = -(-y.size // (room // 2))
    full = np.append(y, np.full(-y.size % size, y[-1])).reshape(-1, size)
    there = np.isfinite(full)
    low = np.argmin(np.where(there, full, np.inf), axis=1)
    high = np.argmax(np.where(there, full, -np.inf), axis=1)
    rows = np.arange(full.shape[0])
    pairs = np.stack([full[rows, np.minimum(low, high)], full[rows, np.maximum(low, high)]], axis=1)
    pairs[~np.all(there, axis=1), 1] = np.nan
    return first + 0.25 * size * step, 0.5 * size * step, pairs.ravel()
