"""With smoothing an integrator that knows of no events comes the closer to the exact answer the less there is of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

CO_SIMULATION = "CoSimulation"
N, DT = 400, 1e-3
START = {"x0": 2e-3, "v0": 0.05, "dry": 3.0}
#: Part of the motion over which a sign changes.
SMOOTHING = (3e-2, 3e-3, 3e-4)


@pytest.fixture(scope="module")
def force() -> np.ndarray:
    """A burst, and a rest in which the mass sticks."""
    t = np.arange(N) * DT
    return 4.0 * np.sin(2 * np.pi * 12.0 * t) * (t < 0.2)


def exact(caller: Any, force: np.ndarray) -> np.ndarray:
    caller.start(**START, F=float(force[0]))
    response = [*caller.get("x")]
    for k in range(N - 1):
        caller.step(k * DT, DT, float(force[k]), float(force[k + 1]))
        response += caller.get("x")
    return np.array(response)


def without_events(caller: Any, force: np.ndarray, smoothing: float) -> np.ndarray:
    """(n,) response by an integrator of SciPy that asks for rates alone."""
    from scipy.integrate import solve_ivp

    caller.start(**START, F=float(force[0]), smoothing=smoothing)
    times = np.arange(N) * DT

    def rates(t: float, z: np.ndarray) -> list[float]:
        caller.fmu.setTime(t)
        caller.set(F=float(np.interp(t, times, force)))
        caller.set_states(z.tolist())
        return caller.rates()

    done = solve_ivp(rates, (0.0, times[-1]), caller.states(), "LSODA", times, rtol=1e-7, atol=1e-10, max_step=DT)
    response = []
    for t, z in zip(times, done.y.T, strict=True):
        rates(t, z)
        response += caller.get("x")
    return np.array(response)


@pytest.mark.parametrize(
    "effect", ["", "two-sided-stop", "hysteresis", "actuator-dead-zone", "actuator-backlash", "stribeck"]
)
def test_less_smoothing_is_closer(law_fmu, callers, force, effect):
    fmu = law_fmu(3, *([effect] if effect else []))
    expected = exact(callers(fmu, CO_SIMULATION), force)
    off = [np.max(np.abs(without_events(callers(fmu), force, s) - expected)) for s in SMOOTHING]
    assert off[0] > 3 * off[1] > 15 * off[2]
    assert off[2] < 1e-3 * np.max(np.abs(expected))


@pytest.mark.parametrize("version", [2, 3])
def test_nothing_sticks_and_only_turning_points_are_told(law_fmu, callers, version):
    """The slow creep instead of rest, and no event where the motion passes any other surface."""
    caller = callers(law_fmu(version, "clearance")).start(x0=1e-4, F=0.1, dry=3.0, smoothing=1e-3)
    assert abs(caller.rates()[1]) > 0.1  # sharp, it would stick
    assert caller.get("acceleration") == caller.rates()[1:]
    far = caller.indicators()
    caller.set_states([-5e-3, 1e-3])
    crossed = [j for j in range(caller.known.indicators) if caller.indicators()[j] <= 0]
    assert crossed == []
    caller.set_states([-5e-3, -1e-3])
    crossed = [j for j in range(caller.known.indicators) if caller.indicators()[j] <= 0]
    assert len(crossed) == 1
    assert not caller.event()
    assert min(caller.indicators()) > 0
    assert min(far) > 0


@pytest.mark.parametrize("version", [2, 3])
def test_co_simulation_stays_sharp(law_fmu, callers, version):
    """It locates its events itself, so that there is nothing to smooth."""
    runs = []
    for smoothing in (0.0, 0.1):
        caller = callers(law_fmu(version), CO_SIMULATION).start(x0=2e-3, dry=3.0, smoothing=smoothing)
        for k in range(100):
            caller.step(k * DT, DT, 0.3)
        runs.append(caller.get("x", "velocity", "acceleration", "dissipated_power"))
    assert runs[0] == runs[1]


@pytest.mark.parametrize("version", [2, 3])
def test_no_smoothing_below_zero(law_fmu, callers, version):
    from fmpy.fmi1 import FMICallException

    caller = callers(law_fmu(version)).start()
    with pytest.raises(FMICallException):
        caller.set(smoothing=-1e-3)
    assert "must be zero or positive" in caller.texts[-1]
    assert caller.get("smoothing") == [0.0]
