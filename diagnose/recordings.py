"""What goes into a diagnosis: recordings of one motion, long and loud enough, some of them held out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..errors import BadInput
from ..identify.identification import of_one_motion
from ..identify.motion.decays import find_free_motion, force_is_silent
from ..identify.problem.data import natural_frequency
from ..identify.problem.limits import FEWEST_SWINGS, WORTH_ITS_START
from ..identify.problem.segments import cut, pace_of
from ..identify.signals.limits import FEWEST_CYCLES
from ..identify.signals.odds import SIGNIFICANT
from ..identify.signals.registry import budget
from ..identify.signals.signals import response_of
from ..model import Oscillator
from ..recording.recording import Recording
from .limits import LEAST_DAMPING, MEMORIES, THIRDS

_MOST_HELD = budget(3, "stretches of one motion", why="each bears an initial state of its own")


def same_quantity(model: Oscillator, recordings: Sequence[Recording]) -> None:
    """Raise BadInput where a recording does not show the motion in units of the model's response."""
    for recording in recordings:
        if not of_one_motion(recording, model.response):
            raise BadInput(
                f"{recording.name}: records {recording.quantity} in {recording.unit}, the model is of "
                f"{model.response.quantity} in {model.response.unit}; say what the column is with --quantity and --unit"
            )


def carries(recording: Recording, model: Oscillator) -> bool:
    """Whether a recording holds a decay or, where the mass is known, a driven stretch that can be fitted."""
    segments = cut([recording], natural_frequency([recording], model))
    return any(segment.force is None or model.mass is not None for segment in segments)


def why_unused(recording: Recording, model: Oscillator) -> str:
    """A sentence that says why a recording cannot be fitted."""
    motion = find_free_motion(recording)
    if motion.swell is not None:
        return motion.notes[0]
    frequency = natural_frequency([recording], model) / (2 * math.pi)
    cycles = recording.n * recording.dt * frequency
    noise = response_of(recording).noise
    loudness = float(np.std(recording.response)) / noise if noise > 0 else math.inf
    if cycles < FEWEST_SWINGS:
        why = f"too short: {cycles:.2g} cycles of {frequency:.3g} Hz; record at least {FEWEST_SWINGS:.0f}"
    elif loudness < SIGNIFICANT:
        why = f"too quiet: its response is {loudness:.2g} times its noise"
    elif model.mass is None and recording.force is not None:
        why = "driven, and the model has no mass to tell what a force does; no free decay was found in it"
    else:
        why = "neither a free decay nor a stretch driven by a recorded force was found in it"
        why += "; a decay falls by a tenth or more over five cycles or more"
    return f"{recording.name}: {why}"


def split(recordings: Sequence[Recording], model: Oscillator) -> tuple[list[Recording], list[Recording]]:
    """Of each recording stretches to learn from, and between them others to be judged on.

    A quiet end tells nothing of what depends on the amplitude. So of several decays, bursts or blows every third is
    held out; one decay, the ringing after one blow or two, and one driven record are cut into blocks of time, of which
    the middle one of each three is, so that large, middle and small motion are on both sides. A recording too short for
    that is learnt from whole.
    """
    training, held = [], []
    for recording in recordings:
        blocks = _blocks(recording, model)
        out = [block for block in blocks[1::3] if carries(block.of(recording), model)]
        kept = [block.of(recording) for block in _joined([block for block in blocks if block not in out])]
        if not (out and all(carries(block, model) for block in kept)):
            training.append(recording)
            continue
        held += [block.of(recording) for block in out]
        training += kept
    return training, held


class _Block(NamedTuple):
    """Samples start to stop of a recording; those of a free decay are known to be free, whatever the force shows."""

    start: int
    stop: int
    free: bool = False

    def of(self, recording: Recording) -> Recording:
        """The stretch as a recording of its own."""
        block = recording.slice(self.start, self.stop)
        first, last = (recording.start + i / recording.fs for i in (self.start, self.stop))
        name = f"{recording.name}, {first:.4g} to {last:.4g} s"
        return replace(block, name=name, free=self.free, force=None if self.free else block.force)


def _blocks(recording: Recording, model: Oscillator) -> list[_Block]:
    """Stretches that may be held out or not, in order of time; few are none."""
    motion = find_free_motion(recording)
    natural = natural_frequency([recording], model)
    cycle = 2 * math.pi / pace_of([recording], natural) * recording.fs
    of_each = [_even(decay.start, decay.stop, FEWEST_CYCLES * cycle, free=True) for decay in motion.decays]
    ringing = [block for blocks in of_each for block in blocks]
    undriven = recording.force is None or not np.any(recording.force) or motion.swell is not None
    if undriven or (motion.decays and force_is_silent(recording)):
        return [_Block(d.start, d.stop, free=True) for d in motion.decays] if len(motion.decays) >= THIRDS else ringing
    if len(motion.blows) >= THIRDS:
        return _between(0, *(max(0, round(blow.start - cycle / 2)) for blow in motion.blows[1:]), recording.n)
    if motion.blows and len(motion.decays) == len(motion.blows) and all(of_each):  # else a blow would be left out
        begins = {blow.stop: max(0, round(blow.start - cycle / 2)) for blow in motion.blows}
        return [_Block(begins[b.start], b.stop) if b.start in begins else b for b in ringing]
    if len(motion.decays) >= THIRDS:
        return _between(0, *(decay.stop for decay in motion.decays[:-1]), recording.n)
    rate = max(model.viscous.value / 2, LEAST_DAMPING * natural)
    if blocks := _even(0, recording.n, max(FEWEST_SWINGS * cycle, MEMORIES / rate * recording.fs)):
        return blocks
    at = recording.n * 2 // THIRDS  # the end of what is driven is as loud as its beginning
    return _between(0, recording.n) if recording.n - at < WORTH_ITS_START * cycle else _between(0, at, recording.n)


def _between(*edges: int, free: bool = False) -> list[_Block]:
    return [_Block(start, stop, free) for start, stop in pairwise(edges)]


def _even(start: int, stop: int, shortest: float, *, free: bool = False) -> list[_Block]:
    """Blocks of equal length, three or six or nine of them, each of `shortest` samples or more; none where none fit."""
    count = THIRDS * min(int((stop - start) / (THIRDS * shortest)), _MOST_HELD)
    return _between(*np.linspace(start, stop, count + 1).round().astype(int).tolist(), free=free) if count else []


def _joined(blocks: Sequence[_Block]) -> list[_Block]:
    """Blocks that follow one another as one; a blow begins one of its own after the ringing of another."""
    joined: list[_Block] = []
    for block in blocks:
        if joined and joined[-1].stop == block.start and joined[-1].free <= block.free:
            joined[-1] = joined[-1]._replace(stop=block.stop)
        else:
            joined.append(block)
    return joined
