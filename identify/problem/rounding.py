"""What a converter of few levels does to the parameters: its rounding keeps step with a smooth signal.

The error of rounding is white where a signal crosses many levels from sample to sample, or where noise of half a step
lies on it (Widrow and Kollar 2008, chapters 7 and 19); as such it is part of the noise. Of a sine of few levels it is
a sine too, that counts for a larger or smaller force throughout, and of a mass at rest it is a place: no residual shows
that, and it goes into the parameters. How much it is depends on where the signal lies between two levels, which nobody
knows to better than a step. So the signal is rounded again, its size changed by up to half a step at its peak and its
zero by as much, and what that does beyond white noise is in the errors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...files.computed_once import computed_once
from ...recording.checks import LEVELS
from ...recording.fact import fact
from ...recording.recording import Recording
from ...recording.resolution import converter_step
from ..motion.blows import ContactForce
from ..signals.registry import numerics
from ..signals.signals import Signal, drive_of, response_of
from .limits import DITHERS
from .normal_equations import products
from .output_error import OutputError, State

_SINGULAR = numerics(1e-12, "of the largest", why="directions of the parameters that the motion does not tell")
_BELOW = numerics(2.0, "times its highest frequency", why="a signal lies below, and its rounding mostly above")


@dataclass(frozen=True, eq=False)
class Rounding:
    """A signal of few levels, as it was before it was rounded.

    Attributes:
        step: between levels, in the signal's unit.
        level: one of the levels.
        smooth: (n,) the signal, as far as it is known.
        noise: standard deviation of what else was rounded with it.
    """

    step: float
    level: float
    smooth: np.ndarray
    noise: float

    @computed_once
    def _middle(self) -> float:
        return float(np.mean(self.smooth))

    @computed_once
    def _peak(self) -> float:
        return max(float(np.max(np.abs(self.smooth - self._middle))), self.step)

    def error(self, random: np.random.Generator, within: slice = slice(None)) -> np.ndarray:
        """What rounding may have done to the samples ``within``, of which there is one for each: a draw."""
        size = 1.0 + self.step * random.uniform(-0.5, 0.5) / self._peak
        zero = self.level + self.step * random.uniform(-0.5, 0.5)
        before = self._middle + size * (self.smooth[within] - self._middle) - zero
        before = before + self.noise * random.standard_normal(before.size)
        return self.step * np.round(before / self.step) - before


def rounding_of(signal: Signal) -> Rounding | None:
    """The rounding of a signal that keeps step with it; None where its noise is half a step."""
    samples, step = signal.samples, converter_step(signal.samples)
    if not step:
        return None
    of_rounding = step**2 / 12.0
    noise = np.sqrt(max(signal.noise**2 - of_rounding, 0.0))
    if noise >= DITHERS * step:
        return None
    return Rounding(step, float(samples[0]), _below(samples, _BELOW * signal.band[1] / signal.fs), float(noise))


@fact("response", "fs")
def _of_response(recording: Recording) -> Rounding | None:
    return rounding_of(response_of(recording))


@fact("force", "fs")
def _of_force(recording: Recording) -> Rounding | None:
    drive = drive_of(recording)
    made = None if drive is None else rounding_of(drive)
    # each draw of a force is simulated; what a rig passes on of a rounding of many levels is as good as noise
    return None if made is None or float(np.ptp(made.smooth)) >= LEVELS * made.step else made


def measure_rounding(recording: Recording) -> None:
    """Know from here on what ``scatter_of_rounding`` asks of a recording."""
    _of_response(recording)
    _of_force(recording)


def _below(samples: np.ndarray, highest: float) -> np.ndarray:
    """(n,) samples without what lies above ``highest`` cycles a sample; continued by point reflection at its ends."""
    n = samples.size
    wide = np.concatenate([2 * samples[0] - samples[:0:-1], samples, 2 * samples[-1] - samples[-2::-1]])
    spectrum = np.fft.rfft(wide - np.mean(samples))
    spectrum[np.fft.rfftfreq(wide.size) > highest] = 0.0
    return np.fft.irfft(spectrum, wide.size)[n - 1 : 2 * n - 1] + np.mean(samples)


def scatter_of_rounding(
    problem: OutputError,
    state: State,
    i: int,
    weighted: np.ndarray,
    base: np.ndarray,
    recordings: Sequence[Recording],
    draws: int,
    seed: int = 0,
) -> np.ndarray | float:
    """(k, k) scatter of the shared parameters' score by the rounding of one segment's signals; 0 where it is fine.

    Args:
        problem: what was fitted.
        state: the maximum of the likelihood.
        i: place of the segment.
        weighted: (k, n) derivatives as the score weighs a residual by them.
        base: (n,) the simulated response.
        recordings: of the segments.
        draws: how many times.
        seed: of the random numbers.
    """
    segment = problem.segments[i]
    recording = recordings[segment.recording]
    within = slice(segment.start, segment.stop)
    shown, force = _of_response(recording), problem.force(segment)
    driven = None if force is None or isinstance(force, ContactForce) else _of_force(recording)
    if shown is None and driven is None:
        return 0.0

    def scores(error_of: Callable[[np.random.Generator], np.ndarray]) -> np.ndarray:
        random = [np.random.default_rng([seed, i, draw, 1]) for draw in range(draws)]
        found = np.array(problem.map(lambda one: products(weighted, error_of(one)), random))
        return found[np.all(np.isfinite(found), axis=1)]

    total = np.zeros((len(weighted), len(weighted)))
    if shown is not None:
        total += _beyond_white(scores(lambda random: shown.error(random, within)), shown.step, weighted)
    if driven is not None and force is not None:
        drawn = scores(lambda random: problem.simulate(i, state, added=driven.error(random, within)) - base)
        total += drawn.T @ drawn / max(len(drawn), 1)
    return total


def _beyond_white(scores: np.ndarray, step: float, weighted: np.ndarray) -> np.ndarray:
    """(k, k) scatter of scores (draws, k) beyond what white noise of rounding would make, which is in what is left.

    In directions in which the draws scatter by more than white noise does by chance (Marchenko and Pastur 1967).
    """
    if not len(scores):
        return np.zeros((len(weighted), len(weighted)))
    white = step**2 / 12.0 * products(weighted, weighted)
    size = np.sqrt(np.maximum(np.diag(white), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(white / np.outer(size, size))
    known = values > _SINGULAR * values[-1]
    root = size[:, None] * vectors[:, known] * np.sqrt(values[known])
    unit = scores / size @ (vectors[:, known] / np.sqrt(values[known]))
    times, turned = np.linalg.eigh(unit.T @ unit / len(scores))
    by_chance = (1.0 + np.sqrt(times.size / len(scores))) ** 2
    beyond = root @ (turned * np.sqrt(np.where(times > by_chance, times - 1.0, 0.0)))
    return beyond @ beyond.T
