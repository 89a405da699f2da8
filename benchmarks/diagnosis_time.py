"""How long one diagnosis takes: three training records of 40 s at 1 kHz, two held-out ones, the whole library.

    python benchmarks/diagnosis_time.py [LAW ...]

The rig is the paper's with one further law of a size that an engineer would notice. Beside the seconds stands the
number of times that all training records could have been simulated meanwhile, one after another: that ratio is the
method's own and does not depend on the machine.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping

import numpy as np
from dashpot.diagnose import diagnose
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step

FS, SECONDS = 1000.0, 40.0
#: Working amplitude, m, and parameters of each law, whose sizes follow from it and from the paper's rig.
AMPLITUDE = 4e-3
OMEGA = TRUTH["omega0"]
SPRING = OMEGA**2 * AMPLITUDE
LAWS: dict[str, Mapping[str, float]] = {
    "nothing": {},
    "quadratic-drag": {"coefficient": 8.0},
    "two-sided-stop": {"stiffness": 5 * OMEGA**2, "position": 0.7 * AMPLITUDE, "damping": 0.0, "offset": 0.0},
    "stribeck": {"excess": 0.03 * SPRING, "speed": 0.05 * OMEGA * AMPLITUDE, "exponent": 1.0},
    "hysteresis": {"stiffness": 0.2 * OMEGA**2, "limit": 0.1 * AMPLITUDE, "exponent": 1.0, "loading": 0.5},
    "actuator-lag": {"time": 0.03 * 2 * np.pi / OMEGA},
}


def rig(law: str, random: np.random.Generator) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of the paper's rig with a law in it."""
    model = Oscillator.from_values(TRUTH)
    if law != "nothing":
        model = with_term(model, law, LAWS[law])
    core, values = core_of(model), np.array(list(model.values().values()))
    n = round(SECONDS * FS)
    t = np.arange(n) / FS
    f = OMEGA / (2 * np.pi)
    longest = internal_step(model, model.values(), AMPLITUDE)

    def sweep(low: float, high: float) -> np.ndarray:
        return np.sin(2 * np.pi * (low * f * t + 0.5 * (high - low) * f * t**2 / SECONDS))

    lines = np.arange(round(0.6 * f * 10), round(1.5 * f * 10)) / 10
    multisine = np.sin(2 * np.pi * np.outer(t, lines) + random.uniform(0, 2 * np.pi, lines.size)).sum(axis=1)
    shapes: dict[str, tuple[np.ndarray | None, float]] = {
        "sweep_high": (sweep(0.6, 1.6), 1.0),
        "sweep_low": (sweep(1.6, 0.6), 0.35),
        "ringdown": (None, 1.0),
        "holdout_multisine": (multisine / np.max(np.abs(multisine)), 0.8),
        "holdout_sweep": (sweep(0.7, 1.5), 0.6),
    }

    def response(shape: np.ndarray | None, force: float) -> np.ndarray:
        start = [AMPLITUDE if shape is None else 0.0] + [0.0] * (core.states - 1)
        return core.record(values, np.array(start), None if shape is None else force * shape, n, 1 / FS, longest)

    level = _level(lambda force: float(np.max(np.abs(response(shapes["sweep_high"][0], force)))))
    recordings = []
    for name, (shape, part) in shapes.items():
        x = response(shape, part * level) + 0.002 * AMPLITUDE * random.standard_normal(n)
        force = None if shape is None else part * level * (shape + 0.001 * random.standard_normal(n))
        recordings.append(Recording(name=name, fs=FS, response=x, force=force))
    return recordings[:3], recordings[3:]


def _level(peak: Callable[[float], float]) -> float:
    """The force that brings the strong sweep to the working amplitude."""
    low, high = 1e-4, 1e2
    for _ in range(40):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if peak(middle) < AMPLITUDE else (low, middle)
    return float(np.sqrt(low * high))


def measure(law: str) -> tuple[float, float, str]:
    """Seconds of a diagnosis, the same in simulations of the training records, and its verdict."""
    training, held_out = rig(law, np.random.default_rng(5))
    model = identify(training, name="rig").oscillator
    data = data_of(training, model)
    structure = Structure(model, data)
    state = settled(structure.problem, structure.state(None))
    began = time.perf_counter()
    for segment, initial in zip(data.segments, state.initial, strict=True):
        core_of(model).record(
            structure.values, initial, segment.force, segment.n, segment.dt, structure.problem.max_step
        )
    once = time.perf_counter() - began
    began = time.perf_counter()
    diagnosis = diagnose(model, training, held_out)
    spent = time.perf_counter() - began
    named = ", ".join(effect.law for effect in diagnosis.effects)
    return spent, spent / once, diagnosis.verdict + (f": {named}" if named else "")


def main(laws: list[str]) -> None:
    """Print a line for each law."""
    print(f"{'concealed':28} {'seconds (asked 60)':>20} {'simulations':>12}   verdict")
    for law in laws or LAWS:
        spent, ratio, verdict = measure(law)
        print(f"{law:28} {spent:20.1f} {ratio:12.0f}   {verdict}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
