"""A model run along a recording, from the initial state that suits it best."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..model import Oscillator
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from ..simulate.core import core_of, internal_step
from ..simulate.force import Force, smooth_force
from .hilbert import dominant_frequency, noise_level
from .segments import FORCE_BAND, first_motion, starts_at_rest

_ROUNDS = 4
#: Stretches, in cycles, over which the initial state is found, each starting from the last. A forced motion
#: forgets its start; a free decay remembers it throughout.
_STRETCHES = (3.0, 12.0)
_FORCED_STRETCH = 30.0

#: A simulator: initial displacement and velocity (2,), number of samples -> (n,) response.
Simulator = Callable[[np.ndarray, int], np.ndarray]


def natural_frequency(recording: Recording) -> float:
    """The frequency at which the recorded thing mostly moves, rad/s."""
    return 2 * np.pi * dominant_frequency(np.asarray(recording.response, float), recording.fs)


def force_of(recording: Recording) -> Force | None:
    """The recorded force as the smooth signal it is; None where there is none or it is zero throughout."""
    if recording.force is None or not np.any(recording.force):
        return None
    highest = FORCE_BAND * natural_frequency(recording) / (2 * np.pi)
    return smooth_force(np.asarray(recording.force, float), recording.dt, highest)


def initial_state(simulator: Simulator, recording: Recording) -> np.ndarray:
    """Displacement and velocity (2,) at the first sample that bring a simulation closest to the recording.

    Zero where the recording starts at rest; else Gauss-Newton over growing stretches.
    """
    measured = np.asarray(recording.response, float)
    omega = natural_frequency(recording)
    if starts_at_rest(measured, recording.dt, omega, noise_level(measured, recording.fs)):
        return np.zeros(2)
    scale = float(np.std(measured)) * np.array([1.0, omega]) / omega ** QUANTITIES.index(recording.quantity)
    initial = np.zeros(2)
    if recording.quantity == "displacement":
        initial = first_motion(measured, recording.dt, omega)[0]
    forced = recording.force is not None and np.any(recording.force)
    cycle = 2 * np.pi / omega * recording.fs
    for cycles in (*_STRETCHES, _FORCED_STRETCH if forced else np.inf):
        n = int(min(max(cycles * cycle, 8), recording.n))
        for _ in range(_ROUNDS):
            base = simulator(initial, n)
            before = float(np.sum((measured[:n] - base) ** 2))
            columns = [(simulator(initial + 1e-4 * scale * unit, n) - base) / 1e-4 for unit in np.eye(2)]
            jacobian = np.array(columns).T
            if not np.all(np.isfinite(jacobian)):
                break
            trial = initial + np.linalg.lstsq(jacobian, measured[:n] - base)[0] * scale
            gain = before - float(np.sum((measured[:n] - simulator(trial, n)) ** 2))
            if not gain > 0:
                break
            initial = trial
            if gain < 1e-6 * before:
                break
    return initial


def replay(oscillator: Oscillator, recording: Recording) -> np.ndarray:
    """(n,) response of a model to the force of a recording, in the recording's quantity; NaN from where it diverges."""
    core = core_of(oscillator)
    values = np.array(list(oscillator.values().values()))
    peak = float(np.max(np.abs(recording.response))) / natural_frequency(recording) ** QUANTITIES.index(
        recording.quantity
    )
    step = internal_step(oscillator, oscillator.values(), peak)
    force = force_of(recording)

    def simulator(initial: np.ndarray, n: int) -> np.ndarray:
        return core.record(values, initial, force, n, recording.dt, step, start=recording.start)

    return simulator(initial_state(simulator, recording), recording.n)
