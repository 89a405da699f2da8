"""Whether what a model leaves over is noise.

The noise's level comes from the highest frequencies of the signals, so that noise which is not white leaves more
than that without any physics behind it. Physics moves with the rig: what grows with the motion, keeps step with its
cycles, rings with it, or bursts out at some instant, is a mismatch; what goes on alike whatever the rig does is noise
of another colour.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from ...identify.fit.mismatch import CYCLES, HARMONICS
from ...identify.problem.data import Data, expected_noise
from ...identify.problem.structure import Fitted
from ...identify.signals.noise_spectrum import estimate
from ...identify.signals.odds import ABOVE_NOISE, BEYOND_ERRORS, BY_CHANCE
from ...identify.signals.registry import numerics, shown
from ...model import Oscillator
from ...model.fit_state import Left
from ...model.left import share_of_motion, times_the_noise
from ...recording.smoothing import analytic_of
from ..limits import BEYOND_CHANCE, BURST, FAR_ABOVE_NOISE, FEWEST_WINDOWS, IN_STEP, UNTOLD

_SHORTEST = numerics(4, "samples", why="of a window that has a power")
_SHORTER = numerics(3, "windows", why="a short segment is cut in windows of so much less")
_SAID = shown(3, "recordings", why="of the worst a sentence says how much is left")

_ORDERS = range(1, HARMONICS + 1)
_HALF = numerics(math.sqrt(2.0), "of an octave", why="half of one on either side of the middle of a band")


@dataclass(frozen=True)
class Leftover:
    """One segment: rms of what is left over that of the noise, and whether it moves with the rig.

    Attributes:
        file: recording.
        ratio: rms of the residual over that expected of sensor and force noise.
        with_motion: rank correlation of its power with the motion's, 0 where it is not significant.
        in_step: share of its power that repeats with the cycles of the motion, 0 where noise would have as much.
        burst_s: time of a burst, or None.
        short: whether the segment has too few cycles for those three to tell.
        part: rms of the residual over that of the motion.
        order: of what keeps step, how many times the motion's frequency the strongest has; 0 where nothing does.
        resonant: share of its power that rings with the rig, 0 where noise of another colour would have as much.
        span: begin and end of the segment in its recording, s.
    """

    file: str
    ratio: float
    with_motion: float
    in_step: float
    burst_s: float | None
    short: bool = False
    part: float = np.nan
    order: int = 0
    resonant: float = 0.0
    span: tuple[float, float] | None = None

    @property
    def left(self) -> Left:
        """How much that is, as it is said everywhere."""
        return Left(self.file, self.part, self.ratio)

    @property
    def is_mismatch(self) -> bool:
        """Whether it is more than noise."""
        if self.with_motion > 0 or self.in_step > 0 or self.resonant > 0 or self.burst_s is not None:
            return not self.ratio <= ABOVE_NOISE
        return self.short and not self.ratio <= FAR_ABOVE_NOISE


def leftovers(fitted: Fitted, data: Data) -> tuple[Leftover, ...]:
    """What a fitted model leaves in each segment."""
    return tuple(leftover(fitted, data, i) for i in range(len(data.segments)))


def leftover(fitted: Fitted, data: Data, index: int) -> Leftover:
    """The same of one segment."""
    segment = data.segments[index]
    return replace(_leftover(fitted, data, index), span=(segment.time, segment.time + segment.n * segment.dt))


def _leftover(fitted: Fitted, data: Data, index: int) -> Leftover:
    """The same, but for when it was."""
    segment, residual = data.segments[index], fitted.residuals[index]
    name = data.recordings[segment.recording].name
    ratio = times_the_noise([residual], [expected(fitted, data, index)])
    part = share_of_motion([residual], [segment.response])
    size = max(_SHORTEST, round(CYCLES * 2 * np.pi / segment.pace / segment.dt))
    count = segment.n // size
    if count < FEWEST_WINDOWS:
        size = max(_SHORTEST, size // _SHORTER)
        count = segment.n // size
    short = count < FEWEST_WINDOWS
    if not np.isfinite(ratio):
        return Leftover(name, ratio, 1.0, 0.0, None, short=short, part=part)
    ringing = resonant_share(residual, segment.pace * segment.dt)
    ringing = ringing if ringing > IN_STEP else 0.0
    if short:
        return Leftover(name, ratio, 0.0, 0.0, None, short=True, part=part, resonant=ringing)
    power = np.mean(residual[: count * size].reshape(count, size) ** 2, axis=1)
    motion = segment.response[: count * size] - residual[: count * size]
    moved = np.std(motion.reshape(count, size), axis=1)
    correlation, chance = 0.0, 1.0
    if np.ptp(power) > 0 and np.ptp(moved) > 0:
        correlation, chance = _rank_correlation(power, moved)
    significant = correlation > 0 and chance < BY_CHANCE
    loudest = int(np.argmax(power))
    burst = power[loudest] > BURST * float(np.median(power))
    share, order, by_chance = in_step(segment.response - residual, residual)
    return Leftover(
        name,
        ratio,
        correlation if significant else 0.0,
        share,
        segment.time + (loudest + 0.5) * size * segment.dt if burst else None,
        short=by_chance > UNTOLD,
        part=part,
        order=order,
        resonant=ringing,
    )


def _rank_correlation(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Correlation of the ranks of two rows (n,), and how often chance makes one as large (Spearman 1904)."""
    from scipy.special import stdtr

    ranks = []
    for row in (one, other):
        _, place, count = np.unique(row, return_inverse=True, return_counts=True)
        ranks.append((np.cumsum(count) - 0.5 * (count - 1))[place])  # what is equal shares its ranks
    r, freedom = float(np.corrcoef(*ranks)[0, 1]), one.size - 2
    apart = max((1.0 - r) * (1.0 + r), np.finfo(float).eps ** 2)
    return r, 2.0 * float(stdtr(freedom, -abs(r) * np.sqrt(freedom / apart)))


def in_step(motion: np.ndarray, residual: np.ndarray) -> tuple[float, int, float]:
    """Share of a residual's power that repeats with the cycles of a motion, the order that is strongest in it, chance.

    The phase is that of the analytic signal (Gabor 1946), so that amplitude and frequency may be what they will; offset
    and each harmonic may have one part that is constant and one that goes with the amplitude. Share and order are zero
    where noise of the residual's own spectrum would often reach that share; chance is what it may reach in the
    harmonics.

    Args:
        motion: (n,) simulated response.
        residual: (n,) what it leaves over.
    """
    if not np.any(residual) or not np.ptp(motion) > 0:
        return 0.0, 0, 0.0
    analytic = analytic_of(motion - np.mean(motion))
    amplitude = np.abs(analytic)
    turn = analytic / np.maximum(amplitude, 1e-300)
    orders = [np.ones((1, motion.size))] + [np.stack([(turn**k).real, (turn**k).imag]) for k in _ORDERS]
    growing = amplitude / np.max(amplitude)
    columns = np.vstack(orders)
    basis, triangle = np.linalg.qr(np.vstack([columns, columns * growing]).T)
    power, on_basis = float(residual @ residual), basis.T @ residual
    share = float(np.sum(on_basis**2)) / power
    density = estimate(residual).density
    chance = np.sum(np.abs(np.fft.rfft(basis, axis=0)) ** 2 * density[:, None], axis=0) * 2 / residual.size / power
    limit = _reached(chance)
    # noise that drifts slowly lies at the offset alone, and that is no step of the motion's
    by_chance = _reached(np.delete(chance, [0, len(columns)]))
    if share <= max(IN_STEP, limit):
        return 0.0, 0, by_chance
    sizes = np.linalg.lstsq(triangle, on_basis, rcond=None)[0].reshape(2, -1)
    first = [0, *(2 * k - 1 for k in _ORDERS)]  # place of each order among the columns
    made = [
        float(np.sum((sizes[0, place] @ wave + (sizes[1, place] @ wave) * growing) ** 2))
        for wave, place in ((wave, slice(at, at + len(wave))) for wave, at in zip(orders, first, strict=True))
    ]
    return share, int(np.argmax(made[1:])) + 1 if max(made[1:]) >= made[0] else 0, by_chance


def _reached(chance: np.ndarray) -> float:
    """Share of the power that noise may reach by chance, from what it has on the mean along each of a basis."""
    return float(np.sum(chance)) + BEYOND_CHANCE * float(np.sqrt(2.0 * np.sum(chance**2)))


def resonant_share(residual: np.ndarray, turn: float) -> float:
    """Share of a residual's power that the octave around the rig's frequency has above both octaves beside it.

    A force that the model lacks reaches the response through the rig's resonance, also where it keeps no step with the
    motion: a rig that changes while it is recorded, a shove at the bench. Noise of sensors and recorders rises or falls
    over the octaves, as a power of the frequency or beyond a filter's corner, and has no hump there.

    Zero where noise would have as much by chance (a line of a periodogram is a chi-square of two degrees of freedom),
    or where one of the three octaves has no lines.

    Args:
        residual: (n,) what is left over.
        turn: of the motion, in radians a sample.
    """
    n = residual.size
    power = np.abs(np.fft.rfft(residual - np.mean(residual))) ** 2
    angle = 2.0 * np.pi * np.arange(power.size) / n
    below, here, above = (
        power[(angle >= middle / _HALF) & (angle < middle * _HALF) & (angle < np.pi)]
        for middle in (0.5 * turn, turn, 2.0 * turn)
    )
    if not (below.size and above.size and np.any(power)):
        return 0.0
    hump = float(np.mean(here))
    for beside in (below, above):
        by_chance = math.exp(BEYOND_ERRORS * math.sqrt(1.0 / here.size + 1.0 / beside.size))
        if hump <= by_chance * float(np.mean(beside)):
            return 0.0
    return (hump - max(float(np.mean(below)), float(np.mean(above)))) * here.size / float(np.sum(power))


def nearer(left: Sequence[Leftover], other: Sequence[Leftover]) -> Sequence[Leftover]:
    """Of what one structure leaves, fitted in two ways, that which leaves less, in power of the noise; one that runs
    away leaves more than any that does not."""

    def power(stretches: Sequence[Leftover]) -> float:
        total = sum(stretch.ratio**2 for stretch in stretches)
        return total if np.isfinite(total) else np.inf

    return other if power(other) < power(left) else left


def expected(fitted: Fitted, data: Data, index: int) -> float:
    """Rms that sensor noise, and force noise as the rig passes it on, leave in one segment."""
    return expected_noise(data.segments[index], fitted.model.values(), data.sensor[index], data.force[index])


def times_of_each(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> list[float]:
    """Rms of what is left in each segment over that of the noise."""
    values = model.values()
    return [
        times_the_noise([residual], [expected_noise(segment, values, data.sensor[i], data.force[i])])
        for i, (segment, residual) in enumerate(zip(data.segments, residuals, strict=True))
    ]


def sentence(left: Sequence[Leftover], whole: Mapping[str, Left] = MappingProxyType({})) -> str | None:
    """What stays beyond the noise, in words; None where nothing does.

    Args:
        left: what is left of each stretch.
        whole: what is said to be left of whole recordings elsewhere, by name: said of those that are one stretch, if it
            is more than noise.
    """
    worst: dict[str, Leftover] = {}
    for leftover in sorted(
        (leftover for leftover in left if leftover.is_mismatch), key=lambda leftover: leftover.ratio
    ):
        worst[leftover.file] = leftover
    bad = sorted(worst.values(), key=lambda leftover: -leftover.ratio)
    if not bad:
        return None
    segments = Counter(leftover.file for leftover in left)
    parts = []
    for leftover in bad[:_SAID]:
        alike = whole.get(leftover.file) if segments[leftover.file] == 1 else None
        said = alike if alike is not None and alike.times > ABOVE_NOISE else leftover.left
        when = _when(leftover) if segments[leftover.file] > 1 or (whole and said is not alike) else ""
        size = f"{said.of_motion} ({said.of_noise})" if math.isfinite(said.part) else said.of_noise
        parts.append(f"{size} in {leftover.file}{when}{_how(leftover)}")
    others = len(bad) - _SAID
    more = f", and more in {others} further recording{'s' if others > 1 else ''}" if others > 0 else ""
    return f"there remains {'; '.join(parts)}{more}"


def _when(leftover: Leftover) -> str:
    """Which of a recording's several segments it is: what the worst leaves is no figure of the whole."""
    if leftover.span is None:
        return ""
    begin, end = leftover.span
    return f", where it is worst, {begin:.4g} to {end:.4g} s"


def _how(leftover: Leftover) -> str:
    """What it keeps to, where the segment is long enough to tell."""
    order = f", most at {leftover.order} times its frequency" if leftover.order > 1 else ""
    if leftover.with_motion > 0:
        return f", growing with the motion{order}"
    if leftover.in_step > 0:
        return f", in step with the motion{order}"
    if leftover.resonant > 0:
        return ", around the rig's own frequency"
    return "" if leftover.burst_s is None else f", in a burst at {leftover.burst_s:.4g} s"
