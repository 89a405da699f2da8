"""Event indicators: how many there are, that events change them, and that event mode leaves them settled."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest
from dashpot.model.equations import equations
from dashpot.model.laws import LIBRARY

EFFECTS = ["", *LIBRARY]
DT = 2.5e-4
N = 1600
START = {"x0": 1e-3, "v0": 0.05, "dry": 3.0}


def laws(effect: str) -> tuple[str, ...]:
    return (effect,) if effect else ()


def told(fmu: Any, how_many: str) -> int:
    """A number that the FMU itself tells; older FMPys have no method for these."""
    number = ctypes.c_size_t()
    getattr(fmu, how_many)(fmu.component, ctypes.byref(number))
    return number.value


def rush(t: float) -> float:
    """A force that goes through the resonance and rests from 0.2 s to 0.3 s."""
    return 0.01 if 0.2 <= t < 0.3 else 4.0 * float(np.sin(2 * np.pi * (8.0 * t + 10.0 * t**2)))


def moved(caller: Any, t: float, z: np.ndarray, h: float) -> np.ndarray:
    """One step of Heun's method; leaves the FMU at its end."""

    def rates(t: float, z: np.ndarray) -> np.ndarray:
        caller.fmu.setTime(t)
        caller.set(F=rush(t))
        caller.set_states(z.tolist())
        return np.array(caller.rates())

    first = rates(t, z)
    z = z + 0.5 * h * (first + rates(t + h, z + h * first))
    rates(t + h, z)
    return z


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect or "base")
def test_small_steps_see_every_indicator_settle(law_fmu, callers, with_law, effect):
    """Events are dealt with where the step ends, somewhat late, and are over when event mode is left."""
    caller = callers(law_fmu(3, *laws(effect)))
    count = len(equations(with_law(*laws(effect))).kinds)
    assert caller.known.indicators == told(caller.fmu, "fmi3GetNumberOfEventIndicators") == count
    caller.start(**START, F=rush(0.0))
    assert told(caller.fmu, "fmi3GetNumberOfContinuousStates") == len(caller.known.states)
    z, crossed, turned = np.array(caller.states()), 0, 0
    for k in range(N):
        assert min(caller.indicators()) > 0
        before = z[1]
        z = moved(caller, k * DT, z, DT)
        if min(caller.indicators()) > 0:
            assert before * z[1] >= 0  # no turning point is missed
            continue
        crossed += 1
        turned += before * z[1] <= 0
        changed = caller.event()
        settled = np.array(caller.states())
        assert changed == bool(np.any(settled != z))
        assert not changed or caller.rates()[:2] == [0.0, 0.0]  # it has come to rest, else it goes on from where it is
        assert min(caller.indicators()) > 0
        assert not caller.event()  # once more changes nothing
        assert caller.states() == settled.tolist()
        z = settled
    assert 10 < turned <= crossed < 120


@pytest.mark.parametrize("version", [2, 3])
def test_a_mass_breaks_away_where_the_force_exceeds_what_holds_it(law_fmu, callers, with_law, version):
    caller = callers(law_fmu(version)).start(x0=2e-4, dry=3.0)
    assert caller.rates() == [0.0, 0.0]
    m, w, c, b = (with_law().values()[name] for name in ("mass", "omega0", "cubic", "preload"))
    held = m * (3.0 + w**2 * 2e-4 + c * 8e-12 + b)
    least = []
    for force in (held * (1 - 1e-9), held * (1 + 1e-9)):
        caller.set(F=force)
        least.append(min(caller.indicators()))
        caller.event()
    assert least[0] > 0 > least[1]
    assert 0 < caller.rates()[1] < 1e-6
    assert min(caller.indicators()) > 0


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("force", [2.0, -2.0])
def test_a_jump_of_the_force_lets_it_go_at_once(law_fmu, callers, version, force):
    caller = callers(law_fmu(version)).start(x0=1e-4, dry=3.0)
    caller.set(F=force)
    assert min(caller.indicators()) < 0
    assert not caller.event()  # its states are what they were
    assert caller.rates()[1] * force > 1.0


@pytest.mark.parametrize("version", [2, 3])
def test_flights_at_the_seat_of_a_preloaded_spring_come_to_an_end(law_fmu, callers, version):
    """Infinitely many in finite time (Zeno): the integrator stops at rest, where co-simulation does."""
    from integrating import integrate

    start = {"x0": 5e-4, "preload": 8.0, "dry": 1.0, "viscous": 60.0}
    fmu, dt = law_fmu(version), 1e-3
    inside = callers(fmu, "CoSimulation").start(**start)
    expected = [*inside.get("x")]
    for k in range(159):
        inside.step(k * dt, dt)
        expected += inside.get("x")
    outside = callers(fmu)
    if version == 2:
        outside.fmu.setupExperiment(startTime=0.0)
    response = integrate(outside.model(), outside.known, np.zeros(160), dt, start, "first", "F", "x")
    assert inside.get("x", "velocity") == [0.0, 0.0]
    assert outside.get("x", "velocity") == [0.0, 0.0]
    assert outside.rates() == [0.0, 0.0]
    assert np.max(np.abs(response - expected)) <= 1e-6 * 5e-4


@pytest.mark.parametrize("version", [2, 3])
def test_an_actuator_that_saturates_tells_of_it(law_fmu, callers, version):
    """A surface of the force: below the limit the acceleration follows it, beyond it does not."""
    caller = callers(law_fmu(version, "actuator-saturation")).start(F=0.1, v0=0.5)
    name = "actuator-saturation.limit"
    (limit,) = caller.get(name)
    caller.set(F=2 * limit)
    assert min(caller.indicators()) < 0
    caller.event()
    assert min(caller.indicators()) > 0
    assert caller.derivative(["acceleration"], ["F"], [1.0]) == [0.0]
    caller.set(F=0.5 * limit)
    assert min(caller.indicators()) < 0
    caller.event()
    assert caller.derivative(["acceleration"], ["F"], [1.0])[0] > 1.0
