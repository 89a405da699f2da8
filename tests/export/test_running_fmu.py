"""FMUs run under FMPy: against the core, against an independent integrator, at any communication step."""

from __future__ import annotations

import threading
from itertools import pairwise

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.export.smoothing import amplitude_of
from dashpot.simulate.core import core_of, internal_step

DT = 1e-3
BACKENDS = ["native", "python"]
KINDS = ["base", "massless", "drag", "velocity", "acceleration"]


def sweep(n: int, amplitude: float = 1.0, start: float = 5.0, end: float = 20.0) -> np.ndarray:
    t = np.arange(n) * DT
    return amplitude * np.sin(2 * np.pi * (start * t + (end - start) * t**2 / (2 * n * DT)))


def reference(oscillator, force: np.ndarray | None, n: int, initial=(0.0, 0.0), dt: float = DT) -> np.ndarray:
    values = oscillator.values()
    step = internal_step(oscillator, values, amplitude_of(oscillator))
    return core_of(oscillator).record(np.array(list(values.values())), np.array(initial), force, n, dt, step)


@pytest.mark.parametrize("kind", KINDS)
def test_native_fmu_repeats_the_core(instances, models, kind):
    n = 3000
    force = sweep(n, 1.0 if kind != "massless" else 4.0)
    expected = reference(models[kind](), force, n)
    x = np.array(instances(kind).start(F=force[0]).record(force, DT, "x"))[:, 0]
    assert np.abs(x - expected).max() <= 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("kind", KINDS)
def test_python_fmu_agrees_with_the_core(instances, models, kind):
    n = 600
    force = sweep(n, 1.0 if kind != "massless" else 4.0, 8.0, 15.0)
    expected = reference(models[kind](), force, n)
    x = np.array(instances(kind, "python").start(F=force[0]).record(force, DT, "x"))[:, 0]
    assert np.abs(x - expected).max() <= 1e-8 * np.abs(expected).max()


@pytest.mark.parametrize("amplitude", [1.0, 0.1, 0.03])
def test_fmu_agrees_with_an_independent_integrator_over_the_sweep(instances, models, amplitude):
    n = 8000
    force = sweep(n, amplitude)
    exact, speed = integrate(models["base"]().values(), force, DT)
    rows = np.array(instances().start().record(force, DT, "x", "velocity"))
    assert np.abs(rows[:, 0] - exact).max() <= 1e-6 * np.abs(exact).max()
    assert np.abs(rows[:, 1] - speed).max() <= 1e-6 * np.abs(speed).max()


@pytest.mark.parametrize("backend", BACKENDS)
def test_free_decay_sticks_for_good(instances, models, backend):
    fmu = instances("base", backend).start(x0=5e-3, v0=0.1)
    rows = []
    for k in range(2500):
        fmu.step(k * DT, DT)
        rows.append(fmu.get("displacement", "velocity", "acceleration"))
    expected = reference(models["base"](), None, len(rows) + 1, (5e-3, 0.1))[1:]
    allowed = 1e-9 if backend == "native" else 1e-6  # CasADi's step takes eight events a step, the engine all of them
    assert np.abs(np.array(rows)[:, 0] - expected).max() <= allowed * 5e-3
    assert rows[-1][1:] == [0.0, 0.0]
    assert rows[-1] == rows[-100]


def test_communication_step_does_not_matter(instances):
    """One force with corners every 10 ms, communicated at 1 ms, 10 ms and at irregular times."""
    corners = 0.4 * np.sin(np.arange(101) * 0.9)
    grids = {
        "fine": np.linspace(0.0, 0.01, 11),
        "coarse": np.array([0.0, 0.01]),
        "uneven": np.array([0.0, 1.3e-4, 1.4e-4, 4.7e-3, 9.999e-3, 0.01]),
    }
    runs = {}
    for name, grid in grids.items():
        fmu = instances().start()
        runs[name] = []
        for k in range(len(corners) - 1):
            slope = (corners[k + 1] - corners[k]) / 0.01
            for a, b in pairwise(grid):
                fmu.step(k * 0.01 + a, b - a, corners[k] + slope * a, corners[k] + slope * b)
            runs[name].append(fmu.get("x", "velocity"))
    fine = np.array(runs["fine"])
    for name in ("coarse", "uneven"):
        error = np.abs(np.array(runs[name]) - fine).max(axis=0) / np.abs(fine).max(axis=0)
        assert error.max() <= 1e-6, name


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_slope_lasts_as_documented(instances, backend):
    fmu = instances("base", backend).start()
    fmu.step(0.0, DT, 0.1, 0.2)
    assert fmu.get("F")[0] == pytest.approx(0.2, rel=1e-12)  # where the straight line came to
    fmu.step(DT, DT)
    # FMI 2's derivative is for one step; the input F_rate holds until it is set, as inputs do.
    assert fmu.get("F")[0] == pytest.approx(0.2 if backend == "native" else 0.3, rel=1e-12)


def test_a_force_with_higher_derivatives_runs_as_a_cubic(instances):
    """One step along the cubic equals a thousand along its chords."""
    cubic = np.polynomial.Polynomial([0.1, 30.0, -4e3, 2e5])
    coarse, fine = instances().start(F=0.1), instances().start(F=0.1)
    coarse.fmu.setRealInputDerivatives([0, 0, 0], [1, 2, 3], [float(cubic.deriv(n)(0.0)) for n in (1, 2, 3)])
    coarse.fmu.doStep(0.0, 0.02)
    for k in range(1000):
        fine.step(k * 2e-5, 2e-5, cubic(k * 2e-5), cubic((k + 1) * 2e-5))
    assert coarse.get("F")[0] == pytest.approx(cubic(0.02), rel=1e-12)
    assert coarse.get("x", "velocity") == pytest.approx(fine.get("x", "velocity"), rel=1e-6)


def test_without_slopes_the_input_is_held(instances):
    held, straight = instances().start(), instances().start()
    for k in range(50):
        held.step(k * DT, DT, 0.3)
        straight.step(k * DT, DT, 0.3, 0.3)
    assert held.get("x", "velocity") == straight.get("x", "velocity")


@pytest.mark.parametrize("backend", BACKENDS)
def test_outputs_after_initialisation_and_feedthrough(instances, models, backend):
    values = models["base"]().values()
    fmu = instances("base", backend).start(F=0.5, x0=1e-3, v0=-0.2)
    restoring = values["omega0"] ** 2 * 1e-3 + values["cubic"] * 1e-9 + values["preload"]
    inner = restoring - 0.2 * values["viscous"] - values["dry"]
    expected = [1e-3, 1e-3, -0.2, 0.5 / values["mass"] - inner]
    assert fmu.get("x", "displacement", "velocity", "acceleration") == pytest.approx(expected, rel=1e-12)
    fmu.set(F=0.7)
    assert fmu.get("acceleration")[0] == pytest.approx(0.7 / values["mass"] - inner, rel=1e-12)
    assert instances("acceleration", backend).start(F=0.5, x0=1e-3, v0=-0.2).get("x") == pytest.approx(expected[3:])


@pytest.mark.parametrize("backend", BACKENDS)
def test_initialisation_mode_shows_what_was_set_last(instances, backend):
    fmu = instances("base", backend)
    fmu.fmu.setupExperiment(startTime=0.0)
    fmu.set(x0=1e-3)  # before initialization mode, as start values may be
    fmu.fmu.enterInitializationMode()
    assert fmu.get("x", "velocity") == [1e-3, 0.0]
    fmu.set(x0=2e-3, v0=0.5)
    assert fmu.get("x", "velocity") == [2e-3, 0.5]
    fmu.fmu.exitInitializationMode()
    assert fmu.get("x", "velocity") == [2e-3, 0.5]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_parameter_changed_during_the_run_counts_from_there(instances, models, backend):
    """The second half with other parameters equals a run that starts there with them."""
    changed = {"omega0": 95.0, "dry": 0.3, "preload": 0.5, "mass": 0.4}
    force = sweep(200, 0.5)
    fmu = instances("base", backend).start()
    fmu.record(force, DT, "x")
    x0, v0 = fmu.get("displacement", "velocity")
    fmu.set(**changed)
    fresh = instances("base", backend).start(x0=x0, v0=v0, F=force[-1], **changed)
    assert fmu.get("x", "acceleration") == pytest.approx(fresh.get("x", "acceleration"), rel=1e-12)
    tail, offset = sweep(200, 0.5, 12.0, 12.0), 199
    for k in range(199):
        fmu.step((offset + k) * DT, DT, tail[k], tail[k + 1])
        fresh.step(k * DT, DT, tail[k], tail[k + 1])
    assert fmu.get("x", "velocity") == pytest.approx(fresh.get("x", "velocity"), rel=1e-9)
    assert fmu.get("omega0") == [95.0]


def test_at_rest_a_jump_of_the_force_decides_at_once(instances):
    fmu = instances().start()
    for _ in range(2):
        assert fmu.get("acceleration") == [0.0]  # held by preload and friction
        fmu.set(F=0.5)
        assert fmu.get("acceleration")[0] == pytest.approx((0.5 - 0.02) / 0.27 - 0.015)
        fmu.set(F=0.0)
    fmu.step(0.0, DT)
    assert fmu.get("x", "velocity", "acceleration") == [0.0, 0.0, 0.0]


def test_shorter_internal_steps_are_an_option(instances, models):
    force = sweep(500)
    exact, _ = integrate(models["base"]().values(), force, DT)
    coarse, fine = (np.array(instances().start(max_step=step).record(force, DT, "x"))[:, 0] for step in (DT, DT / 4))
    assert np.abs(fine - exact).max() < 0.1 * np.abs(coarse - exact).max()


def test_a_model_may_start_at_any_time(instances):
    force = sweep(100)
    late, early = instances().start(at=1000.0), instances().start(at=0.0)
    for k in range(99):
        late.step(1000.0 + k * DT, DT, force[k], force[k + 1])
        early.step(k * DT, DT, force[k], force[k + 1])
    assert late.get("x", "velocity") == early.get("x", "velocity")


def test_fmpy_simulates_it_as_it_is(fmus, models):
    from fmpy import simulate_fmu

    t = np.arange(0, 0.5, 1e-3)
    signal = np.array(list(zip(t, sweep(len(t)), strict=True)), dtype=[("time", float), ("F", float)])
    for backend in BACKENDS:
        result = simulate_fmu(
            str(fmus("base", backend)), stop_time=0.4, output_interval=1e-3, input=signal, start_values={"dry": 0.1}
        )
        assert np.isfinite(result["x"]).all()
        assert 1e-4 < np.abs(result["x"]).max() < 0.1


def test_two_instances_in_two_threads_do_not_meet(instances, models):
    forces = [sweep(2000), sweep(2000, 0.3, 20.0, 5.0)]
    alone = [np.array(instances().start().record(force, DT, "x")) for force in forces]
    together: list[np.ndarray] = [np.empty(0), np.empty(0)]
    made = [instances().start(), instances().start()]

    def run(i: int) -> None:
        together[i] = np.array(made[i].record(forces[i], DT, "x"))

    threads = [threading.Thread(target=run, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))
    assert not np.array_equal(alone[0], alone[1])


def test_two_models_in_one_process_do_not_meet(instances, models):
    for backend in BACKENDS:
        kinds = ("base", "drag")
        force = sweep(100)
        made = [instances(kind, backend).start() for kind in kinds]
        for k in range(99):
            for fmu in made:
                fmu.step(k * DT, DT, force[k], force[k + 1])
        for kind, fmu in zip(kinds, made, strict=True):
            assert fmu.get("x")[0] == pytest.approx(reference(models[kind](), force, 100)[-1], rel=1e-8)
