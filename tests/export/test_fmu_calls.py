"""Calls an importer may make in any order: states kept and restored, reset, and every refusal with its reason."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

DT = 1e-3
DISCARD, ERROR = 2, 3
BACKENDS = ["native", "python"]
OUTPUTS = ("x", "displacement", "velocity", "acceleration")


def walk(fmu, start: int, n: int) -> list[list[float]]:
    """Outputs over n steps under a rough force that also makes the motion stick."""
    rows = []
    for k in range(start, start + n):
        force = 0.2 * math.sin(0.11 * k) * (k % 200 < 100)
        fmu.step(k * DT, DT, force, force + 1e-4)
        rows.append(fmu.get(*OUTPUTS))
    return rows


def refused(fmu, call, words: str, status: int = ERROR) -> None:
    """The call returns that status, says why in the log, and leaves the outputs as they were."""
    told = len(fmu.messages)
    with pytest.raises(FMICallException) as caught:
        call()
    assert caught.value.status == status
    assert words in " ".join(fmu.messages[told:])
    assert "%" not in fmu.messages[-1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_kept_state_replays_bit_for_bit(instances, backend):
    fmu = instances("base", backend).start(x0=2e-3)
    n = 400 if backend == "native" else 150
    walk(fmu, 0, n)
    kept = fmu.fmu.getFMUstate()
    serialised = fmu.fmu.serializeFMUstate(kept)
    first = walk(fmu, n, n)
    fmu.set(dry=0.5, F=3.0)
    fmu.fmu.setFMUstate(kept)
    assert walk(fmu, n, n) == first
    fmu.fmu.freeFMUstate(kept)
    if backend == "native":
        assert fmu.fmu.serializeFMUstate(fmu.fmu.getFMUstate()) != serialised

    # another instance that went the same way has the same bytes
    twin = instances("base", backend).start(x0=2e-3)
    walk(twin, 0, n)
    kept = twin.fmu.getFMUstate()
    assert twin.fmu.serializeFMUstate(kept) == serialised
    twin.fmu.freeFMUstate(kept)

    # into another instance, as after a restart of the simulator
    other = instances("base", backend).start()
    back = other.fmu.deSerializeFMUstate(serialised)
    other.fmu.setFMUstate(back)
    assert walk(other, n, n) == first
    other.fmu.freeFMUstate(back)


def test_a_state_keeps_a_pending_slope_and_the_mode(instances):
    fmu = instances().start()
    fmu.set(F=0.1)
    fmu.fmu.setRealInputDerivatives([0], [1], [50.0])
    kept = fmu.fmu.getFMUstate()
    fmu.fmu.doStep(0.0, DT)
    first = fmu.get("F", *OUTPUTS)
    fmu.fmu.terminate()
    fmu.fmu.setFMUstate(kept)
    fmu.fmu.doStep(0.0, DT)
    assert fmu.get("F", *OUTPUTS) == first
    assert first[0] == pytest.approx(0.15)
    fmu.fmu.freeFMUstate(kept)


@pytest.mark.parametrize("damage", [0, 20, 60, 200, -1])
def test_damaged_or_foreign_bytes_are_no_state(instances, damage):
    fmu, other = instances("base").start(), instances("drag").start()
    kept = fmu.fmu.getFMUstate()
    good = fmu.fmu.serializeFMUstate(kept)
    bad = bytearray(good)
    bad[damage] ^= 0x10
    words = "not a state of this model"
    refused(fmu, lambda: fmu.fmu.deSerializeFMUstate(bytes(bad)), words)
    refused(fmu, lambda: fmu.fmu.deSerializeFMUstate(good[:-8]), words)
    refused(other, lambda: other.fmu.deSerializeFMUstate(good), words)
    refused(other, lambda: other.fmu.setFMUstate(ctypes.c_void_p()), words)
    refused(fmu, lambda: fmu.fmu.fmi2SerializeFMUstate(fmu.component, kept, ctypes.create_string_buffer(8), 8), "bytes")
    fmu.fmu.freeFMUstate(kept)


@pytest.mark.parametrize("backend", BACKENDS)
def test_reset_starts_afresh(instances, backend):
    fmu = instances("base", backend)
    first = walk(fmu.start(x0=1e-3), 0, 100)
    fmu.set(omega0=60.0, mass=1.0)
    fmu.fmu.reset()
    assert walk(fmu.start(x0=1e-3), 0, 100) == first
    assert fmu.get("mass") == [0.27]


def test_calls_out_of_order_are_refused(instances):
    fmu = instances()
    f = fmu.fmu
    for call in (f.exitInitializationMode, f.terminate, lambda: f.doStep(0.0, DT), lambda: fmu.get("x")):
        refused(fmu, call, "not allowed before initialisation")
    f.setupExperiment(startTime=0.0)
    f.enterInitializationMode()
    for call in (f.enterInitializationMode, f.setupExperiment, lambda: f.doStep(0.0, DT)):
        refused(fmu, call, "not allowed in initialization mode")
    f.exitInitializationMode()
    for call in (f.enterInitializationMode, f.exitInitializationMode, f.setupExperiment):
        refused(fmu, call, "not allowed between steps")
    refused(fmu, f.cancelStep, "no step is under way")
    f.doStep(0.0, DT)
    f.terminate()
    for call in (f.terminate, lambda: f.doStep(DT, DT), lambda: fmu.set(F=1.0)):
        refused(fmu, call, "not allowed after the end")
    assert len(fmu.get(*OUTPUTS)) == 4  # final values may still be read


def test_bad_arguments_are_refused_and_change_nothing(instances):
    fmu = instances().start(x0=1e-3, F=0.1)
    f, c = fmu.fmu, fmu.component
    before = fmu.get("F", *OUTPUTS)
    reference = (ctypes.c_uint * 1)(0)
    value = (ctypes.c_double * 1)(1.0)
    for bad in (math.nan, math.inf, -math.inf):
        refused(fmu, lambda bad=bad: fmu.set(F=bad), "not a finite number")
        refused(fmu, lambda bad=bad: f.setRealInputDerivatives([0], [1], [bad]), "finite derivatives of order 1 to 3")
        refused(fmu, lambda bad=bad: f.doStep(0.0, bad), "finite and positive")
        refused(fmu, lambda bad=bad: f.doStep(bad, DT), "finite and positive")
    for step in (0.0, -DT):
        refused(fmu, lambda step=step: f.doStep(0.0, step), "finite and positive")
    refused(fmu, lambda: f.doStep(0.5, DT), "stands at 0 s")
    refused(fmu, lambda: f.getReal([0, 99]), "value reference 99")
    refused(fmu, lambda: f.setReal([0, 2**32 - 1], [9.0, 1.0]), "value reference 4294967295")
    refused(fmu, lambda: fmu.set(F=9.0, x=1.0), "SetReal: x is computed, not set")
    refused(fmu, lambda: fmu.set(F=9.0, x0=1.0), "SetReal: x0 is fixed after initialization")
    refused(fmu, lambda: fmu.set(F=9.0, max_step=1.0), "SetReal: max_step is fixed after initialization")
    refused(fmu, lambda: fmu.set(F=9.0, viscous=math.nan), "SetReal: viscous: not a finite number")
    refused(fmu, lambda: fmu.set(F=9.0, dry=-1.0), "SetReal: dry: -1 is outside its bounds, 0 to inf")
    refused(fmu, lambda: fmu.set(F=9.0, smoothing=-1.0), "SetReal: smoothing must be zero or positive, not -1")
    for order in (0, -1, 4):
        refused(fmu, lambda order=order: f.setRealInputDerivatives([0], [order], [1.0]), "order 1 to 3")
    refused(fmu, lambda: f.setRealInputDerivatives([1], [1], [1.0]), "Derivatives: x is no input")
    refused(fmu, lambda: f.getInteger([0]), "are real")
    refused(fmu, lambda: f.setString([0], ["x"]), "are real")
    refused(fmu, lambda: f.getRealOutputDerivatives([0], [1]), "Derivatives: F is no output")
    refused(fmu, lambda: f.getRealOutputDerivatives([1], [2]), "of order 1")
    refused(fmu, lambda: f.getDirectionalDerivative([1], [1], [1.0]), "Derivative: x is not known now")
    refused(fmu, lambda: f.fmi2GetReal(c, None, 1, value), "null pointer")
    refused(fmu, lambda: f.fmi2GetReal(c, reference, 1, None), "null pointer")
    refused(fmu, lambda: f.fmi2SetReal(c, reference, 1, None), "null pointer")
    refused(fmu, lambda: f.fmi2SetRealInputDerivatives(c, reference, 1, None, value), "null pointer")
    refused(fmu, lambda: f.fmi2GetFMUstate(c, None), "null pointer")
    refused(fmu, lambda: f.getStatus(1), "no such status", DISCARD)
    assert f.getReal([]) == []
    assert f.getBoolean([]) == []
    assert fmu.get("F", *OUTPUTS) == before


def test_a_null_component_is_refused_by_every_function(instances):
    library = instances().fmu.dll
    null = ctypes.c_void_p()
    for name in ("Terminate", "Reset", "EnterInitializationMode", "ExitInitializationMode", "CancelStep"):
        assert getattr(library, f"fmi2{name}")(null) == ERROR
    for name in ("GetReal", "SetReal", "GetInteger", "SetBoolean", "SetString"):
        assert getattr(library, f"fmi2{name}")(null, None, ctypes.c_size_t(0), None) == ERROR
    for name in ("GetFMUstate", "SetFMUstate", "FreeFMUstate"):
        assert getattr(library, f"fmi2{name}")(null, None) == ERROR
    assert library.fmi2DoStep(null, ctypes.c_double(0.0), ctypes.c_double(DT), 0) == ERROR
    library.fmi2FreeInstance(null)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"guid": b"{another}"}, "GUID"),
        ({"guid": None}, "GUID"),
        ({"name": b""}, "name"),
        ({"name": None}, "name"),
        ({"kind": 7}, "kind"),
    ],
)
def test_instantiation_that_cannot_be_is_refused(instances, change, words):
    fmu = instances()
    given = {"name": b"rig", "kind": 1, "guid": fmu.fmu.guid.encode(), **change}
    made = fmu.fmu.fmi2Instantiate(
        given["name"], given["kind"], given["guid"], b"file:///", ctypes.byref(fmu.callbacks), 0, 0
    )
    assert not made
    assert words in fmu.messages[-1]
    assert not fmu.fmu.dll.fmi2Instantiate(b"rig", 1, given["guid"], b"", None, 0, 0)


def test_stop_time_is_kept(instances):
    fmu = instances().start(stop=0.01)
    for k in range(10):
        fmu.step(k * DT, DT)
    refused(fmu, lambda: fmu.step(0.01, DT), "beyond the stop time")


def test_no_interval_of_time_is_refused(instances):
    fmu = instances()
    refused(fmu, lambda: fmu.fmu.setupExperiment(startTime=math.nan), "no interval")
    refused(fmu, lambda: fmu.fmu.setupExperiment(startTime=1.0, stopTime=0.5), "no interval")


@pytest.mark.parametrize("change", [{"viscous": -1e6}, {"cubic": -1e30}, {"omega0": 1e200}])
def test_a_motion_without_bounds_is_discarded_and_can_be_taken_back(instances, change):
    fmu = instances().start(x0=1e-3, v0=0.1)
    before = fmu.get("x", "velocity")
    kept = fmu.fmu.getFMUstate()
    fmu.set(**change)
    refused(fmu, lambda: [fmu.step(k * 0.05, 0.05) for k in range(100)], "from t =", DISCARD)
    assert fmu.fmu.getStatus(0) == DISCARD
    assert np.isfinite(fmu.fmu.getRealStatus(2))
    refused(fmu, lambda: fmu.step(0.0, DT), "after a step that failed")
    fmu.fmu.setFMUstate(kept)
    assert fmu.get("x", "velocity") == before
    fmu.step(0.0, DT)
    fmu.fmu.freeFMUstate(kept)


def test_values_that_are_not_finite_are_not_handed_out(instances):
    fmu = instances().start(F=1.0)
    fmu.set(mass=1e-310)
    refused(fmu, lambda: fmu.get("acceleration"), "not finite", DISCARD)


def test_a_step_that_would_never_end_is_discarded(instances):
    fmu = instances().start()
    refused(fmu, lambda: fmu.step(0.0, 1e9), "too long", DISCARD)


@pytest.mark.parametrize(
    "clock",
    [
        lambda k: k * DT,
        lambda k: sum([DT] * k),
        lambda k: round(k * DT * 1e9) * 1e-9,
    ],
)
def test_importers_may_count_time_as_they_like(instances, clock):
    fmu = instances().start(x0=1e-3)
    for k in range(300):
        fmu.step(clock(k), DT)
    assert fmu.fmu.getRealStatus(2) == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda fmu: fmu.set(F=math.nan), "F must be a finite number"),
        (lambda fmu: fmu.set(F=9.0, x0=1.0), "x0 is fixed"),
        (lambda fmu: fmu.set(F=9.0, x=1.0), "x is computed"),
        (lambda fmu: fmu.fmu.setReal([0, 99], [9.0, 1.0]), "value reference 99"),
        (lambda fmu: fmu.fmu.getReal([99]), "value reference 99"),
    ],
)
def test_python_fmu_logs_what_it_refuses_and_does_not_step_on(instances, call, words):
    """PythonFMU can only tell it from an exception, which it does not survive; so the next step says no."""
    fmu = instances("base", "python").start(x0=1e-3)
    before = fmu.get("F", *OUTPUTS)
    kept = fmu.fmu.getFMUstate()
    call(fmu)
    assert words in fmu.messages[-1]
    assert fmu.get("F", *OUTPUTS) == before
    refused(fmu, lambda: fmu.step(0.0, DT), words, DISCARD)
    fmu.fmu.setFMUstate(kept)
    fmu.step(0.0, DT)
    fmu.fmu.freeFMUstate(kept)


def test_python_fmu_discards_steps_that_cannot_be(instances):
    fmu = instances("base", "python").start(x0=1e-3)
    for step in (0.0, -DT, math.nan, math.inf):
        refused(fmu, lambda step=step: fmu.fmu.doStep(0.0, step), "finite and positive", DISCARD)
    refused(fmu, lambda: fmu.fmu.doStep(0.0, 1e9), "too long", DISCARD)
    fmu.step(0.0, DT)
    fmu.set(viscous=-1e6)
    refused(fmu, lambda: fmu.step(DT, 0.1), "beyond bounds", DISCARD)
