"""Every importer that installs gives the same answer: the independent integrator's, with the hold that it can do."""

from __future__ import annotations

import numpy as np
import pytest

DT = 1e-3
START = {"x0": 1e-3, "v0": 0.05}
#: Other values than those of the description, so that setting them shows.
CHANGED = {"mass": 0.3, "dry": 0.4, "preload": 0.1, "cubic": 2e5}
#: Of the peak, as promised.
CLOSE = 1e-6

CO_SIMULATION = [
    ("fmpy_simulate", 2, "zero"),
    ("fmpy_simulate", 3, "zero"),
    ("fmpy_simulate", 3, "first"),
    ("fmpy_slave", 2, "zero"),
    ("fmpy_slave", 2, "first"),
    ("fmpy_slave", 3, "zero"),
    ("fmpy_slave", 3, "first"),
    ("fmuloader_slave", 2, "zero"),
    ("fmuloader_slave", 2, "first"),
    ("fmuloader_slave", 3, "zero"),
    ("fmuloader_slave", 3, "first"),
    ("libcosimpy_execution", 2, "zero"),
    ("ecospy_simulation", 2, "zero"),
    ("ecospy_simulation", 3, "zero"),
    ("ecospy_simulation", 3, "first"),
    ("pathsim_cosimulation", 2, "zero"),
    ("pathsim_cosimulation", 3, "zero"),
    ("pathsim_cosimulation", 3, "first"),
    ("bare_c", 2, "zero"),
    ("bare_c", 2, "first"),
    ("bare_c", 3, "zero"),
    ("bare_c", 3, "first"),
]
MODEL_EXCHANGE = [
    ("fmpy_cvode", 2, "zero"),
    ("fmpy_cvode", 3, "zero"),
    ("fmpy_model", 2, "zero"),
    ("fmpy_model", 2, "first"),
    ("fmpy_model", 3, "zero"),
    ("fmpy_model", 3, "first"),
    ("fmuloader_model", 2, "zero"),
    ("fmuloader_model", 2, "first"),
    ("fmuloader_model", 3, "zero"),
    ("fmuloader_model", 3, "first"),
    ("pathsim_model", 2, "first"),
    ("pathsim_model", 3, "first"),
]
#: Importers that locate no event: a law without surfaces is what they can follow.
WITHOUT_EVENTS = [("casadi_integrator", 2, "zero"), ("casadi_integrator", 3, "zero")]


def one_of_each(cases: list[tuple[str, int, str]]) -> list[object]:
    """Of each importer the newest version and most of the force that it can do, with other values than described; the
    whole matrix for `make test-all`. Each runs in a process of its own."""
    last = {module: (module, version, hold) for module, version, hold in cases}
    return [
        pytest.param(*case, changed, id="-".join(map(str, case)) + said, marks=marks)
        for case in cases
        for changed, said in (({}, "-as described"), (CHANGED, "-changed"))
        for marks in [() if changed and case in last.values() else pytest.mark.long]
    ]


@pytest.fixture(scope="module")
def distance(play, fmu_of, models, sweep, reference):
    """Largest distance of an importer's answer from the reference, relative to the peak."""

    def of(module, version, hold, changed, samples=None, fmu=None, **further):
        force = sweep[:samples]
        fmu = fmu or fmu_of(version)
        x = play(module, fmu, force, DT, {**START, **changed}, hold, **further)
        expected = reference({**models["base"]().values(), **changed}, force, hold, *START.values())
        assert x.shape == expected.shape
        return np.max(np.abs(x - expected)) / np.max(np.abs(expected))

    return of


@pytest.mark.parametrize(("module", "version", "hold", "changed"), one_of_each(CO_SIMULATION))
def test_co_simulation(distance, module, version, hold, changed):
    assert distance(module, version, hold, changed) < CLOSE


@pytest.mark.parametrize(("module", "version", "hold", "changed"), one_of_each(MODEL_EXCHANGE))
def test_model_exchange(distance, module, version, hold, changed):
    samples = 400 if module == "fmpy_cvode" else None  # it goes through all jumps of the force at every step
    assert distance(module, version, hold, changed, samples) < CLOSE


@pytest.mark.parametrize(("module", "version", "hold"), WITHOUT_EVENTS)
def test_model_exchange_without_events(distance, module, version, hold):
    assert distance(module, version, hold, {"dry": 0.0, "preload": 0.0}) < CLOSE


@pytest.mark.long
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("machine", ["windows", "aarch64"])
def test_other_machines_give_the_same(play, everywhere, distance, sweep, machine, version):
    """The C host on a machine that is only emulated, with the FMU's own binary for it: right, and the same as here but
    for the last digits."""
    fmu = everywhere(version)
    assert distance("bare_c", version, "first", CHANGED, fmu=fmu, machine=machine) < CLOSE
    here = play("bare_c", fmu, sweep, DT, START, "first")
    there = play("bare_c", fmu, sweep, DT, START, "first", machine=machine)
    assert np.max(np.abs(there - here)) <= 1e-12 * np.max(np.abs(here))


def test_the_hold_shows(models, sweep, reference):
    """The two holds lie far further apart than what is asked, so that neither can stand for the other."""
    zero, first = (reference(models["base"]().values(), sweep, hold, *START.values()) for hold in ("zero", "first"))
    assert np.max(np.abs(zero - first)) > 1e4 * CLOSE * np.max(np.abs(first))


def test_an_importer_that_cannot_incline_says_so(distance):
    with pytest.raises(AssertionError, match="libcosim holds inputs"):
        distance("libcosimpy_execution", 2, "first", {})
