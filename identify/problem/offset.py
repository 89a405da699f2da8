"""What a sensor shows at zero, and how fast that drifts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...recording.recording import Recording
from ..motion.force_off import zero_of
from ..signals.limits import FEWEST_CYCLES
from ..signals.odds import BEYOND_ERRORS
from ..signals.registry import numerics
from ..signals.said import said
from .normal_equations import pseudo_inverse

if TYPE_CHECKING:
    from .segments import Segment


FEELER = numerics(1e-2, "standard deviations of the signal", why="the size by which an offset is felt")


@dataclass(frozen=True)
class Row:
    """What one kind of offset does; its kinds are the table ``ROWS``.

    Attributes:
        forced: whether it is on the force's channel, and not on the response's.
        along: of a response's, what it shows for each unit at times (n,) about its middle, s: () or (n,).
        rate: whether its unit is the channel's per second.
        sentence: for a user.
    """

    forced: bool
    along: Callable[[np.ndarray], np.ndarray]
    rate: bool
    sentence: str

    def size(self, recording: Recording) -> float:
        """A hundredth of what the channel shows, and for a rate that in the time of the recording."""
        signal = recording.force if self.forced else recording.response
        size = FEELER * float(np.std(0.0 if signal is None else signal))
        return size / recording.duration if self.rate else size


ROWS = {
    "response": Row(False, lambda _: np.ones(()), False, "the sensor shows {} at zero; it was taken off"),
    "drift": Row(False, lambda times: times, True, "the sensor drifts by {} in a second; that was taken off"),
    "force": Row(
        True,
        lambda _: np.zeros(()),
        False,
        "the force sensor shows {} at zero; it was taken off (a constant load on the mass, the other way round, would "
        "look the same)",
    ),
}


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

    @staticmethod
    def of(
        recordings: Sequence[Recording], index: int, channel: str, *, guess: float = 0.0, middle: float = 0.0
    ) -> Offset:
        """That of one of the recordings, of the size that its channel has."""
        return Offset(index, channel, ROWS[channel].size(recordings[index]), guess, middle)

    def along(self, times: np.ndarray) -> np.ndarray:
        """() or (n,) what the response shows for each unit of it at times (n,), s."""
        return ROWS[self.channel].along(times - self.middle)


@dataclass(frozen=True)
class FoundOffset:
    """An offset that stands out: of which recording and channel, its value and its standard error; see ``Offset``."""

    recording: int
    channel: str
    value: float
    std: float
    middle: float = 0.0

    def begun(self, recordings: Sequence[Recording]) -> Offset:
        """The offset from which another fit to these recordings begins."""
        return Offset.of(recordings, self.recording, self.channel, guess=self.value, middle=self.middle)

    def sentence(self, recording: Recording) -> str:
        """What a user reads of it."""
        row = ROWS[self.channel]
        return f"{recording.name}: {row.sentence.format(said(recording, self.value, self.std, force=row.forced))}"


def zeros_along(offsets: Sequence[Offset], values: np.ndarray, segment: Segment) -> tuple[np.ndarray, float]:
    """What the sensors show at zero along a segment: the response's, () or where it drifts (n,), and the force's."""
    shown = np.zeros(())
    pushes = 0.0
    for offset, value in zip(offsets, values, strict=True):
        if offset.recording != segment.recording or offset.channel not in ROWS:
            continue
        if ROWS[offset.channel].forced:
            pushes = float(value)
        else:
            shown = shown + float(value) * offset.along(segment.time + np.arange(segment.n) * segment.dt)
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
    if sum(len(part) for part in means) < FEWEST_CYCLES:
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
