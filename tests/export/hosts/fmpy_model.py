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
    with opened(fmu, INTERFACE) as (known, instance):
        count, second = len(known.states), known.version == 2
        update = instance.newDiscreteStates if second else instance.updateDiscreteStates

        def settle() -> None:
            while update()[0]:
                pass

        def taken(call, size: int) -> list[float]:
            buffer = (ctypes.c_double * size)()
            call(buffer, size)
            return list(buffer)

        model = Model(
            instance.enterInitializationMode,
            instance.exitInitializationMode,
            instance.setReal if second else instance.setFloat64,
            instance.getReal if second else instance.getFloat64,
            instance.setTime,
            lambda x: instance.setContinuousStates((ctypes.c_double * count)(*x), count),
            lambda: taken(instance.getContinuousStates, count),
            lambda: taken(instance.getDerivatives if second else instance.getContinuousStateDerivatives, count),
            lambda: taken(instance.getEventIndicators, known.indicators),
            instance.enterEventMode,
            settle,
            instance.enterContinuousTimeMode,
            lambda: instance.completedIntegratorStep()[0],
        )
        return integrate(model, known, force, dt, parameters, hold, source, output)
