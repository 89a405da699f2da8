"""The noise floor: what a perfect model would leave of a recording, and the pieces of one that can be simulated."""

from __future__ import annotations

import numpy as np

from ..identify.decays import find_decays
from ..identify.replay import replay
from ..identify.signals import noise_levels
from ..model import Oscillator
from ..recording.fact import changed
from ..recording.recording import Recording
from ..simulate.force import Force
from .fmu_run import FmuRun


def pieces(recording: Recording) -> list[Recording]:
    """What can be simulated of a recording: all of it where the force is known, else its free decays."""
    if recording.force is not None and np.any(recording.force):
        return [recording]
    return [recording.slice(decay.start, decay.stop) for decay in find_decays(recording)]


def floor_of_model(model: Oscillator, recording: Recording) -> float:
    """Rms that noise alone leaves: the sensor's, and that of the force as the model passes some more of it on."""
    sensor, level = noise_levels(recording)
    if recording.force is None or not np.any(recording.force):
        return sensor
    random = np.random.default_rng(0)
    noisy = changed(recording, force=np.asarray(recording.force) + level * random.standard_normal(recording.n))
    difference = replay(model, noisy) - replay(model, recording)
    moved = float(np.sqrt(np.mean(difference**2)))
    return float(np.hypot(sensor, moved)) if np.isfinite(moved) else sensor


def floor_of_fmu(
    run: FmuRun, recording: Recording, force: Force | None, initial: np.ndarray, simulated: np.ndarray
) -> float:
    """The same of an FMU that gave the response ``simulated`` (n,) from the state ``initial`` (states,)."""
    sensor, level = noise_levels(recording)
    if force is None or level == 0.0:
        return sensor
    disturbed = force.disturbed(level, np.random.default_rng(0), recording.dt)
    other = run.record(disturbed, recording.n, recording.dt, initial, recording.start, run.output_for(recording))
    return float(np.hypot(sensor, float(np.sqrt(np.mean((other - simulated) ** 2)))))
