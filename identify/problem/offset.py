"""What a sensor shows at zero, and how fast that drifts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..motion.force_off import FEWEST_MEANS, zero_of
from ..signals.odds import BEYOND_ERRORS
from .normal_equations import pseudo_inverse

if TYPE_CHECKING:
    from .segments import Segment


@dataclass(frozen=True)
class Offset:
    """What a sensor shows at zero, all through one recording: of the ``response`` or of the ``force``.

    The channel ``drift`` is that of the response, by which it moves in a second, about the time ``middle`` (s).
    ``scale`` is its size for finite differences, ``guess`` where the search begins, ``taken`` what of it was taken off
    the recording before.
    """

    recording: int
    channel: str
    scale: float
    guess: float = 0.0
    middle: float = 0.0
    taken: float = 0.0


@dataclass(frozen=True)
class FoundOffset:
    """An offset that stands out: of which recording and channel, its value and its standard error; see ``Offset``."""

    recording: int
    channel: str
    value: float
    std: float
    middle: float = 0.0


def zeros_along(offsets: Sequence[Offset], values: np.ndarray, segment: Segment) -> tuple[np.ndarray, float]:
    """What the sensors show at zero along a segment: the response's, () or where it drifts (n,), and the force's."""
    shown = np.zeros(())
    pushes = 0.0
    for offset, value in zip(offsets, values, strict=True):
        if offset.recording != segment.recording:
            continue
        if offset.channel == "response":
            shown = shown + float(value)
        elif offset.channel == "drift":
            shown = shown + float(value) * (segment.time + np.arange(segment.n) * segment.dt - offset.middle)
        else:
            pushes = float(value)
    return shown, pushes


def centre(response: np.ndarray, fs: float, omega: float) -> float:
    """Where a motion (n,) of angular frequency ``omega`` is centred: the median of the means over its cycles."""
    period = max(2, round(2 * np.pi / omega * fs))
    count = response.size // period
    if count < 1:
        return float(np.mean(response))
    return float(np.median(np.mean(response[: count * period].reshape(count, period), axis=1)))


def zero_of_load_cell(force: np.ndarray, fs: float, omega: float) -> float:
    """Where the signal (n,) of a load cell is centred that drives a motion of angular frequency ``omega``.

    0 where it may be centred about zero.
    """
    period = max(2, round(2 * np.pi / omega * fs))
    zero, error = zero_of(force, period)
    return zero if abs(zero) > BEYOND_ERRORS * error else 0.0


def drift_of(parts: Sequence[tuple[float, float, np.ndarray, np.ndarray]], omega: float) -> float | None:
    """By how much the middle of what is left moves a second, beside the size of the motion: 0 where that is chance.

    Judged by the means over cycles of angular frequency ``omega``, beside the square of the motion's own size in each.

    Args:
        parts: of one recording, each its first time and its interval in s, its response (n,) and what is left (n,).
        omega: angular frequency of the motion, rad/s.

    Returns:
        The slope in the response's unit per second; None where the parts are too short to say so.
    """
    times, means, sizes = [], [], []
    for time, dt, response, residual in parts:
        period = max(2, round(2 * np.pi / omega / dt))
        count = response.size // period
        if count < 1:
            continue
        cycles = slice(0, count * period)
        times.append(time + (np.arange(count) + 0.5) * period * dt)
        means.append(np.mean(residual[cycles].reshape(count, period), axis=1))
        sizes.append(np.var(response[cycles].reshape(count, period), axis=1))
    if sum(len(part) for part in means) < FEWEST_MEANS:
        return None
    mean = np.concatenate(means)
    columns = np.stack([np.ones(mean.size), np.concatenate(times), np.concatenate(sizes)])
    scale = np.maximum(np.max(np.abs(columns), axis=1, keepdims=True), np.finfo(float).tiny)
    columns /= scale
    inverse = pseudo_inverse(columns @ columns.T)
    fitted = inverse @ (columns @ mean)
    scatter = np.sum((mean - fitted @ columns) ** 2) / max(mean.size - len(columns), 1)
    stands = abs(fitted[1]) > BEYOND_ERRORS * np.sqrt(scatter * inverse[1, 1])
    return float(fitted[1] / scale[1, 0]) if stands else 0.0
