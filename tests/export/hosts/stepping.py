"""The loop of a simulator in co-simulation, over the few calls in which importers differ."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from described import SLOPE, Described


@dataclass(frozen=True)
class Slave:
    """An instance before its initialization mode, as its calls.

    ``incline`` sets first derivatives of inputs; None where the interface has none.
    """

    enter_initialization: Callable[[], object]
    exit_initialization: Callable[[], object]
    put: Callable[[Sequence[int], Sequence[float]], object]
    take: Callable[[Sequence[int]], Sequence[float]]
    incline: Callable[[Sequence[int], Sequence[float]], object] | None
    step: Callable[[float, float], object]


def march(
    slave: Slave,
    known: Described,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    source: str,
    output: str,
) -> np.ndarray:
    """(n,) output at the samples of the force, which is held over each step or runs in a straight line."""
    inputs = [known.references[source]] if source else []
    outputs = [known.references[output]]
    slope = [known.references[SLOPE]] if SLOPE in known.inputs else None
    slave.enter_initialization()
    if parameters:
        slave.put([known.references[name] for name in parameters], list(parameters.values()))
    if inputs:
        slave.put(inputs, [force[0]])
    slave.exit_initialization()
    x = np.empty(force.size)
    x[0] = slave.take(outputs)[0]
    for k in range(force.size - 1):
        rate = (force[k + 1] - force[k]) / dt
        if inputs:
            slave.put(inputs, [force[k]])
        if hold == "first" and slope:
            slave.put(slope, [rate])
        elif hold == "first" and slave.incline:
            slave.incline(inputs, [rate])
        elif hold == "first":
            raise NotImplementedError("neither the importer nor the FMU can be told a slope")
        slave.step(k * dt, dt)
        x[k + 1] = slave.take(outputs)[0]
    return x
