"""CasADi's import of model exchange (``DaeBuilder``), FMI 2.0 and 3.0, integrated by its Runge-Kutta method.

Traps:
    - It never enters event mode: after initialization it goes to continuous-time mode and stays. A right-hand side that
      waits for events to change its signs keeps those of the start; one with no surface in it is what can be compared.
    - Tunable parameters are set in continuous-time mode, at every evaluation: an FMU that takes them in event mode
      alone cannot be evaluated as soon as it has one. Fixed ones are constants of the import.
    - Start values of states are the integrator's argument; x0 and v0 of the FMU do not matter.
    - Outputs must be states, derivatives or variables of their own; all must be reals, and dependencies written out:
      what is not listed counts as zero in its Jacobians, silently.
    - The Jacobian wants directional derivatives; without them it is made of differences.
    - States too are set by their value references in continuous-time mode, never by the call for continuous states.
    - An input is one value per interval of the output grid, which is a held force. CVodes goes on across its jumps
      without a fresh start: its error test fails at tight tolerances, and at others it is off by 1e-5, also for a
      right-hand side of CasADi's own. The fixed-step ``rk`` ends its steps at the jumps.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from described import MODEL_EXCHANGE, describe

NEEDS = ("casadi",)
INTERFACE = MODEL_EXCHANGE
HOLDS = {2: ("zero",), 3: ("zero",)}
#: Which start value stands for which state.
_STARTS = ("x0", "v0")
#: Steps of the classical fourth-order method in one interval.
_STEPS = 4


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
    """(n,) output at the samples of the force; ``x0`` and ``v0`` among the parameters start the states."""
    import casadi as ca

    if hold != "zero":
        raise NotImplementedError("CasADi's integrators hold inputs over an interval")
    known = describe(fmu)
    builder = ca.DaeBuilder("rig", str(fmu))
    state = [float(np.ravel(builder.start(name))[0]) for name in builder.x()]
    for i, name in enumerate(_STARTS[: len(state)]):
        state[i] = parameters.get(name, state[i])
    unknown = set(parameters) - {*builder.p(), *_STARTS}
    if unknown:
        raise KeyError(f"not among the parameters that CasADi can set: {sorted(unknown)}")
    p = [parameters.get(name, float(np.ravel(builder.start(name))[0])) for name in builder.p()]
    rates = builder.create("rates", ["t", "x", "z", "p", "u"], ["ode", "alg", "quad", "zero"])
    outputs = builder.create("outputs", ["t", "x", "u", "p"], ["y"])
    time = np.arange(force.size) * dt
    options = {"number_of_finite_elements": _STEPS * (force.size - 1)}
    flow = ca.integrator("flow", "rk", rates, 0.0, time[1:].tolist(), options)
    u = np.zeros((len(builder.u()), force.size))
    if source:
        u[builder.u().index(source)] = force
    x = np.column_stack([state, np.array(flow(x0=state, p=p, u=u[:, :-1])["xf"])])
    row = known.outputs.index(output)
    return np.array([float(outputs(time[i], x[:, i], u[:, i], p)[row]) for i in range(force.size)])
