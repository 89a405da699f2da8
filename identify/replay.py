"""A model run along a recording, from the initial state that suits it best."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..model import Oscillator
from ..model.law import InnerState, Scales
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from ..simulate.core import core_of, internal_step
from ..simulate.force import Force, force_between
from .initial_motion import from_first_cycle
from .offsets import centre
from .reach import nearest_reach
from .segments import FORCE_BAND, first_motion, starts_at_rest
from .signals import response_of

_ROUNDS = 4
#: Stretches, in cycles, over which the initial state is found, each starting from the last. A forced motion
#: forgets its start; a free decay remembers it throughout.
_STRETCHES = (3.0, 12.0)
_FORCED_STRETCH = 30.0
#: Starts for a phase: with three of them the nearest is within a sixth of a turn.
_PHASES = 3

#: A simulator: initial displacement and velocity (2,), number of samples -> (n,) response.
Simulator = Callable[[np.ndarray, int], np.ndarray]


def natural_frequency(recording: Recording) -> float:
    """The frequency at which the recorded thing mostly moves, rad/s."""
    return 2 * np.pi * response_of(recording).frequency


def force_of(recording: Recording) -> Force | None:
    """The recorded force between its samples, smooth where its hold is not known; None where it is zero throughout."""
    if recording.force is None or not np.any(recording.force):
        return None
    highest = FORCE_BAND * natural_frequency(recording) / (2 * np.pi)
    return force_between(np.asarray(recording.force, float), recording.dt, recording.hold or "smooth", highest)


def initial_state(
    simulator: Simulator,
    recording: Recording,
    inner: Sequence[InnerState] = (),
    force_size: float = 1.0,
    reaches: np.ndarray | None = None,
) -> tuple[np.ndarray, float]:
    """Displacement, velocity and inner states at the first sample that bring a simulation closest to the recording.

    With it what the sensor shows at zero beside the simulation: the zero of a record is no part of its motion.

    At rest where the recording starts so, but for states that are free even there (phases, which are searched from
    several starts); else Gauss-Newton over growing stretches.

    Args:
        simulator: of the model; takes what this returns, (2 + inner,).
        recording: what it should reproduce.
        inner: the model's inner states.
        force_size: typical force, for inner states that are forces.
        reaches: (2 + inner,) how far the states can go, 0 without a limit; None where that is not known.
    """
    measured = np.asarray(recording.response, float)
    omega = natural_frequency(recording)
    size = float(np.std(measured)) / omega ** QUANTITIES.index(recording.quantity)
    scales = Scales(size, omega, force_size, float(np.std(measured)), recording.n * recording.dt)
    scale = np.array([size, size * omega, *(scales.of(state.unit) for state in inner)])
    initial = np.zeros(scale.size)
    phases = [2 + i for i, state in enumerate(inner) if state.free]
    rest = float(simulator(initial, 1)[0])  # a sensor may show a mass at rest to be elsewhere than at zero
    moved = measured - (rest if np.isfinite(rest) else 0.0)
    if starts_at_rest(moved, recording.dt, omega, response_of(recording).noise):
        own = phases
    else:
        own = list(range(scale.size))
    if not own:
        return initial, _shown(measured - simulator(initial, recording.n))
    forced = recording.force is not None and bool(np.any(recording.force))
    cycle = 2 * np.pi / omega * recording.fs
    lengths = [
        int(min(max(cycles * cycle, 8), recording.n))
        for cycles in (*_STRETCHES, np.inf if phases or not forced else _FORCED_STRETCH)
    ]

    def misfit(candidate: np.ndarray, n: int) -> float:
        power = _power(measured[:n] - simulator(candidate, n))
        return power if np.isfinite(power) else np.inf

    if len(own) == scale.size:
        begins = _begins(moved, recording, omega)
        initial[:2] = min(begins, key=lambda begin: misfit(np.append(begin, initial[2:]), lengths[0]))
    if phases:
        turns = [initial.copy() for _ in range(_PHASES)]
        for k, turn in enumerate(turns):
            turn[phases] = 2 * np.pi * k / _PHASES
        initial = min(turns, key=lambda turn: misfit(turn, lengths[-1]))
    if reaches is not None:
        initial = nearest_reach(initial, reaches, own, lambda candidate: misfit(candidate, lengths[0]))
    unlimited = [k for k in own if reaches is None or not reaches[k] > 0]
    for n in lengths:
        if unlimited != own:  # a state at its limit has no derivative, and would spoil the step of the others
            initial = _closest(simulator, measured[:n], initial, unlimited, scale)
        initial = _closest(simulator, measured[:n], initial, own, scale)
    return initial, _shown(measured - simulator(initial, recording.n))


def _begins(moved: np.ndarray, recording: Recording, omega: float) -> list[np.ndarray]:
    """Displacements and velocities (2,) at the first sample, as the beginning of the motion (n,) shows them.

    Free motion is centred where the sensor shows zero. A drive with a constant part moves the mass away from there, and
    so does a sensor that rests elsewhere: only the simulation tells the one from the other.
    """
    if recording.quantity != "displacement":
        return [np.array(from_first_cycle(moved, recording.dt, omega, recording.quantity))]
    begin = first_motion(moved, recording.dt, omega)[0]
    about = begin - np.array([centre(moved, recording.fs, omega), 0.0])
    driven = recording.force is not None and np.any(recording.force)
    return [begin, about] if driven else [about]


def _power(residual: np.ndarray) -> float:
    """Of what a simulation leaves, but for a constant."""
    return float(np.sum((residual - np.mean(residual)) ** 2))


def _shown(residual: np.ndarray) -> float:
    """What the sensor shows at zero."""
    shown = float(np.mean(residual))
    return shown if np.isfinite(shown) else 0.0


def _closest(
    simulator: Simulator, measured: np.ndarray, initial: np.ndarray, own: list[int], scale: np.ndarray
) -> np.ndarray:
    """Gauss-Newton in the states ``own``, as long as it gains."""
    n = measured.size
    for _ in range(_ROUNDS):
        base = simulator(initial, n)
        before = _power(measured - base)
        steps = np.diag(1e-4 * scale)[own]
        jacobian = np.array([(simulator(initial + step, n) - base) / 1e-4 for step in steps]).T
        if not np.all(np.isfinite(jacobian)):
            break
        trial = initial.copy()
        residual = measured - base
        trial[own] += (
            np.linalg.lstsq(jacobian - np.mean(jacobian, axis=0), residual - np.mean(residual))[0] * scale[own]
        )
        gain = before - _power(measured - simulator(trial, n))
        if not gain > 0:
            break
        initial = trial
        if gain < 1e-6 * before:
            break
    return initial


def replay(oscillator: Oscillator, recording: Recording) -> np.ndarray:
    """(n,) response of a model to the force of a recording, in the recording's quantity; NaN from where it diverges.

    What the sensor shows at zero is in it.
    """
    return replayed(oscillator, recording)[0]


def replayed(oscillator: Oscillator, recording: Recording) -> tuple[np.ndarray, np.ndarray, float]:
    """As ``replay``, the initial state (states,) that it ran from, and what the sensor shows at zero."""
    core = core_of(oscillator)
    values = np.array(list(oscillator.values().values()))
    peak = float(np.max(np.abs(recording.response))) / natural_frequency(recording) ** QUANTITIES.index(
        recording.quantity
    )
    step = internal_step(oscillator, oscillator.values(), peak)
    force = force_of(recording)

    def simulator(initial: np.ndarray, n: int) -> np.ndarray:
        return core.record(
            values, initial, force, n, recording.dt, step, start=recording.start, quantity=recording.quantity
        )

    size = 1.0 if force is None or recording.force is None else float(np.max(np.abs(recording.force)))
    initial, shown = initial_state(simulator, recording, core.equations.inner, size, core.reaches(values))
    return simulator(initial, recording.n) + shown, initial, shown
