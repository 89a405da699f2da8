"""One expression, many renderings: for every law the engine, the FMUs and the CasADi step against each other.

The engine itself is held against an adaptive integrator of order eight (Hairer, Nørsett and Wanner 1993) that takes the
plain expressions with ``sign`` written out, and where the motion sticks against its own fine steps.
"""

from __future__ import annotations

import itertools

import casadi
import numpy as np
import pytest
from dashpot.export.fmu import export_fmu
from dashpot.export.python_fmu import output_function
from dashpot.model.equations import equations, rates_feel_rest, signed
from dashpot.model.laws import LIBRARY
from dashpot.simulate.casadi_step import exact_step
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force, straight_lines
from dashpot.verify.fmu_run import FmuRun
from scipy.integrate import solve_ivp
from scipy.interpolate import PPoly

DT, N = 1e-3, 500
#: Laws that depend on time must be given the clock, so it does not start at zero.
START = 0.4
TIME = START + np.arange(N) * DT
CHIRP = np.sin(2 * np.pi * (8 * (TIME - START) + 8 * (TIME - START) ** 2))
KINDS = ["driven", "released"]


def values_of(model):
    return np.array(list(model.values().values()))


def longest_step(model):
    return internal_step(model, model.values(), 8e-3)


def simulated(model, force, initial, step=None):
    core = core_of(model)
    return core.record(values_of(model), initial, force, N, DT, step or longest_step(model), start=START)


def start(kind, model, offsets):
    inner = offsets(model)
    return np.array([0.0, 0.0, *inner] if kind == "driven" else [6e-3, 0.1, *inner])


def error(response, expected):
    return np.max(np.abs(response - expected)) / np.max(np.abs(expected))


def independent(model, force, begin):
    """Response (N,) from the plain expressions, by DOP853."""
    eq = equations(model)
    p = casadi.DM(values_of(model))
    plain = [casadi.substitute(signed(eq, e), eq.p, p) for e in (eq.zdot, eq.y[0])]
    field = casadi.Function("field", [eq.z, eq.t, eq.u], plain[:1])
    output = casadi.Function("output", [eq.z, eq.t, eq.u], plain[1:])
    drive = None if force is None else PPoly(force.pieces.T[::-1], START + np.arange(len(force.pieces) + 1) * DT)
    z, t, u, rates = np.zeros(begin.size), np.zeros(1), np.zeros(1), np.zeros(begin.size)
    buffer, evaluate = field.buffer()
    for i, array in enumerate((z, t, u)):
        buffer.set_arg(i, memoryview(array))
    buffer.set_res(0, memoryview(rates))

    def right_hand_side(time, state):
        z[:], t[:], u[:] = state, time, 0.0 if drive is None else float(drive(time))
        evaluate()
        return rates.copy()

    solved = solve_ivp(
        right_hand_side, (TIME[0], TIME[-1]), begin, method="DOP853", t_eval=TIME, rtol=1e-11, atol=1e-14
    )
    forces = np.zeros(N) if drive is None else drive(TIME)
    return np.array([float(output(*row)) for row in zip(solved.y.T, TIME, forces, strict=True)])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("effect", [name for name in LIBRARY if name != "stribeck"])  # which sticks: see below
def test_the_engine_agrees_with_an_independent_integrator(effect, kind, with_law, offsets):
    model = with_law(effect, dry=0.0, preload=0.0)
    # fifty samples a cycle and more: one cubic a sample is the force itself, for both
    force = smooth_force(CHIRP, DT, 1.0) if kind == "driven" else None
    initial = start(kind, model, offsets)
    expected = independent(model, force, core_of(model).begin(initial))
    assert error(simulated(model, force, initial), expected) < 1e-6


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("effect", LIBRARY)
def test_the_engine_agrees_with_fine_steps_where_the_motion_sticks(effect, kind, with_law, offsets):
    model = with_law(effect)
    initial = start(kind, model, offsets)
    force = 0.3 * CHIRP if kind == "driven" else None
    step = longest_step(model)
    fine = simulated(model, force, initial, step / 8)
    assert error(simulated(model, force, initial, step), fine) < 1e-6


@pytest.mark.parametrize("effect", LIBRARY)
def test_the_native_fmu_repeats_the_engine(effect, with_law, offsets, tmp_path):
    model = with_law(effect)
    with FmuRun(export_fmu(model, tmp_path / "rig.fmu")) as run:
        for kind in KINDS:
            initial = start(kind, model, offsets)
            force = straight_lines(CHIRP, DT) if kind == "driven" else None
            expected = simulated(model, force, initial, longest_step(model))
            assert len(run.starts) == initial.size
            step = float(run.variables["max_step"].start)
            expected = simulated(model, force, initial, step)
            assert error(run.record(force, N, DT, initial, START), expected) < 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("effect", LIBRARY)
def test_the_casadi_step_agrees_with_the_engine(effect, kind, with_law, offsets):
    model = with_law(effect)
    initial = start(kind, model, offsets)
    force = CHIRP if kind == "driven" else np.zeros(N)
    assert error(stepped(model, force, initial), simulated(model, force, initial)) < 1e-6


def stepped(model, force, initial):
    """Response (N,) by the CasADi step and output function."""
    p = values_of(model)
    step, output = exact_step(model, DT, longest_step(model)), output_function(equations(model))
    z = core_of(model).begin(initial)
    y = [float(output(z, force[0], p, TIME[0])[0])]
    for (here, there), (before, now) in zip(itertools.pairwise(force), itertools.pairwise(TIME), strict=True):
        z = np.array(step(z, [here, there], p, before, DT)).ravel()
        y.append(float(output(z, there, p, now)[0]))
    return np.array(y)


@pytest.mark.parametrize("effect", ["hysteresis", "actuator-dead-zone", "sensor-lag", "stiffness-drift"])
def test_the_python_fmu_agrees_with_the_engine(effect, with_law, offsets, tmp_path):
    model = with_law(effect)
    initial = start("released", model, offsets)
    with FmuRun(export_fmu(model, tmp_path / "rig.fmu", backend="python")) as run:
        response = run.record(straight_lines(CHIRP[:200], DT), 200, DT, initial, START)
    assert error(response, simulated(model, CHIRP, initial)[:200]) < 1e-4


def test_a_sensor_that_follows_the_acceleration_sees_none_at_rest(with_law, tmp_path):
    model = with_law("sensor-lag", quantity="acceleration", dry=3.0, **{"sensor-lag.time": 0.02})
    assert rates_feel_rest(equations(model))
    force = 1.5 * CHIRP
    force[250:] = 0.3
    initial = np.zeros(3)
    expected = simulated(model, force, initial, 1e-4)
    states = core_of(model).record(values_of(model), initial, force, N, DT, longest_step(model), states=True)
    assert 100 < np.count_nonzero(states[:, 1] == 0.0) < N
    assert abs(expected[-1]) < 1e-2 * np.max(np.abs(expected))  # it forgets the motion
    assert error(simulated(model, force, initial), expected) < 1e-6
    assert error(stepped(model, force, initial), expected) < 1e-6
    with FmuRun(export_fmu(model, tmp_path / "rig.fmu")) as run:
        assert error(run.record(straight_lines(force, DT), N, DT, initial, START), expected) < 1e-6


def test_several_laws_on_every_path_at_once(with_law, offsets, tmp_path):
    model = with_law("clearance", "hysteresis", "actuator-lag", "actuator-dead-zone", "sensor-lag", "stiffness-drift")
    initial = start("released", model, offsets)
    expected = simulated(model, CHIRP, initial)
    assert error(expected, simulated(model, CHIRP, initial, longest_step(model) / 8)) < 1e-6
    assert error(stepped(model, CHIRP, initial), expected) < 1e-6
    with FmuRun(export_fmu(model, tmp_path / "rig.fmu")) as run:
        assert run.starts == ["x0", "v0", "hysteresis.deflection0", "actuator-lag.force0", "sensor-lag.signal0"]
        assert error(run.record(straight_lines(CHIRP, DT), N, DT, initial, START), expected) < 1e-6


def test_a_jump_of_the_force_switches_what_depends_on_it(with_law, tmp_path, opened_fmu):
    """An importer that holds the input makes it jump: the dead zone must see it at once, its output too."""
    model = with_law("actuator-dead-zone", quantity="acceleration", dry=0.0, preload=0.0)
    references, _, fmu = opened_fmu(export_fmu(model, tmp_path / "rig.fmu"))
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    threshold, mass = model.values()["actuator-dead-zone.threshold"], model.values()["mass"]
    for value in (0.5, -0.5, 0.0, 1.0):
        fmu.setReal([references["F"]], [value])
        reached = np.sign(value) * max(abs(value) - threshold, 0.0)
        assert fmu.getReal([references["x"]])[0] == pytest.approx(reached / mass)
    fmu.doStep(0.0, DT)
    reached = (1.0 - threshold) / mass
    assert fmu.getReal([references["velocity"]])[0] == pytest.approx(reached * DT, rel=1e-2)
    fmu.terminate()
