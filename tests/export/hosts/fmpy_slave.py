"""FMPy's classes for one FMU, ``FMU2Slave`` and ``FMU3Slave``, called as a simulator would: the loop is ours.

Traps:
    - ``FMU2Slave`` goes to the library's folder to load it and comes back only when that worked.
    - ``FMU3Slave.doStep`` returns what happened instead of a status, and raises where the status is above a warning.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import CO_SIMULATION
from fmpy_instance import opened
from stepping import Slave, march

NEEDS = ("fmpy",)
INTERFACE = CO_SIMULATION
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
        slave = Slave(
            instance.enterInitializationMode,
            instance.exitInitializationMode,
            instance.setReal if known.version == 2 else instance.setFloat64,
            instance.getReal if known.version == 2 else instance.getFloat64,
            (lambda vr, rate: instance.setRealInputDerivatives(vr, [1], rate)) if known.interpolates else None,
            instance.doStep,
        )
        return march(slave, known, force, dt, parameters, hold, source, output)
