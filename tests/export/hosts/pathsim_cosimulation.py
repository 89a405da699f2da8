"""PathSim's ``CoSimulationFMU`` (pathsim-fmi), FMI 2.0 and 3.0.

Traps:
    - It sets and reads all inputs and outputs as reals by their value references, whatever their type.
    - The block steps its FMU at t = 0, T, 2T, ... over the interval that follows, so that what it shows at kT is the
      output at (k + 1)T: one step early. The initial sample is to be had from the fresh block alone.
    - Inputs are ports in the order of the description; one that is not connected is set to zero at every step.
    - A source is asked at kT give or take a rounding; it has to round the same way as the samples were meant.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import CO_SIMULATION, SLOPE, describe

NEEDS = ("pathsim", "pathsim_fmi")
INTERFACE = CO_SIMULATION
HOLDS = {2: ("zero",), 3: ("zero", "first")}


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
    """(n,) output at the samples of the force; with an extra input for its slope, a first-order hold too."""
    from pathsim import Connection, Simulation
    from pathsim.blocks import Scope, Source
    from pathsim_fmi import CoSimulationFMU

    known = describe(fmu)
    if hold == "first" and SLOPE not in known.inputs:
        raise NotImplementedError("the block cannot tell the FMU a slope")
    rate = np.append(np.diff(force), 0.0) / dt
    block = CoSimulationFMU(str(fmu), start_values=parameters, dt=dt)
    start = block.outputs.to_array()[known.outputs.index(output)]
    scope = Scope()
    blocks, wires = [block, scope], [Connection(block[output], scope)]
    signals = {source: force, SLOPE: rate} if hold == "first" else {source: force}
    for name, signal in signals.items():
        if name in known.inputs:
            blocks.append(Source(lambda t, signal=signal: signal[min(round(t / dt), signal.size - 1)]))
            wires.append(Connection(blocks[-1], block[name]))
    Simulation(blocks, wires, dt=dt, log=False).run((force.size - 1) * dt)
    _, shown = scope.read()
    return np.append(start, shown[0])[: force.size]
