"""FMI 3.0: states kept and brought back, reset, any step, parameters in a run, and every refusal with its reason."""

from __future__ import annotations

import ctypes
import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

CO_SIMULATION, MODEL_EXCHANGE = "CoSimulation", "ModelExchange"
DT = 1e-3
DISCARD, ERROR = 2, 3
OUTPUTS = ("x", "displacement", "velocity", "acceleration", "energy", "dissipated_power", "amplitude", "outside_range")
MEMORY = ("hysteresis", "actuator-lag")


@pytest.fixture
def fmu(law_fmu, callers):
    """An instance for co-simulation, before its initialization mode."""

    def make(*effects: str, interface: str = CO_SIMULATION) -> Any:
        return callers(law_fmu(3, *effects), interface)

    return make


def walk(caller: Any, start: int, n: int) -> list[list[float]]:
    """Outputs over n steps under a rough force that rests, so that the mass sticks."""
    rows = []
    for k in range(start, start + n):
        force = 2.0 * math.sin(0.11 * k) * (k % 200 < 100)
        caller.step(k * DT, DT, force, force + 1e-3)
        rows.append(caller.get(*OUTPUTS))
    return rows


def refused(caller: Any, call: Any, words: str, status: int = ERROR) -> None:
    """The call returns that status and says why in the log."""
    told = len(caller.messages)
    with pytest.raises(FMICallException) as caught:
        call()
    assert caught.value.status == status
    assert [kind for kind, _ in caller.messages[told:]] == [status]
    assert words in caller.texts[-1]
    assert "%" not in caller.texts[-1]


# states


@pytest.mark.parametrize("effects", [(), MEMORY], ids=["base", "memory"])
def test_a_kept_state_replays_bit_for_bit(fmu, effects):
    caller = fmu(*effects).start(x0=2e-3, dry=3.0)
    walk(caller, 0, 150)
    kept = caller.keep()
    told = caller.bytes_of(kept)
    first = walk(caller, 150, 300)
    caller.set(dry=0.5, F=3.0, F_rate=9.0)
    caller.back(kept)
    assert walk(caller, 150, 300) == first
    assert caller.bytes_of(kept) == told
    again = caller.keep()
    assert caller.bytes_of(again) != told

    other = fmu(*effects).start()  # as after a restart of the simulator
    brought = other.fmu.deserializeFMUState(told)
    other.back(brought)
    assert walk(other, 150, 300) == first
    for owner, state in ((caller, kept), (caller, again), (other, brought)):
        owner.forget(state)


def test_a_state_kept_while_it_sticks_breaks_away_at_the_same_instant(fmu):
    caller = fmu().start(x0=1e-4, dry=3.0)
    caller.step(0.0, 0.05, 0.0, 0.5)
    assert caller.get("velocity", "acceleration") == [0.0, 0.0]
    kept = caller.keep()
    told = caller.bytes_of(kept)

    def on(caller: Any) -> list[list[float]]:
        rows = []
        for k in range(50):
            caller.step(0.05 + k * DT, DT, 0.5 + 0.04 * k, 0.54 + 0.04 * k)
            rows.append(caller.get(*OUTPUTS))
        return rows

    first = on(caller)
    assert first[0][2] == 0.0
    assert first[-1][2] > 0.0
    caller.back(kept)
    assert on(caller) == first
    other = fmu().start()
    brought = other.fmu.deserializeFMUState(told)
    other.back(brought)
    assert on(other) == first
    caller.forget(kept)
    other.forget(brought)


def test_a_state_keeps_the_slope_of_the_force_and_the_mode(fmu):
    caller = fmu().start(F=0.1, F_rate=50.0)
    kept = caller.keep()
    caller.fmu.doStep(0.0, DT)
    first = caller.get("F", "F_rate", *OUTPUTS)
    assert first[:2] == pytest.approx([0.15, 50.0], rel=1e-15)
    caller.set(F_rate=0.0)
    caller.fmu.terminate()
    caller.back(kept)
    caller.fmu.doStep(0.0, DT)
    assert caller.get("F", "F_rate", *OUTPUTS) == first
    caller.forget(kept)


def test_a_slope_holds_until_it_is_set_anew(fmu):
    """Unlike the derivatives of FMI 2: an input keeps its value."""
    caller = fmu().start(F=0.0, F_rate=100.0)
    for k in range(5):
        caller.fmu.doStep(k * DT, DT)
    assert caller.get("F") == pytest.approx([0.5], rel=1e-14)
    whole = fmu().start(F=0.0, F_rate=100.0)
    whole.fmu.doStep(0.0, 5 * DT)
    assert caller.get("x", "velocity") == pytest.approx(whole.get("x", "velocity"), rel=1e-9)


def test_model_exchange_keeps_its_modes(fmu):
    """Two states of the same place: held by friction, and just gone from it."""
    caller = fmu(interface=MODEL_EXCHANGE).start(x0=1e-4, dry=3.0)
    kept = caller.keep()
    held = caller.rates(), caller.indicators()
    caller.set(F=2.0)
    caller.event()
    gone = caller.rates(), caller.indicators()
    assert gone != held
    free = caller.keep()
    caller.back(kept)
    assert (caller.rates(), caller.indicators()) == held
    caller.back(free)
    assert (caller.rates(), caller.indicators()) == gone
    assert caller.get("F") == [2.0]
    for state in (kept, free):
        caller.forget(state)


@pytest.mark.parametrize("damage", [0, 20, 60, 200, 500, -1])
def test_damaged_bytes_are_no_state(fmu, damage):
    caller = fmu().start()
    kept = caller.keep()
    good = caller.bytes_of(kept)
    bad = bytearray(good)
    bad[damage] ^= 0x10
    words = "not a state of this model"
    refused(caller, lambda: caller.fmu.deserializeFMUState(bytes(bad)), words)
    refused(caller, lambda: caller.fmu.deserializeFMUState(good[:-8]), words)
    refused(caller, lambda: caller.fmu.deserializeFMUState(b""), words)
    caller.forget(kept)


def test_foreign_states_are_refused(fmu, law_fmu, callers):
    caller, other = fmu().start(), fmu("quadratic-drag").start()
    exchange, second = fmu(interface=MODEL_EXCHANGE).start(), callers(law_fmu(2), CO_SIMULATION).start()
    kept, its = caller.keep(), second.keep()
    before = exchange.rates()
    refused(other, lambda: other.fmu.deserializeFMUState(caller.bytes_of(kept)), "not a state of this model")
    refused(caller, lambda: caller.fmu.deserializeFMUState(second.bytes_of(its)), "not a state of this model")
    refused(other, lambda: other.back(kept), "not a state of this model")
    refused(exchange, lambda: exchange.back(kept), "the other kind of interface")
    refused(caller, lambda: caller.back(ctypes.c_void_p()), "not a state of this model")
    short = (ctypes.c_ubyte * 8)()
    refused(caller, lambda: caller.fmu.fmi3SerializeFMUState(caller.fmu.component, kept, short, 8), "bytes")
    assert exchange.rates() == before
    caller.forget(kept)
    second.forget(its)


# runs


@pytest.mark.parametrize("interface", [CO_SIMULATION, MODEL_EXCHANGE])
def test_reset_starts_afresh(fmu, interface):
    caller = fmu(*MEMORY, interface=interface)

    def here() -> list[float]:
        caller.start(x0=1e-3, F=0.3)
        values = caller.get(*caller.known.tunable, *OUTPUTS)
        return values + (caller.rates() + caller.indicators() if caller.exchange else walk(caller, 0, 50)[-1])

    first = here()
    caller.set(omega0=60.0, mass=1.0, F=2.0, F_rate=3.0)
    caller.fmu.terminate()
    caller.fmu.reset()
    assert here() == first
    caller.fmu.reset()
    assert caller.start().get("x", "F", "F_rate") == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("effects", [(), MEMORY], ids=["base", "memory"])
def test_communication_steps_do_not_matter(fmu, effects):
    """One force with corners every 10 ms, at 1 ms, at 10 ms and at irregular times."""
    corners = 2.0 * np.sin(np.arange(41) * 0.9)
    grids = [np.linspace(0.0, 0.01, 11), np.array([0.0, 0.01]), np.array([0.0, 1e-7, 1.4e-4, 4.7e-3, 0.0099, 0.01])]
    runs = []
    for grid in grids:
        caller = fmu(*effects).start(x0=1e-3, dry=2.0)
        rows = []
        for k in range(40):
            rate = (corners[k + 1] - corners[k]) / 0.01
            for begin, end in pairwise(grid):
                caller.set(F=corners[k] + rate * begin, F_rate=rate)
                caller.fmu.doStep(k * 0.01 + begin, end - begin)
            rows.append(caller.get("x", "velocity", "energy"))
        runs.append(np.array(rows))
    for other in runs[1:]:
        assert np.all(np.abs(other - runs[0]) <= 1e-6 * np.abs(runs[0]).max(axis=0))


def test_tunable_parameters_change_while_it_runs(fmu):
    """From there on it is the other model, started in the same state."""
    caller = fmu().start(x0=2e-3, dry=1.0)
    walk(caller, 0, 100)
    x, v, force = caller.get("displacement", "velocity", "F")
    changed = {"mass": 0.4, "omega0": 60.0, "cubic": 1e5, "preload": 0.2, "viscous": 9.0, "dry": 0.4}
    caller.set(**changed)
    other = fmu().start(at=100 * DT, x0=x, v0=v, **changed)
    names = OUTPUTS[:6]
    for k in range(100, 300):  # the force goes on where it was, so that nothing but the parameters has changed
        for instance in (caller, other):
            instance.step(k * DT, DT, force + math.sin(0.1 * (k - 100)), force + math.sin(0.1 * (k - 99)))
        assert caller.get(*names) == pytest.approx(other.get(*names), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("interface", [CO_SIMULATION, MODEL_EXCHANGE])
def test_less_friction_lets_a_mass_go(fmu, interface):
    caller = fmu(interface=interface).start(x0=1e-4, dry=3.0)
    assert caller.get("acceleration") == [0.0]
    caller.set(dry=0.1)
    if caller.exchange:
        caller.event()
    assert caller.get("acceleration")[0] == pytest.approx(-(79.6**2 * 1e-4 + 4.6e5 * 1e-12 + 0.02 / 0.27 - 0.1))


# refusals


def test_co_simulation_calls_out_of_order_are_refused(fmu):
    caller = fmu()
    instance = caller.fmu
    step = lambda t=0.0: instance.doStep(t, DT)  # noqa: E731
    for call in (instance.exitInitializationMode, instance.terminate, step, lambda: caller.get("x")):
        refused(caller, call, "not allowed before initialisation")
    instance.enterInitializationMode()
    for call in (instance.enterInitializationMode, step):
        refused(caller, call, "not allowed in initialization mode")
    instance.exitInitializationMode()
    for call in (instance.enterInitializationMode, instance.exitInitializationMode):
        refused(caller, call, "not allowed between steps")
    refused(caller, instance.enterEventMode, "not allowed between steps")
    refused(caller, instance.enterStepMode, "not among the capabilities")
    refused(caller, lambda: instance.getOutputDerivatives([1], [2]), "of order 1")
    step()
    instance.terminate()
    for call in (instance.terminate, lambda: step(DT), lambda: caller.set(F=1.0)):
        refused(caller, call, "not allowed after the end")
    assert len(caller.get(*OUTPUTS)) == len(OUTPUTS)  # final values may still be read


def test_model_exchange_calls_out_of_order_are_refused(fmu):
    caller = fmu(interface=MODEL_EXCHANGE)
    instance = caller.fmu
    for call in (
        instance.updateDiscreteStates,
        instance.enterEventMode,
        lambda: instance.setTime(1.0),
        caller.rates,
        caller.states,
    ):
        refused(caller, call, "not allowed before initialisation")
    caller.initialise(x0=1e-3)
    for call in (
        instance.updateDiscreteStates,
        instance.enterContinuousTimeMode,
        lambda: caller.set_states([0.0, 0.0]),
    ):
        refused(caller, call, "not allowed in initialization mode")
    instance.exitInitializationMode()
    for call in (
        instance.completedIntegratorStep,
        lambda: caller.set_states([0.0, 0.0]),
        instance.exitInitializationMode,
    ):
        refused(caller, call, "not allowed in event mode")
    instance.enterContinuousTimeMode()
    for call in (instance.updateDiscreteStates, instance.enterContinuousTimeMode):
        refused(caller, call, "not allowed in continuous-time mode")
    assert instance.completedIntegratorStep() == (False, False)
    instance.terminate()
    for call in (instance.enterEventMode, lambda: instance.setTime(1.0), lambda: caller.set_states([0.0, 0.0])):
        refused(caller, call, "not allowed after the end")


def test_wrong_references_and_values_change_nothing(fmu):
    caller = fmu().start(x0=1e-3, F=0.1)
    before = caller.get("F", "F_rate", *OUTPUTS)
    reference, values = (ctypes.c_uint * 1)(0), (ctypes.c_double * 2)(1.0, 1.0)
    instance, component = caller.fmu, caller.fmu.component
    for bad in (math.nan, math.inf, -math.inf):
        refused(caller, lambda bad=bad: caller.set(F=bad), "not a finite number")
        refused(caller, lambda bad=bad: caller.set(F_rate=bad), "not a finite number")
        refused(caller, lambda bad=bad: instance.doStep(0.0, bad), "finite and positive")
        refused(caller, lambda bad=bad: instance.doStep(bad, DT), "finite and positive")
    for step in (0.0, -DT):
        refused(caller, lambda step=step: instance.doStep(0.0, step), "finite and positive")
    refused(caller, lambda: instance.doStep(0.5, DT), "stands at 0 s")
    refused(caller, lambda: instance.getFloat64([0, 99]), "value reference 99")
    refused(caller, lambda: instance.setFloat64([0, 2**32 - 1], [9.0, 1.0]), "value reference 4294967295")
    refused(caller, lambda: caller.set(F=9.0, x=1.0), "is computed, not set")
    refused(caller, lambda: caller.set(F=9.0, time=1.0), "is computed, not set")
    refused(caller, lambda: caller.set(F=9.0, x0=1.0), "fixed after initialization")
    refused(caller, lambda: caller.set(F=9.0, max_step=1.0), "fixed after initialization")
    for kind in ("Float32", "Int32", "UInt64", "Boolean", "String"):
        refused(caller, lambda kind=kind: getattr(instance, f"get{kind}")([0]), "are real")
        assert getattr(instance, f"get{kind}")([]) == []
    refused(caller, lambda: instance.fmi3GetFloat64(component, reference, 1, values, 2), "2 values for 1 references")
    refused(caller, lambda: instance.fmi3SetFloat64(component, reference, 1, values, 0), "0 values for 1 references")
    refused(caller, lambda: instance.fmi3GetFloat64(component, None, 1, values, 1), "null pointer")
    refused(caller, lambda: instance.fmi3SetFloat64(component, reference, 1, None, 1), "null pointer")
    refused(caller, lambda: instance.fmi3GetFMUState(component, None), "null pointer")
    refused(caller, lambda: caller.derivative(["x"], ["F"], [1.0, 2.0]), "2 values for 1 references")
    refused(caller, lambda: caller.adjoint(["x"], ["F"], [1.0, 2.0]), "2 values for 1 references")
    assert instance.getFloat64([]) == []
    assert caller.get("F", "F_rate", *OUTPUTS) == before
    assert caller.get("time") == [0.0]


@pytest.mark.parametrize("size", [0, 1, 3])
def test_wrong_sizes_are_refused(fmu, size):
    caller = fmu(interface=MODEL_EXCHANGE).start(x0=1e-3)
    instance, place = caller.fmu, (ctypes.c_double * 4)()
    before = caller.states()
    for call in (
        instance.setContinuousStates,
        instance.getContinuousStates,
        instance.getContinuousStateDerivatives,
        instance.getNominalsOfContinuousStates,
        instance.getEventIndicators,
    ):
        refused(caller, lambda call=call: call(place, size), f"{size} values where the model has 2")
    refused(caller, lambda: instance.setContinuousStates((ctypes.c_double * 2)(math.nan, 0.0), 2), "is not finite")
    refused(caller, lambda: instance.setContinuousStates(None, 2), "null pointer")
    refused(caller, lambda: instance.setTime(math.nan), "not a finite number")
    assert caller.states() == before


@pytest.mark.parametrize("change", [{"viscous": -1e6}, {"cubic": -1e30}, {"omega0": 1e200}])
def test_a_motion_without_bounds_is_discarded_and_can_be_taken_back(fmu, change):
    caller = fmu().start(x0=1e-3, v0=0.1)
    before, kept = caller.get("x", "velocity"), caller.keep()
    caller.set(**change)
    refused(caller, lambda: [caller.fmu.doStep(k * 0.05, 0.05) for k in range(100)], "from t =", DISCARD)
    refused(caller, lambda: caller.fmu.doStep(0.0, DT), "after a step that failed")
    caller.back(kept)
    assert caller.get("x", "velocity") == before
    caller.fmu.doStep(0.0, DT)
    caller.forget(kept)


def test_stop_time_is_kept(fmu):
    caller = fmu().start(stop=0.01)
    for k in range(10):
        told = caller.fmu.doStep(k * DT, DT)
        assert told == (False, False, False, pytest.approx((k + 1) * DT))
    refused(caller, lambda: caller.fmu.doStep(0.01, DT), "beyond the stop time")


def test_instantiation_that_cannot_be_is_refused(fmu):
    caller = fmu()
    caller.fmu.guid = "{another}"
    with pytest.raises(Exception, match="instantiate"):
        caller.fmu.instantiate(logMessage=lambda *said: caller._log(said[0], b"", *said[1:]))
    assert "GUID" in caller.texts[-1]
