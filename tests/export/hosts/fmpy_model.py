"""FMPy's classes for model exchange, ``FMU2Model`` and ``FMU3Model``, under an integrator of our own.

Trap: states, derivatives and indicators go through buffers of C doubles that the caller makes.
"""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE
from fmpy_instance import opened
from integrating import Model, integrate

NEEDS = ("fmpy",)
INTERFACE = MODEL_EXCHANGE
HOLDS = {2: ("zero", "first"), 3: ("zero", "first")}


def run(
    fmu: Path,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    *,
    source: str = "F",
    output: str = "x",
) -> np.ndarray:
    """(n,) output at the samples of the force."""
    with opened(fmu, INTERFACE) as (known, it):
        count, second = len(known.states), known.version == 2
        update = it.newDiscreteStates if second else it.updateDiscreteStates

        def settle() -> None:
            while update()[0]:
                pass

        def taken(call, size: int) -> list[float]:
            buffer = (ctypes.c_double * size)()
            call(buffer, size)
            return list(buffer)

        model = Model(
            it.enterInitializationMode,
            it.exitInitializationMode,
            it.setReal if second else it.setFloat64,
            it.getReal if second else it.getFloat64,
            it.setTime,
            lambda x: it.setContinuousStates((ctypes.c_double * count)(*x), count),
            lambda: taken(it.getContinuousStates, count),
            lambda: taken(it.getDerivatives if second else it.getContinuousStateDerivatives, count),
            lambda: taken(it.getEventIndicators, known.indicators),
            it.enterEventMode,
            settle,
            it.enterContinuousTimeMode,
            lambda: it.completedIntegratorStep()[0],
        )
        return integrate(model, known, force, dt, parameters, hold, source, output)
