"""Ecos through ecospy, co-simulation: an FMU by itself, or several in an SSP archive.

Traps:
    - Its library needs oneTBB (`libtbb.so.12`, on Debian `libtbb12`), which the wheel does not bring.
    - It cannot tell an FMU of FMI 2.0 the slope of an input: the force is held.
    - The first value of a variable is there after ``init``; a value that is set acts in the next step.
    - Of an SSP archive it knows neither connectors nor parameters of the system itself: each connection is from one
      component to another, and values stand in the components. The archives of ``dashpot export`` it refuses therefore.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from described import CO_SIMULATION, SLOPE
from machines import NotHereError

NEEDS = ("ecospy",)
INTERFACE = CO_SIMULATION
HOLDS = {2: ("zero",), 3: ("zero", "first")}


def run(
    fmu: Path,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    *,
    output: str = "x",
) -> np.ndarray:
    """(n,) output at the samples of the force."""
    structure_of, simulation_of = _library()
    structure = structure_of()
    structure.add_model("rig", str(fmu))
    structure.add_parameter_set("given", {f"rig::{name}": float(value) for name, value in parameters.items()})
    simulation = simulation_of(dt, structure=structure)
    simulation.init(parameter_set="given")
    response = [simulation.get_real(f"rig::{output}")]
    for now, after in pairwise(force):
        simulation.set_real("rig::F", float(now))
        if hold == "first":
            simulation.set_real(f"rig::{SLOPE}", float((after - now) / dt))
        simulation.step()
        response.append(simulation.get_real(f"rig::{output}"))
    simulation.terminate()
    return np.array(response)


def archive(
    fmu: Path, force: np.ndarray, dt: float, parameters: dict[str, float], hold: str, *, outputs: list[str], values: str
) -> np.ndarray:
    """(outputs, n) of an SSP archive (in the place of an FMU) with that set of values, over as many steps."""
    _, simulation_of = _library()
    simulation = simulation_of(dt, ssp_path=str(fmu))
    simulation.init(parameter_set=values)
    response = [[simulation.get_real(name) for name in outputs]]
    for _ in force[1:]:
        simulation.step()
        response.append([simulation.get_real(name) for name in outputs])
    simulation.terminate()
    return np.array(response).T


def _library() -> tuple[Any, Any]:
    try:
        from ecospy import EcosSimulation, EcosSimulationStructure
    except OSError as problem:
        raise NotHereError(f"ecospy finds no library: {problem}") from problem
    return EcosSimulationStructure, EcosSimulation
