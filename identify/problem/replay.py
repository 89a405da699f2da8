"""A model run along a recording, from the initial state that suits it best."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...model import Oscillator
from ...model.law import InnerState, Scales
from ...model.oscillator import QUANTITIES
from ...recording.recording import Recording
from ...simulate.core import core_of, step_for
from ...simulate.force import Force, force_between
from ..motion.first_motion import first_motion, starts_at_rest
from ..signals.odds import DECISIVE
from ..signals.registry import budget, numerics
from ..signals.signals import response_of
from .initial_motion import from_first_cycle
from .limits import FEWEST_SAMPLES
from .offset import centre, drift_of, zero_of_load_cell
from .segments import FORCE_BAND
from .state_limits import nearest_reach

_ROUNDS = budget(4, "rounds", why="of Gauss and Newton: each squares what is left")
_STRETCHES = numerics((3.0, 12.0), "cycles", why="over which an initial state is found, each starting from the last")
_FORCED_STRETCH = numerics(
    30.0, "cycles", why="a forced motion forgets its start; a free decay remembers it throughout"
)
_PHASES = numerics(3, "starts", why="for a phase: the nearest is within a sixth of a turn")
_AT_REST = numerics(1e-6, "part of the power left", why="what gains less has come to rest")

#: A simulator: initial states (states,), number of samples, what the load cell shows at zero -> (n,) response.
Simulator = Callable[[np.ndarray, int, float], np.ndarray]
#: The same with the load behind the states, (states + 1,).
_Run = Callable[[np.ndarray, int], np.ndarray]


@dataclass(frozen=True, eq=False)
class Replay:
    """How a model runs along a recording, and what the sensors show besides: no part of the motion.

    Attributes:
        initial: (states,) at the first sample.
        response: (n,) as the sensor would show it.
        zero: what the sensor shows at zero, in the middle of the recording; in the response's unit.
        drift: by how much that moves a second.
        load: what the load cell shows at zero, in the force's unit.
    """

    initial: np.ndarray
    response: np.ndarray
    zero: float = 0.0
    drift: float = 0.0
    load: float = 0.0

    def shown(self, dt: float) -> np.ndarray:
        """(n,) of the response what is the sensor's."""
        return self.zero + self.drift * dt * _places(self.response.size)


def _places(n: int) -> np.ndarray:
    """(n,) samples counted from the middle."""
    return np.arange(n) - 0.5 * (n - 1)


def natural_frequency(recording: Recording) -> float:
    """The frequency at which the recorded thing mostly moves, rad/s."""
    return 2 * np.pi * response_of(recording).frequency


def force_of(recording: Recording) -> Force | None:
    """The recorded force between its samples, smooth where its hold is not known; None where it is zero throughout."""
    if recording.force is None or not np.any(recording.force):
        return None
    highest = FORCE_BAND * natural_frequency(recording) / (2 * np.pi)
    return force_between(np.asarray(recording.force, float), recording.dt, recording.hold or "smooth", highest)


def run_along(
    simulator: Simulator,
    recording: Recording,
    inner: Sequence[InnerState] = (),
    reaches: np.ndarray | None = None,
) -> Replay:
    """A simulation from the displacement, velocity and inner states that bring it closest to the recording.

    At rest where the recording starts so, but for states that are free even there (phases, which are searched from
    several starts); else Gauss-Newton over growing stretches. The zero of a record is no part of its motion: what the
    sensor shows at zero is left out, its drift where the means over cycles show one, and what the load cell shows at
    zero where its own signal is not centred about zero.

    Args:
        simulator: of the model.
        recording: what it should reproduce.
        inner: the model's inner states.
        reaches: (2 + inner,) how far the states can go, 0 without a limit; None where that is not known.
    """
    measured = np.asarray(recording.response, float)
    omega = natural_frequency(recording)
    size = float(np.std(measured)) / omega ** QUANTITIES.index(recording.quantity)
    pushed = float(np.max(np.abs(recording.force))) if recording.force is not None else 0.0
    forced = pushed > 0.0
    scales = Scales(size, omega, pushed or 1.0, float(np.std(measured)), recording.n * recording.dt)
    # behind the states what the load cell shows at zero
    scale = np.array([size, size * omega, *(scales.of(state.unit) for state in inner), pushed or 1.0])
    initial = np.zeros(scale.size)
    phases = [2 + i for i, state in enumerate(inner) if state.free]

    def run(candidate: np.ndarray, n: int) -> np.ndarray:
        return simulator(candidate[:-1], n, float(candidate[-1]))

    rest = float(run(initial, 1)[0])  # a sensor may show a mass at rest to be elsewhere than at zero
    moved = measured - (rest if np.isfinite(rest) else 0.0)
    if forced and starts_at_rest(moved, recording.dt, omega, response_of(recording).noise):
        own = phases
    else:
        own = list(range(scale.size - 1))
    cycle = 2 * np.pi / omega * recording.fs
    lengths = [
        int(min(max(cycles * cycle, FEWEST_SAMPLES), recording.n))
        for cycles in (*_STRETCHES, np.inf if phases or not forced else _FORCED_STRETCH)
    ]

    def misfit(candidate: np.ndarray, n: int) -> float:
        power = _power(measured[:n] - run(candidate, n))
        return power if np.isfinite(power) else np.inf

    if len(own) == scale.size - 1:
        begins = _begins(moved, recording, omega)
        initial[:2] = min(begins, key=lambda begin: misfit(np.append(begin, initial[2:]), lengths[0]))
    if phases:
        turns = [initial.copy() for _ in range(_PHASES)]
        for k, turn in enumerate(turns):
            turn[phases] = 2 * np.pi * k / _PHASES
        initial = min(turns, key=lambda turn: misfit(turn, lengths[-1]))
    if reaches is not None:
        initial = nearest_reach(initial, np.append(reaches, 0.0), own, lambda candidate: misfit(candidate, lengths[0]))
    unlimited = [k for k in own if reaches is None or not reaches[k] > 0]
    for n in lengths if own else []:
        if unlimited != own:  # a state at its limit has no derivative, and would spoil the step of the others
            initial = _grown(run, measured[:n], initial, unlimited, scale)
        initial = _grown(run, measured[:n], initial, own, scale)
    load = zero_of_load_cell(np.asarray(recording.force, float), recording.fs, omega) if forced else 0.0
    if load:  # or a force that truly has a constant part: the motion tells
        loaded = np.append(initial[:-1], load)
        loaded = _closest(run, measured, loaded, [*own, scale.size - 1], scale)
        left, left_loaded = misfit(initial, recording.n), misfit(loaded, recording.n)
        # a cycle counts for one amplitude and phase: what a wrong model leaves repeats itself from sample to sample
        if recording.n / cycle * np.log(left / left_loaded) > DECISIVE:
            initial = loaded
    return _beside(run, recording, initial, omega)


def _beside(run: _Run, recording: Recording, initial: np.ndarray, omega: float) -> Replay:
    """The run from there, with what the sensor shows at zero and, where its middle goes on in time, its drift."""
    measured, places = np.asarray(recording.response, float), _places(recording.n)
    response, drift = run(initial, recording.n), 0.0
    residual = measured - response
    zero = float(np.mean(residual))
    if not np.isfinite(zero):
        return Replay(initial[:-1], response, load=float(initial[-1]))
    if drift_of([(0.0, recording.dt, measured, residual)], omega):
        drift = float(places @ residual / (places @ places))
    return Replay(initial[:-1], response + zero + drift * places, zero, drift / recording.dt, float(initial[-1]))


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


def _straightened(residual: np.ndarray) -> np.ndarray:
    """What a simulation leaves (..., n), but for a constant and a drift: those are the sensor's."""
    places = _places(residual.shape[-1])
    middle = np.mean(residual, axis=-1, keepdims=True)
    slope = residual @ places / max(float(places @ places), 1.0)
    return residual - middle - slope[..., None] * places


def _power(residual: np.ndarray) -> float:
    """Of what a simulation leaves, the sensor's zero and drift aside."""
    return float(np.sum(_straightened(residual) ** 2))


def _grown(run: _Run, measured: np.ndarray, initial: np.ndarray, own: list[int], scale: np.ndarray) -> np.ndarray:
    """As ``_closest``; from where a motion runs away it is followed first as long as it does not, and then farther."""
    reached = 0
    while reached < (lasts := _lasts(run(initial, measured.size))) < measured.size:
        reached = lasts
        initial = _closest(run, measured[: max(lasts // 2, FEWEST_SAMPLES)], initial, own, scale)
    return _closest(run, measured, initial, own, scale)


def _lasts(response: np.ndarray) -> int:
    """Samples before a response is no number."""
    lost = np.flatnonzero(~np.isfinite(response))
    return int(lost[0]) if lost.size else response.size


def _closest(run: _Run, measured: np.ndarray, initial: np.ndarray, own: list[int], scale: np.ndarray) -> np.ndarray:
    """Gauss-Newton in the states ``own``, as long as it gains."""
    n = measured.size
    for _ in range(_ROUNDS):
        base = run(initial, n)
        before = _power(measured - base)
        steps = np.diag(1e-4 * scale)[own]
        jacobian = np.array([(run(initial + step, n) - base) / 1e-4 for step in steps])
        if not np.all(np.isfinite(jacobian)):
            break
        trial = initial.copy()
        trial[own] += np.linalg.lstsq(_straightened(jacobian).T, _straightened(measured - base))[0] * scale[own]
        gain = before - _power(measured - run(trial, n))
        if not gain > 0:
            break
        initial = trial
        if gain < _AT_REST * before:
            break
    return initial


def replay(oscillator: Oscillator, recording: Recording) -> np.ndarray:
    """(n,) response of a model to the force of a recording, in the recording's quantity; NaN from where it diverges.

    What the sensors show at zero is in it.
    """
    return replayed(oscillator, recording).response


def replayed(oscillator: Oscillator, recording: Recording) -> Replay:
    """As ``replay``, with where it begins and what the sensors show at zero."""
    core = core_of(oscillator)
    differs = dict(recording.differs)
    values = np.array([value + differs.get(name, 0.0) for name, value in oscillator.values().items()])
    peak = float(np.max(np.abs(recording.response))) / natural_frequency(recording) ** QUANTITIES.index(
        recording.quantity
    )
    step = step_for(oscillator, peak, recording.duration)
    force = force_of(recording)

    def simulator(initial: np.ndarray, n: int, load: float) -> np.ndarray:
        pushed = force.shifted(-load) if force is not None and load else force
        return core.record(
            values, initial, pushed, n, recording.dt, step, start=recording.start, quantity=recording.quantity
        )

    return run_along(simulator, recording, core.equations.inner, core.reaches(values))
