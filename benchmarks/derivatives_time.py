"""What derivatives that go along with a run cost, in plain runs of the same core taken in turn.

python benchmarks/derivatives_time.py
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, oscillator_with
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import Force, smooth_force

DT, N, ROUNDS = 1e-3, 60_000, 15
#: Derivatives in one run.
COUNT = 8
#: At most so many plain runs.
AIM = 4.0


def seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def ratio(model: Oscillator, begin: tuple[float, float], force: Force | None) -> float:
    """The least time of a run with derivatives over that of a plain one, both of the same recording."""
    core, values = core_of(model), np.array(list(model.values().values()))
    initial = np.zeros(core.states)
    initial[:2] = begin
    step = internal_step(model, model.values(), 9e-3)
    recording = (values, initial, force, N, DT, step)
    by = list(range(COUNT))
    core.record_with_derivatives(*recording, by=by)  # compiled
    turns = [
        (
            seconds(lambda: core.record(*recording)),
            seconds(lambda: core.record_with_derivatives(*recording, by=by)),
        )
        for _ in range(ROUNDS)
    ]
    plain, carried = (min(column) for column in zip(*turns, strict=True))
    return carried / plain


def rows() -> Iterator[tuple[str, float]]:
    """What was run with eight derivatives, and how many plain runs it costs."""
    t = np.arange(N) * DT
    force = smooth_force(np.sin(2 * np.pi * (5.0 * t + 7.5 * t**2 / t[-1])), DT, 100.0)
    rigs = {
        "Eq. 17": {},
        "with quadratic drag": {"quadratic-drag.coefficient": 1.0},
        "with an attached resonator": {
            "attached-resonator.mass-ratio": 0.1,
            "attached-resonator.frequency": 120.0,
            "attached-resonator.damping": 2.0,
        },
    }
    for name, values in rigs.items():
        effects = tuple({key.partition(".")[0] for key in values})
        model = oscillator_with({**TRUTH, **values}, effects=effects)
        yield f"{name}, under a sweep", ratio(model, (0.0, 0.0), force)
        yield f"{name}, released", ratio(model, (9e-3, 0.0), None)


if __name__ == "__main__":
    for what, measured in rows():
        print(f"{what:50} at most {AIM:.1f} {measured:8.2f}")
