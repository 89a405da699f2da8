"""The noise floor: what a perfect model would leave of a recording, and the pieces of one that can be simulated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..identify.decays import Decay, find_decays, force_is_silent
from ..identify.offsets import zero_of_load_cell
from ..identify.replay import force_of, natural_frequency, replay
from ..identify.signals import noise_levels
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
    is taken for what it shows at zero.
    """
    decays, (sensor, level) = find_decays(recording), noise_levels(recording)  # which more samples tell better
    if recording.force is None or not np.any(recording.force) or (decays and force_is_silent(recording)):
        free = [changed(recording.slice(decay.start, decay.stop), force=None) for decay in decays]
        return [Piece(part, (Decay(0, part.n),), sensor, np.zeros(part.n)) for part in free]
    force = np.array(recording.force, float)
    noise = np.full(force.size, level)
    zero = zero_of_load_cell(force, recording.fs, natural_frequency(recording)) if decays else 0.0
    for decay in decays:
        force[decay.start : decay.stop], noise[decay.start : decay.stop] = zero, 0.0
    return [Piece(changed(recording, force=force) if decays else recording, decays, sensor, noise)]


def floor_of_model(model: Oscillator, piece: Piece) -> float:
    """Rms that noise alone leaves: the sensor's, and that of the force as the model passes some more of it on."""
    if not np.any(piece.force):
        return piece.sensor
    noise = piece.force * np.random.default_rng(0).standard_normal(piece.force.size)
    noisy = changed(piece.recording, force=np.asarray(piece.recording.force) + noise)
    difference = replay(model, noisy) - replay(model, piece.recording)
    moved = float(np.sqrt(np.mean(difference**2)))
    return float(np.hypot(piece.sensor, moved)) if np.isfinite(moved) else piece.sensor
