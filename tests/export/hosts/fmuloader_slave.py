"""fmuloader in co-simulation, FMI 2.0 and 3.0.

Traps:
    - It looks up every function of the standard when it loads, those of model exchange and clocks too: with one of them
      missing the FMU does not load at all.
    - It reads no modelDescription.xml; references and the name of the library are the caller's business.
    - A status of discard is returned, not raised: a step that was not done goes unnoticed unless one looks.
    - It is a release candidate: pip takes it only where the version is named.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import CO_SIMULATION, Described, describe
from stepping import Slave, march

NEEDS = ("fmuloader",)
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
    known = describe(fmu)
    instance, slave = _second(fmu, known) if known.version == 2 else _third(fmu, known)
    x = march(slave, known, force, dt, parameters, hold, source, output)
    instance.terminate()
    instance.free_instance()
    return x


def _second(fmu: Path, known: Described):
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    instance = Fmi2Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    instance.instantiate("rig", Fmi2Type.CO_SIMULATION, guid=known.token)
    instance.setup_experiment(start_time=0.0)
    incline = (lambda vr, rate: instance.set_real_input_derivatives(vr, [1], rate)) if known.interpolates else None

    def step(t: float, dt: float) -> None:
        if instance.do_step(t, dt) != 0:
            raise RuntimeError(f"the step from {t} s was not done")

    enter, leave = instance.enter_initialization_mode, instance.exit_initialization_mode
    return instance, Slave(enter, leave, instance.set_real, instance.get_real, incline, step)


def _third(fmu: Path, known: Described):
    from fmuloader.fmi3 import Fmi3Slave

    instance = Fmi3Slave(fmu, model_identifier=known.identifiers[INTERFACE])
    instance.instantiate_co_simulation("rig", instantiation_token=known.token)

    def step(t: float, dt: float) -> None:
        done = instance.do_step(t, dt)
        if done.status != 0 or done.terminate_simulation or done.early_return:
            raise RuntimeError(f"the step from {t} s was not done, or not to its end")

    enter, leave = instance.enter_initialization_mode, instance.exit_initialization_mode
    return instance, Slave(enter, leave, instance.set_float64, instance.get_float64, None, step)
