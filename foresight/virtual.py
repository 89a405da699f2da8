"""Recordings that a model would give: excited as planned, with the noise of the sensors, by the engine or another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..identify.problem.segments import FORCE_BAND
from ..identify.signals.registry import numerics
from ..model import Oscillator
from ..recording.recording import Recording
from ..simulate.core import core_of, step_for
from ..simulate.force import smooth_force
from .excitation import Excitation

DENSITY = numerics(60.0, "samples a cycle", why="ten harmonics are sampled six times each")

#: Gives the response (n,) of a model to an excitation at a rate in Hz, without noise.
Integrator = Callable[[Oscillator, Excitation, float], np.ndarray]


@dataclass(frozen=True)
class Noise:
    """Standard deviations of white noise: of the sensor, in the unit of the response, and of the force."""

    sensor: float
    force: float = 0.0


def simulated(model: Oscillator, played: Excitation, fs: float) -> np.ndarray:
    """The response (n,) of a model to an excitation, by the engine that also identifies.

    Raises:
        BadInput: where it runs away.
    """
    samples = played.signal(fs)
    decay = played.kind == "decay"
    natural = model.omega0.value / (2 * np.pi)
    force = None if decay else smooth_force(samples, 1 / fs, FORCE_BAND * natural)
    core = core_of(model)
    initial = np.zeros(core.states)
    reach = played.level
    if decay:
        initial[0] = played.level
    else:
        mass = 1.0 if model.mass is None else model.mass.value
        damping = max(model.viscous.value, 1e-3 * model.omega0.value)
        reach = played.level / (mass * damping * model.omega0.value)
    step = step_for(model, reach, samples.size / fs)
    response = core.record(np.array(list(model.values().values())), initial, force, samples.size, 1 / fs, step)
    if not np.all(np.isfinite(response)):
        raise BadInput(f"{model.name}: it runs away when you {played.sentence()}; ask for less amplitude or force")
    return response


def recordings_of_plan(
    model: Oscillator,
    played: Sequence[Excitation],
    clean: Sequence[np.ndarray],
    fs: float,
    noise: Noise,
    seed: Sequence[int],
) -> list[Recording]:
    """What would be recorded: the responses with noise of their own in each repetition.

    Args:
        model: whose response it is.
        played: what excites it.
        clean: (n,) the response to each, without noise.
        fs: samples a second.
        noise: of the sensors.
        seed: of the random numbers.
    """
    random = np.random.default_rng(seed)
    made = []
    for excitation, response in zip(played, clean, strict=True):
        force = None if excitation.kind == "decay" else excitation.signal(fs)
        for repeat in range(excitation.repeats):
            shown = response + noise.sensor * random.standard_normal(response.size)
            pushed = None if force is None else force + noise.force * random.standard_normal(response.size)
            made.append(
                Recording(
                    f"{excitation.kind} {len(made) + 1}"
                    if excitation.repeats == 1
                    else f"{excitation.kind} {repeat + 1}",
                    fs,
                    shown,
                    pushed,
                    model.response.quantity,
                    model.response.unit,
                    model.force_unit,
                    free=pushed is None,
                    hold=None if pushed is None else "smooth",
                )
            )
    return made


def natural_hz(model: Oscillator, amplitude: float) -> tuple[float, float]:
    """Least and largest natural frequency in Hz at amplitudes from a tenth of that on."""
    from ..identify.problem.equivalent import equivalent

    values, pace = model.values(), model.omega0.value
    found = [
        float(np.sqrt(max(equivalent(values, part * amplitude, pace)[0], 0.0))) / (2 * np.pi) for part in _AMPLITUDES
    ]
    low, high = min(found), max(found)
    if not low > 0.0:
        raise BadInput(f"{model.name}: it does not oscillate at {amplitude:.3g}; check the parameters")
    return low, high


_AMPLITUDES = numerics((0.1, 0.3, 1.0), "of the largest", why="a motion comes by all of them")


def without_errors(model: Oscillator) -> Oscillator:
    """The model as the truth of a virtual rig: values alone."""
    known = {name: replace(p, std=None) for name, p in model.parameters().items()}
    return model.with_parameters(known)
