"""FMPy's classes for model exchange, ``FMU2Model`` and ``FMU3Model``, under an integrator of our own.

Trap: states, derivatives and indicators go through buffers of C doubles that the caller makes.
"""

from __future__ import annotations

import ctypes
import shutil
from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE, describe
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
    from fmpy import extract
    from fmpy.fmi2 import FMU2Model
    from fmpy.fmi3 import FMU3Model

    known = describe(fmu)
    folder = extract(str(fmu))
    names = {
        "guid": known.token,
        "unzipDirectory": folder,
        "modelIdentifier": known.identifiers[INTERFACE],
        "instanceName": "rig",
    }
    count, indicators = len(known.states), known.indicators
    second = known.version == 2
    try:
        it = FMU2Model(**names) if second else FMU3Model(**names)
        it.instantiate()
        if second:
            it.setupExperiment(startTime=0.0)
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
            lambda: taken(it.getEventIndicators, indicators),
            it.enterEventMode,
            settle,
            it.enterContinuousTimeMode,
            lambda: it.completedIntegratorStep()[0],
        )
        x = integrate(model, known, force, dt, parameters, hold, source, output)
        it.terminate()
        it.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return x
