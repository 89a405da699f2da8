"""PathSim's ``ModelExchangeFMU`` (pathsim-fmi) with its own Dormand-Prince pair, FMI 2.0 and 3.0.

Traps:
    - As in ``pathsim_cosimulation``, everything is a real, and inputs are ports in the order of the description.
    - Its solvers ask for stages at the end of a step: a force that is held jumps there, and they see the wrong side of
      it. A force in straight lines is continuous; hence that alone, with steps that end at the samples.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE, describe

NEEDS = ("pathsim", "pathsim_fmi")
INTERFACE = MODEL_EXCHANGE
HOLDS = {2: ("first",), 3: ("first",)}


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
    from pathsim import Connection, Simulation
    from pathsim.blocks import Scope, Source
    from pathsim.solvers import RKDP54
    from pathsim_fmi import ModelExchangeFMU

    if hold != "first":
        raise NotImplementedError("the solvers of PathSim see the force from the wrong side where it jumps")
    known = describe(fmu)
    time = np.arange(force.size) * dt
    block = ModelExchangeFMU(str(fmu), start_values=parameters)
    scope = Scope(sampling_period=dt)
    blocks, wires = [block, scope], [Connection(block[output], scope)]
    if source in known.inputs:
        blocks.append(Source(lambda t: np.interp(t, time, force)))
        wires.append(Connection(blocks[-1], block[source]))
    simulation = Simulation(
        blocks, wires, dt=dt, dt_max=dt, Solver=RKDP54, log=False, tolerance_lte_rel=1e-10, tolerance_lte_abs=1e-12
    )
    simulation.run(time[-1])
    _, shown = scope.read()
    return shown[0][: force.size]
