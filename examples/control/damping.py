"""LQR with a Kalman filter stops the rig by a displacement with noise; the filter decides how well it is known.

The plant is the FMU under FMPy. Two designs with the same weights and noise: of A and B about the motion
(``linearise``), and of the smooth law's Jacobian at rest, whose tanh takes friction for a strong damper and the preload
for a strong spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...model import Oscillator
from ...model.linear import linearise
from ..rig_fmu import RigFmu

SAMPLE = 1e-3  # s
START = 5e-4  # m
NOISE = 5e-6  # m, standard deviation of the sensor
FORCE_NOISE = 5e-3  # N, of what the linear model does not know
LIMIT = 0.5  # N at the start's amplitude, as the regulator weighs it


@dataclass(frozen=True, eq=False)
class Regulator:
    """Discrete model, gain of the regulator (2,) and of the filter (2,)."""

    a: np.ndarray
    b: np.ndarray
    gain: np.ndarray
    filter: np.ndarray


def about_motion(model: Oscillator) -> tuple[np.ndarray, np.ndarray]:
    """A (2, 2) and B (2, 1) from sample to sample about a motion of half the start's amplitude."""
    return linearise(model, amplitude=START / 2).discrete(SAMPLE)


def at_rest(model: Oscillator) -> tuple[np.ndarray, np.ndarray]:
    """The same by the Jacobian of the smooth step at rest."""
    from ...export.casadi_functions import functions
    from ...export.facts import Facts

    jacobian = functions(Facts(model), SAMPLE).by_suffix["smooth.step.casadi"].jacobian()(x=[0, 0], u=0)
    return np.array(jacobian["jac_x_next_x"]), np.array(jacobian["jac_x_next_u"]).sum(axis=1, keepdims=True)


def regulator(a: np.ndarray, b: np.ndarray) -> Regulator:
    """LQR and stationary Kalman filter of a discrete model."""
    from scipy.linalg import solve_discrete_are

    c = np.array([[1.0, 0.0]])
    cost = solve_discrete_are(a, b, np.diag([1.0 / START**2, 0.0]), np.array([[1.0 / LIMIT**2]]))
    gain = np.linalg.solve(b.T @ cost @ b + 1.0 / LIMIT**2, b.T @ cost @ a)
    spread = solve_discrete_are(a.T, c.T, FORCE_NOISE**2 * b @ b.T + 1e-18 * np.eye(2), np.array([[NOISE**2]]))
    kalman = spread @ c.T / (c @ spread @ c.T + NOISE**2)
    return Regulator(a, b, gain[0], kalman[:, 0])


def run(fmu: Path, design: Regulator | None, seconds: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """State (n, 2) of the FMU and the filter's (n, 2), from a start at ``START``; without a design it rings."""
    random = np.random.default_rng(0)
    plant, states, known = RigFmu(fmu, x0=START), [], []
    estimate, force = np.array([START, 0.0]), 0.0
    for _ in range(round(seconds / SAMPLE)):
        state = np.array(plant.get("displacement", "velocity"))
        if design is not None:
            estimate = estimate + design.filter * (state[0] + NOISE * random.standard_normal() - estimate[0])
            force = -float(design.gain @ estimate)
        states.append(state)
        known.append(estimate)
        plant.push(force)
        plant.step(SAMPLE)
        if design is not None:
            estimate = design.a @ estimate + design.b[:, 0] * force
    plant.end()
    return np.array(states), np.array(known)
