"""FMPy's ``simulate_fmu`` in co-simulation, FMI 2.0 and 3.0.

Traps:
    - FMPy joins the samples of a continuous input by straight lines, but sets the value at the communication point
      alone: what the FMU sees is held over the step. ``set_input_derivatives=True`` would tell it the slope, but has a
      buffer of nine values whatever the number of inputs, so that it raises (0.3.32).
    - Without ``output`` it records five outputs; with it, only what is named.
    - It goes through its list of input events at every step, so a grid with repeated times takes a time that grows with
      the square of its length. One row a sample has none.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import CO_SIMULATION, SLOPE, describe

NEEDS = ("fmpy",)
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
    from fmpy import simulate_fmu

    n = force.size
    time = np.arange(n) * dt
    columns = {"time": time}
    if source:
        columns[source] = force
    if SLOPE in describe(fmu).inputs:
        columns[SLOPE] = np.append(np.diff(force), 0.0) / dt if hold == "first" else np.zeros(n)
    signals = np.zeros(n, dtype=[(name, float) for name in columns])
    for name, column in columns.items():
        signals[name] = column
    result = simulate_fmu(
        str(fmu),
        start_time=0.0,
        stop_time=time[-1],
        output_interval=dt,
        fmi_type=INTERFACE,
        start_values=parameters,
        input=signals if len(columns) > 1 else None,
        output=[output],
    )
    return np.asarray(result[output])
