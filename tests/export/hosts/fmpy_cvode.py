"""FMPy's ``simulate_fmu`` in model exchange with its CVode, FMI 2.0 and 3.0.

Traps:
    - CVode's right-hand side does not set the input: it is set when a step is over and where event indicators are
      looked at. A force that changes continuously is late by a step of the integrator; one that jumps from sample to
      sample, each jump an event, is exact. Hence a held force alone.
    - A jump is a time given twice. FMPy goes through its list of them at every step, so the time grows with the square
      of their number: a few hundred samples are enough.
    - The integrator is started afresh after each event and may take no more than 500 steps from one to the next.
    - Nominal values of the states times the tolerance are the absolute tolerance; nominals of one, and a motion of
      millimetres has three digits fewer than asked.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE

NEEDS = ("fmpy",)
INTERFACE = MODEL_EXCHANGE
HOLDS = {2: ("zero",), 3: ("zero",)}
_TOLERANCE = 1e-12


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
    from fmpy import simulate_fmu

    if hold != "zero":
        raise NotImplementedError("FMPy's CVode does not follow an input between samples")
    n = force.size
    signals = None
    if source:
        held = np.repeat(np.arange(n), 2)
        signals = np.zeros(2 * n - 1, dtype=[("time", float), (source, float)])
        signals["time"] = held[1:] * dt
        signals[source] = force[held[:-1]]
    result = simulate_fmu(
        str(fmu),
        start_time=0.0,
        stop_time=(n - 1) * dt,
        output_interval=dt,
        relative_tolerance=_TOLERANCE,
        solver="CVode",
        record_events=False,
        fmi_type=INTERFACE,
        start_values=parameters,
        input=signals,
        output=[output],
    )
    return np.asarray(result[output])
