"""A model predictive controller makes the rig follow a small sine: by all that was identified, or by a linear model.

The plant is the FMU under FMPy, with located events. Both controllers are one CasADi Opti program, with the same
weights; they differ in the step that predicts: the smooth step of the export, or A and B about a motion of the
reference's amplitude. What the linear one cannot know is that the preload pushes off the middle at every crossing.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...model import Oscillator
from ...model.linear import linearise
from ..rig_fmu import RigFmu

SAMPLE, HORIZON = 1e-2, 20  # s; steps
AMPLITUDE, FREQUENCY = 1e-4, 5.0  # m, Hz, of the reference
LIMIT = 0.5  # N
#: Of the cost: displacement against the amplitude, force against its limit.
WEIGHTS = (1.0, 1e-4)


def reference(t: np.ndarray) -> np.ndarray:
    """Displacement to follow, (n,) m."""
    return AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * t)


def predictor(model: Oscillator, folder: Path, *, linear: bool) -> Callable[[Any, Any], Any]:
    """State after a sample time under a held force, as CasADi expressions: of the whole model or the linear one."""
    import casadi as ca

    from ...export import export

    if linear:
        a, b = linearise(model, amplitude=AMPLITUDE, frequency=FREQUENCY).discrete(SAMPLE)
        return lambda x, u: ca.DM(a) @ x + ca.DM(b) * u
    export(model, folder / "rig.casadi", step=SAMPLE)
    step = ca.Function.load(str(folder / "rig.smooth.step.casadi"))  # all that a controller's machine needs
    return lambda x, u: step(x=x, u=u)["x_next"]


def controller(predict: Callable[[Any, Any], Any]) -> Callable[[np.ndarray, np.ndarray], float]:
    """Force (N) from the state (2,) and the reference (HORIZON,) of the coming samples."""
    import casadi as ca

    opti = ca.Opti()
    x, u = opti.variable(2, HORIZON + 1), opti.variable(HORIZON)
    now, wanted = opti.parameter(2), opti.parameter(HORIZON)
    scale = np.array([AMPLITUDE, AMPLITUDE * 2 * np.pi * FREQUENCY])
    opti.subject_to(x[:, 0] == now / scale)
    for k in range(HORIZON):
        opti.subject_to(x[:, k + 1] == predict(x[:, k] * scale, u[k]) / scale)
    opti.subject_to(opti.bounded(-LIMIT, u, LIMIT))
    miss = x[0, 1:].T - wanted / AMPLITUDE
    opti.minimize(WEIGHTS[0] * ca.sumsqr(miss) + WEIGHTS[1] * ca.sumsqr(u / LIMIT))
    opti.solver("ipopt", {"expand": True, "print_time": False}, {"print_level": 0, "sb": "yes"})

    def force(state: np.ndarray, ahead: np.ndarray) -> float:
        opti.set_value(now, state)
        opti.set_value(wanted, ahead)
        solution = opti.solve()
        opti.set_initial(x, solution.value(x))
        opti.set_initial(u, solution.value(u))
        return float(solution.value(u)[0])

    return force


def follow(fmu: Path, force: Callable[[np.ndarray, np.ndarray], float], seconds: float) -> np.ndarray:
    """Displacement (n,), m, of the FMU at the samples under that controller."""
    plant, motion = RigFmu(fmu), []
    for k in range(round(seconds / SAMPLE) + 1):
        state = np.array(plant.get("displacement", "velocity"))
        motion.append(state[0])
        plant.push(force(state, reference(SAMPLE * (k + 1 + np.arange(HORIZON)))))
        plant.step(SAMPLE)
    plant.end()
    return np.array(motion)
