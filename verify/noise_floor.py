"""The noise floor: what a perfect model would leave of a recording, and the pieces of one that can be simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..identify.motion.decays import Decay, find_free_motion, force_is_silent
from ..identify.problem.limits import WORTH_ITS_START
from ..identify.problem.offset import zero_of_load_cell
from ..identify.problem.replay import force_of, natural_frequency, replay
from ..identify.problem.segments import known_parts
from ..identify.signals.odds import HALF_AGAIN
from ..identify.signals.signals import noise_levels
from ..model import Oscillator
from ..recording.fact import changed
from ..recording.recording import Recording
from ..simulate.force import Force


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a recording that is simulated in one go, and the noise in it.

    Attributes:
        recording: of that part; its force without its noise where the motion is free.
        decays: the free motion in it.
        sensor: standard deviation of the response's noise.
        force: (n,) that of the force; zero where the motion is free.
    """

    recording: Recording
    decays: tuple[Decay, ...]
    sensor: float
    force: np.ndarray

    def disturbed(self, random: np.random.Generator) -> Force | None:
        """The force with as much noise once more."""
        if not np.any(self.force):
            return force_of(self.recording)
        noise = self.force * random.standard_normal(self.force.size)
        return force_of(changed(self.recording, force=np.asarray(self.recording.force, float) + noise))


def pieces(recording: Recording) -> list[Piece]:
    """What can be simulated of a recording: all of it where a force drives it, else its free decays.

    A column that holds nothing but noise drives nothing, and no force drives a free decay: what the channel shows there
    is taken for what it shows at zero. Where the force of a hammer's blow is not known, each blow stands for itself:
    with what it set going, or that alone.
    """
    motion, (sensor, level) = find_free_motion(recording), noise_levels(recording)  # which more samples tell better
    decays, blows = motion.decays, motion.blows
    if recording.force is None or not np.any(recording.force) or (decays and force_is_silent(recording)):
        parts = [part for decay in decays for part in _known(recording, decay.start, decay.stop)]
        return [_free(recording, Decay(*part), sensor) for part in parts]
    if all(blow.is_known for blow in blows):
        return [_driven(recording, *part, decays, sensor, level) for part in _known(recording, 0, recording.n)]
    known = {blow.stop: blow for blow in blows if blow.is_known}
    before = round(np.pi / 2 / natural_frequency(recording) * recording.fs)
    return [
        _driven(recording, max(0, known[decay.start].start - before), decay.stop, decays, sensor, level)
        if decay.start in known
        else _free(recording, decay, sensor)
        for decay in decays
    ]


def _known(recording: Recording, start: int, stop: int) -> list[tuple[int, int]]:
    """Parts of a stretch along which what drives it is known, but for those that say no more than how they begin."""
    parts = known_parts(recording, start, stop)
    if len(parts) < 2:
        return parts
    shortest = WORTH_ITS_START * 2 * np.pi / natural_frequency(recording) * recording.fs
    return [(a, b) for a, b in parts if b - a >= shortest]


def _free(recording: Recording, decay: Decay, sensor: float) -> Piece:
    part = changed(recording.slice(decay.start, decay.stop), force=None)
    return Piece(part, (Decay(0, part.n),), sensor, np.zeros(part.n))


def _driven(recording: Recording, start: int, stop: int, decays: Sequence[Decay], sensor: float, level: float) -> Piece:
    """Samples start to stop, the force's channel at its zero in the free decays among them."""
    whole = (start, stop) == (0, recording.n)
    part = recording if whole else recording.slice(start, stop)
    inside = tuple(Decay(d.start - start, d.stop - start) for d in decays if start <= d.start and d.stop <= stop)
    force, noise = np.array(part.force, float), np.full(part.n, level)
    zero = zero_of_load_cell(force, recording.fs, natural_frequency(recording)) if inside else 0.0
    for decay in inside:
        force[decay.start : decay.stop], noise[decay.start : decay.stop] = zero, 0.0
    return Piece(changed(part, force=force) if inside else part, inside, sensor, noise)


def floor_of_model(model: Oscillator, piece: Piece, left: float = np.inf) -> float:
    """Rms that noise alone leaves: the sensor's, and that of the force as the model passes some more of it on.

    No more than some model leaves, rms, of which ``left`` is the least: a force may show signal where noise is sought.
    """
    if not np.any(piece.force):
        return piece.sensor
    noise = piece.force * np.random.default_rng(0).standard_normal(piece.force.size)
    noisy = changed(piece.recording, force=np.asarray(piece.recording.force) + noise)
    difference = replay(model, noisy) - replay(model, piece.recording)
    moved = float(np.sqrt(np.mean(difference**2)))
    floor = float(np.hypot(piece.sensor, moved)) if np.isfinite(moved) else piece.sensor
    return floor if floor <= HALF_AGAIN * left else max(piece.sensor, left)
