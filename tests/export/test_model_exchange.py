"""An integrator that locates the events that an FMU tells of comes to where its co-simulation comes, for every law."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from dashpot.model.laws import LIBRARY

CO_SIMULATION = "CoSimulation"
DT = 1e-3
N = 800
START = {"x0": 1e-3, "v0": 0.05, "dry": 3.0}
#: What moves less, or is driven less: a force far beyond the limit goes through a soft one faster than the steps, and
#: far beyond the reach of a learnt map it is many times the recorded one.
WEAKER = {"actuator-saturation": 0.4, "actuator-saturation/soft": 0.4, "free/drive/6": 0.4, "free/drive/12": 0.4}
#: Of the peak.
CLOSE = 1e-6
EFFECTS = ["", *LIBRARY]
#: Surfaces of every kind: of x, of x', of the force, of inner states, of the force of a stop.
SOME = ["", "two-sided-stop", "hysteresis", "actuator-dead-zone", "actuator-saturation", "tonal-disturbance"]


def laws(effect: str) -> tuple[str, ...]:
    return (effect,) if effect else ()


@pytest.fixture(scope="module")
def force() -> np.ndarray:
    """A sweep through the resonance that rests for a while, so that the mass sticks and breaks away."""
    t = np.arange(N) * DT
    force = 4.0 * np.sin(2 * np.pi * (8.0 * t + 5.0 * t**2))
    force[300:600] = 0.01
    return force


def stepped(caller: Any, force: np.ndarray, hold: str, **start: float) -> np.ndarray:
    """(n, 2) response and velocity of co-simulation."""
    caller.start(**START | start, F=float(force[0]))
    rows = [caller.get("x", "velocity")]
    for k in range(force.size - 1):
        caller.step(k * DT, DT, float(force[k]), float(force[k + 1]) if hold == "first" else None)
        rows.append(caller.get("x", "velocity"))
    return np.array(rows)


def exchanged(caller: Any, force: np.ndarray, hold: str, **start: float) -> np.ndarray:
    """(n,) response, integrated from outside at other steps than the FMU's own."""
    from integrating import integrate

    if caller.second:
        caller.fmu.setupExperiment(startTime=0.0)
    steps = math.ceil(DT / caller.known.values["max_step"]) + 1
    return integrate(caller.model(), caller.known, force, DT, START | start, hold, "F", "x", steps)


def compare(callers: Any, fmu: Any, force: np.ndarray, hold: str, effect: str) -> np.ndarray:
    """Both ways alike; what they came to."""
    part = WEAKER.get(effect, 1.0)
    force, start = part * force, {"dry": part * START["dry"]}
    inside = stepped(callers(fmu, CO_SIMULATION), force, hold, **start)
    outside = exchanged(callers(fmu), force, hold, **start)
    x = inside[:, 0]
    assert np.max(np.abs(outside - x)) <= CLOSE * np.max(np.abs(x))
    return inside


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect or "base")
def test_every_law(law_fmu, callers, force, effect):
    rows = compare(callers, law_fmu(3, *laws(effect)), force, "first", effect)
    stuck = np.flatnonzero(rows[:, 1] == 0.0)
    if effect != "actuator-backlash":  # whose own mass keeps it moving
        assert stuck.size >= 5
        assert stuck[-1] - stuck[0] >= stuck.size  # it moves in between
    part = WEAKER.get(effect, 1.0)
    plain = stepped(callers(law_fmu(3), CO_SIMULATION), part * force, "first", dry=part * START["dry"])
    assert (np.max(np.abs(rows - plain)[:, 0]) > 1e-3 * np.max(np.abs(plain[:, 0]))) == bool(effect)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("effect", SOME, ids=lambda effect: effect or "base")
def test_a_force_that_jumps(law_fmu, callers, force, effect, version):
    compare(callers, law_fmu(version, *laws(effect)), force[250:550], "zero", effect)


@pytest.mark.parametrize("effect", SOME, ids=lambda effect: effect or "base")
def test_fmi2(law_fmu, callers, force, effect):
    compare(callers, law_fmu(2, *laws(effect)), force, "first", effect)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
@pytest.mark.parametrize("effects", [(), ("sensor-lag",)])
def test_another_response(law_fmu, callers, force, effects, quantity, version):
    """A lag behind an accelerometer feels the mass stick."""
    compare(callers, law_fmu(version, *effects, quantity=quantity), force, "first", "")
