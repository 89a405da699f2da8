"""libcosim through libcosimpy, co-simulation of FMI 2.0.

Traps:
    - It takes an FMU of FMI 3.0 as well and then ends the process with a segmentation fault; so FMI 2.0 alone here.
    - It cannot tell an FMU the slope of an input: the force is held.
    - Steps are whole nanoseconds, and the FMU is told sums of them.
    - An override acts from the next step on; initial values must be given before the first step, which is also the one
      that initialises, so that nothing can be read before it. A time series holds the initial sample nevertheless.
    - ``time_series_real_samples`` takes the step number 0 for an empty place and leaves out the last sample in its
      stead; asked from step 1 on it is complete.
    - It says everything on standard output unless told not to.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import CO_SIMULATION, describe

NEEDS = ("libcosimpy",)
INTERFACE = CO_SIMULATION
HOLDS = {2: ("zero",)}


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
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    if hold != "zero":
        raise NotImplementedError("libcosim holds inputs")
    known = describe(fmu)
    n = force.size
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(dt * 1e9))
    slave = CosimLocalSlave(str(fmu), "rig")
    index = execution.add_local_slave(slave)
    override, series = CosimManipulator.create_override(), CosimObserver.create_time_series(2 * n)
    execution.add_manipulator(override)
    execution.add_observer(series)
    watched = known.references[output]
    series.start_time_series(index, watched, CosimVariableType.REAL)
    starts = {**parameters, **({source: force[0]} if source else {})}
    for name, value in starts.items():
        execution.real_initial_value(index, known.references[name], float(value))
    for k in range(n - 1):
        if source:
            override.slave_real_values(index, [known.references[source]], [float(force[k])])
        if not execution.step():
            raise RuntimeError(f"step {k} failed: {execution.status()}")
    _, _, first = series.time_series_real_samples(index, watched, 0, 2)
    _, _, rest = series.time_series_real_samples(index, watched, 1, n - 1)
    return np.array([first[0], *rest])
