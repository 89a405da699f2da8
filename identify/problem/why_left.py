"""Why a fit leaves a stretch of a recording, in words: what ``segments.cut`` asks, asked of what it left."""

from __future__ import annotations

import numpy as np

from ...model.display import number, scale_of
from ...recording.recording import Recording
from ..motion.decays import force_is_silent
from ..signals.odds import HALF_AGAIN
from ..signals.signals import response_of
from .limits import WORTH_ITS_START


def why_left(recording: Recording, start: int, stop: int, pace: float) -> str:
    """The reason why the samples from ``start`` to ``stop`` are in no segment, a clause without a full stop.

    Args:
        recording: of which they are.
        start, stop: a stretch that no segment covers.
        pace: angular frequency of the motion, rad/s, as the segments were cut by.
    """
    if any(max(start, a) < min(stop, b) for a, b in recording.unknown):
        return "what drives the rig is not known there"
    if any(a <= start and stop <= b for a, b in recording.blank):
        return "the sensor shows nothing there"
    if stop - start < 2.0 * np.pi / pace * recording.fs:
        return "less than a cycle between what is taken"
    signal = response_of(recording)
    # a rest is level with itself, wherever that is: noise is held against what is left beside a straight line
    time = np.linspace(-1.0, 1.0, stop - start)
    samples = np.asarray(signal.samples[start:stop], float)
    beside = samples - np.polynomial.polynomial.polyval(time, np.polynomial.polynomial.polyfit(time, samples, 1))
    size = float(np.std(beside))
    if not size > HALF_AGAIN * signal.noise:
        sizes = np.array([size, signal.noise])
        scale = scale_of(recording.unit, sizes)
        swing, noise = (f"{number(value * scale.factor, 2)} {scale.unit}" for value in sizes)
        return f"at rest, or faded into the noise: {swing} rms about a straight line, and the noise is {noise}"
    cycles = (stop - start) * recording.dt * pace / (2.0 * np.pi)
    if cycles < WORTH_ITS_START:
        return (
            f"too short: {number(cycles, 2)} cycles, and fewer than {number(WORTH_ITS_START)} say less than the state "
            "that they begin with costs"
        )
    if recording.force is None or not np.any(recording.force):
        return "it moves but does not swing free: it is being moved, or beats, and no force was recorded"
    if force_is_silent(recording):
        return "it moves, but not free, and the recorded force is silent: something else drives it"
    return "neither free nor driven by the recorded force for long enough"
