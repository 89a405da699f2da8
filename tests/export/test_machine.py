"""The FMU's parameters as the machine's: a payload, physical quantities, bounds; derivatives of its outputs by time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.export.description import describe_fmu
from dashpot.export.facts import Facts
from dashpot.model import Oscillator
from fmpy import read_model_description

CO_SIMULATION = "CoSimulation"
DT = 1e-3


def loaded(payload):
    """Eq. 17 per unit mass of the same springs, dampers and friction with more mass on them."""
    part = TRUTH["mass"] / (TRUTH["mass"] + payload)
    values = {name: part * value for name, value in TRUTH.items()}
    return values | {"mass": TRUTH["mass"] + payload, "omega0": math.sqrt(part) * TRUTH["omega0"]}


def rates(caller, names):
    references = caller.references(names)
    if caller.second:
        return caller.fmu.getRealOutputDerivatives(references, [1] * len(names))
    return caller.fmu.getOutputDerivatives(references, [1] * len(names))


def step(caller, k, force, slope):
    caller.set(F=force)
    if caller.second:
        caller.fmu.setRealInputDerivatives(caller.references(["F"]), [1], [slope])
    else:
        caller.set(F_rate=slope)
    caller.fmu.doStep(k * DT, DT)


@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
@pytest.mark.parametrize("payload", [0.13, pytest.param(-0.1, marks=pytest.mark.long)])
def test_a_payload_is_more_mass_on_the_same_springs(fmu_of, callers, version, payload):
    t = np.arange(801) * DT
    force = 0.8 * np.sin(2 * np.pi * (6 + 6 * t) * t)
    caller = callers(fmu_of(version), CO_SIMULATION).start(x0=1e-3, payload=payload)
    motion = [caller.get("displacement", "velocity")]
    for k in range(t.size - 1):
        step(caller, k, force[k], (force[k + 1] - force[k]) / DT)
        motion.append(caller.get("displacement", "velocity"))
    values = loaded(payload)
    x, v = integrate(values, force, DT, 1e-3)
    peak = np.max(np.abs(x))
    assert np.array(motion)[:, 0] == pytest.approx(x, abs=1e-6 * peak)
    energy = values["mass"] * (v**2 + values["omega0"] ** 2 * x**2 + values["cubic"] * x**4 / 2) / 2
    energy = energy + values["mass"] * values["preload"] * np.abs(x)
    assert caller.get("energy")[0] == pytest.approx(energy[-1], rel=1e-4)


@pytest.mark.parametrize("version", [2, 3])
def test_the_machine_is_told_in_its_own_units_and_cannot_be_said_twice(fmu_of, callers, version):
    path = fmu_of(version)
    told = {v.name: v for v in read_model_description(str(path)).modelVariables}
    caller = callers(path, CO_SIMULATION).start(payload=0.23)
    mass, omega0 = caller.get("mass", "omega0")
    expected = {
        "total_mass": ("kg", mass + 0.23),
        "stiffness": ("N/m", mass * omega0**2),
        "cubic_stiffness": ("N/m3", mass * 4.6e5),
        "preload_force": ("N", 0.02),
        "damping": ("N.s/m", mass * 5.0),
        "friction": ("N", mass * 0.015),
        "natural_frequency": ("Hz", 12.67 * math.sqrt(mass / (mass + 0.23))),
    }
    for name, (unit, value) in expected.items():
        assert told[name].causality == "calculatedParameter"
        assert caller.get(name)[0] == pytest.approx(value, rel=1e-12)
        assert "N" not in unit or "N" in told[name].unit or "kg" in told[name].unit
        with pytest.raises(Exception, match="failed"):
            caller.set(**{name: 1.0})
        assert "is computed, not set" in caller.texts[-1]
    caller.set(omega0=100.0)
    assert caller.get("stiffness")[0] == pytest.approx(mass * 1e4, rel=1e-12)


@pytest.mark.parametrize("version", [2, 3])
def test_bounds_are_declared_and_kept(fmu_of, callers, version):
    told = {v.name: v for v in read_model_description(str(fmu_of(version))).modelVariables}
    for name, low in (("mass", 0.0), ("omega0", 0.0), ("payload", -0.27), ("smoothing", 0.0)):
        assert float(told[name].min) == low
    assert float(told["extrapolation"].max) == 1.0
    caller = callers(fmu_of(version), CO_SIMULATION).start()
    before = caller.get("mass", "payload", "omega0")
    cases = (({"mass": -1.0}, "bounds"), ({"omega0": -1.0}, "bounds"), ({"mass": 0.0}, "more than zero"))
    for wrong, words in (*cases, ({"mass": 0.1, "payload": -0.2}, "more than zero")):
        with pytest.raises(Exception, match="failed"):
            caller.set(**wrong)
        assert words in caller.texts[-1]
    assert caller.get("mass", "payload", "omega0") == before


def test_a_fit_that_breaks_a_bound_declares_none():
    model = Oscillator.from_values(TRUTH | {"omega0": -80.0})
    described = {v.name: v for v in describe_fmu(Facts(model)).variables}
    assert described["omega0"].min is None
    assert described["omega0"].start == -80.0
    free = Oscillator.from_values({name: value for name, value in TRUTH.items() if name != "mass"})
    names = {v.name for v in describe_fmu(Facts(free)).variables}
    assert not names & {"payload", "stiffness", "total_mass"}  # nothing is known of a mass


@pytest.mark.parametrize("version", [2, 3])
def test_derivatives_of_outputs_are_what_differences_come_to(fmu_of, callers, version):
    names = ["x", "displacement", "velocity", "acceleration", "energy", "dissipated_power"]
    caller = callers(fmu_of(version), CO_SIMULATION).start(x0=2e-3, v0=0.1)
    rows, told, h = [], [], DT
    for k in range(5):
        step(caller, k, 0.3 + 40.0 * k * h, 40.0)
        rows.append(caller.get(*names))
        told.append(rates(caller, names))
    rows = np.array(rows)
    numeric = (rows[0] - 8 * rows[1] + 8 * rows[3] - rows[4]) / (12 * h)
    assert told[2] == pytest.approx(numeric, rel=2e-4)
    assert told[2][:3] == pytest.approx(rows[2, [2, 2, 3]], rel=1e-12)
    assert rates(caller, ["amplitude", "outside_range"]) == [0.0, 0.0]
    for wrong, words in ((["mass"], "no output"), (["F"], "no output")):
        with pytest.raises(Exception, match="failed"):
            rates(caller, wrong)
        assert words in caller.texts[-1]


@pytest.mark.parametrize("version", [2, 3])
def test_a_force_that_is_not_set_again_stays_what_it_was(fmu_of, callers, version):
    caller = callers(fmu_of(version), CO_SIMULATION).start(extrapolation=1.0, x0=1e-3)
    plain = callers(fmu_of(version), CO_SIMULATION).start(x0=1e-3)
    for k, force in enumerate((0.0, 0.2)):
        caller.set(F=force)
        caller.fmu.doStep(k * DT, DT)
        step(plain, k, force, 0.0 if k == 0 else 0.2 / DT)  # as the two values go
    assert caller.get("displacement", "velocity") == plain.get("displacement", "velocity")
    assert caller.get("F")[0] == pytest.approx(0.4)
    for k in range(2, 6):
        caller.fmu.doStep(k * DT, DT)
        step(plain, k, 0.2, 0.0)
    assert caller.get("displacement", "velocity") == plain.get("displacement", "velocity")
    assert caller.get("F")[0] == 0.2


def test_the_python_back_end_carries_the_same_payload(fmus, instances):
    told = {v.name: v for v in read_model_description(str(fmus("base", "python"))).modelVariables}
    assert float(told["payload"].min) == -TRUTH["mass"]
    both = [instances("base", backend).start(payload=0.13, x0=1e-3) for backend in ("native", "python")]
    for k in range(20):
        for fmu in both:
            fmu.step(k * DT, DT, 0.1 * k, 0.1 * (k + 1))
    names = ("displacement", "velocity", "energy", "total_mass", "stiffness", "natural_frequency")
    assert both[1].get(*names) == pytest.approx(both[0].get(*names), rel=1e-8)
    for wrong, words in (({"mass": -1.0}, "bounds"), ({"mass": 0.1, "payload": -0.2}, "more than zero")):
        both[1].set(**wrong)
        assert words in both[1].messages[-1]
