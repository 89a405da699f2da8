"""The compiled engine against an integrator that shares no code with it (Taylor series, dashpot.examples)."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.oscillator import integrate, integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Response
from dashpot.simulate.core import core_of, internal_step, step_for
from dashpot.simulate.force import staircase

DT = 1e-3


def simulated(values, force, dt, initial=(0.0, 0.0), step=None):
    model = Oscillator.from_values(values)
    core = core_of(model)
    p = np.array(list(model.values().values()))
    step = step or internal_step(model, model.values(), 9e-3)
    return core.record(p, np.array(initial), np.asarray(force, float), len(force), dt, step, states=True)


def sweep(amplitude, seconds=60.0, dt=DT):
    t = np.arange(round(seconds / dt)) * dt
    return amplitude * np.sin(2 * np.pi * (5.0 * t + 7.5 * t**2 / seconds))


@pytest.mark.parametrize("amplitude", [1.0, 0.1, 0.03])
def test_sweeps_agree_with_the_independent_integration(amplitude):
    force = sweep(amplitude)
    x, v = integrate(TRUTH, force, DT)
    z = simulated(TRUTH, force, DT)
    assert np.max(np.abs(z[:, 0] - x)) < 1e-6 * np.max(np.abs(x))
    assert np.max(np.abs(z[:, 1] - v)) < 1e-6 * np.max(np.abs(v))


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_a_held_force_acts_from_its_sample_on(quantity):
    force = sweep(1.0, 10.0, 4e-3)
    x, v = integrate_pieces(TRUTH, force[:-1, None], 4e-3)
    m, c, dry, k, c3, pre = (TRUTH[n] for n in ("mass", "viscous", "dry", "omega0", "cubic", "preload"))
    a = force / m - c * v - dry * np.sign(v) - k**2 * x - c3 * x**3 - pre * np.sign(x)
    expected = {"displacement": x, "velocity": v, "acceleration": a}[quantity][2:]  # at the first two friction holds it
    unit = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}[quantity]
    model = Oscillator.from_values(TRUTH, response=Response(quantity, unit))
    p, step = np.array(list(TRUTH.values())), internal_step(model, model.values(), 9e-3)
    y = core_of(model).record(p, np.zeros(2), staircase(force), force.size, 4e-3, step)[2:]
    assert np.max(np.abs(y - expected)) < 1e-5 * np.max(np.abs(expected))  # to the very last sample


def test_the_result_does_not_depend_on_the_communication_step():
    coarse = sweep(1.0, 20.0, 1e-2)  # straight lines over 10 ms
    fine = np.interp(np.arange(19_991) * DT, np.arange(coarse.size) * 1e-2, coarse)
    a = simulated(TRUTH, coarse, 1e-2)[:, 0]
    b = simulated(TRUTH, fine, DT)[::10, 0]
    assert np.max(np.abs(a - b)) < 1e-6 * np.max(np.abs(a))


@pytest.mark.parametrize("seed", range(12))
def test_random_rigs_with_noisy_forces(seed):
    random = np.random.default_rng(seed)
    omega0, scale = 80.0, 80.0**2 * 1e-3
    values = {
        "mass": random.uniform(0.1, 10),
        "omega0": omega0,
        "cubic": random.uniform(0, 1) * omega0**2 / 1e-6,
        "preload": scale * random.choice([0.0, 10 ** random.uniform(-3, -0.5)]),
        "viscous": omega0 * 10 ** random.uniform(-2, -0.5),
        "dry": scale * 10 ** random.uniform(-3, -0.5),
    }
    t = np.arange(1500) * DT
    force = np.sin(random.uniform(0.2, 2) * omega0 * t) + 0.1 * random.standard_normal(t.size)
    force *= 3 * values["mass"] * (values["preload"] + values["dry"] + 1e-2 * scale)
    force[1000:] = 0.0
    x, _ = integrate(values, force, DT)
    z = simulated(values, force, DT)
    assert np.max(np.abs(z[:, 0] - x)) < 1e-6 * np.max(np.abs(x))


def test_a_decay_comes_to_rest_at_the_seat_of_the_preload():
    z = simulated(TRUTH, np.zeros(6000), DT, (9e-3, 0.0))
    x, _ = integrate(TRUTH, np.zeros(6000), DT, 9e-3)
    assert np.max(np.abs(z[:, 0] - x)) < 1e-7 * 9e-3
    assert z[-1, 0] == 0.0
    assert z[-1, 1] == 0.0


def test_dry_friction_holds_and_lets_go_at_its_size():
    values = TRUTH | {"preload": 0.0, "cubic": 0.0}
    limit = values["mass"] * values["dry"]
    force = np.linspace(0.0, 2 * limit, 201)  # reaches the limit at sample 100
    z = simulated(values, force, DT)
    assert np.all(z[:101] == 0.0)
    assert np.all(z[102:, 0] > 0.0)


def test_friction_takes_the_textbook_amount_each_half_cycle():
    values = TRUTH | {"preload": 0.0, "cubic": 0.0, "viscous": 0.0, "omega0": 2 * np.pi}
    z = simulated(values, np.zeros(4001), DT, (0.01, 0.0), step=1e-3)
    loss = 2 * values["dry"] / (2 * np.pi) ** 2
    for half in range(1, 8):
        assert abs(z[500 * half, 0]) == pytest.approx(0.01 - loss * half, abs=1e-11)


def test_a_motion_without_bounds_ends_in_nan_and_not_in_a_crash():
    values = TRUTH | {"cubic": -4.6e8}  # a spring that gives way
    z = simulated(values, np.zeros(2000), DT, (1e-2, 0.0))
    assert np.all(np.isfinite(z[:10]))
    assert np.isnan(z[-1]).all()


def test_negative_friction_which_a_fit_may_try_still_simulates():
    values = TRUTH | {"dry": -0.01}
    assert np.all(np.isfinite(simulated(values, sweep(1.0, 10.0), DT)))


def test_events_that_only_dip_through_a_surface_are_found():
    values = TRUTH | {"cubic": 0.0, "viscous": 0.5}
    force = sweep(0.3, 5.0)
    coarse = simulated(values, force, DT, step=5e-3)[:, 0]
    x, _ = integrate(values, force, DT)
    assert np.max(np.abs(coarse - x)) < 1e-6 * np.max(np.abs(x))


@pytest.mark.parametrize(("load", "ends"), [(0.0, False), (40.0, True)])
def test_more_events_than_internal_steps_are_chatter(load, ends):
    """A mass in honey follows a force that turns at each sample: it turns once a sample, and where no load keeps it to
    one side it crosses the middle as often."""
    values = {"mass": 1.0, "omega0": 10.0, "cubic": 0.0, "preload": 1e-6, "viscous": 200.0, "dry": 1e-6}
    model = Oscillator.from_values(values)
    n, dt = 6000, 1e-2
    force = 10.0 * (-1.0) ** np.arange(n) + load
    begin = np.array([load / 100.0 + 0.0002, 0.0])
    x = core_of(model).record(np.array(list(values.values())), begin, staircase(force), n, dt, dt)
    assert bool(np.isfinite(x[-1])) is ends
    finer = core_of(model).record(np.array(list(values.values())), begin, staircase(force), n, dt, dt / 3)
    assert np.isfinite(finer[-1])  # three steps a sample leave room for two events


@pytest.mark.parametrize(("share", "ends"), [(0.6, True), (0.7, False)])
def test_a_part_of_a_recording_may_chatter(share, ends):
    """As a mass does that waits for its blow on the seats of a preloaded spring, with noise on its force."""
    values = {"mass": 1.0, "omega0": 10.0, "cubic": 0.0, "preload": 1e-6, "viscous": 200.0, "dry": 1e-6}
    n, dt = 6000, 1e-2
    force = 10.0 * (-1.0) ** np.arange(n) * (np.arange(n) < share * n)
    core = core_of(Oscillator.from_values(values))
    x = core.record(np.array(list(values.values())), np.array([2e-4, 0.0]), staircase(force), n, dt, dt)
    assert bool(np.isfinite(x[-1])) is ends


@pytest.mark.parametrize("cubic", [1e20, 1e30, 1e60])
def test_a_spring_so_stiff_that_nobody_could_wait_is_a_slip_of_units(cubic):
    model = Oscillator.from_values(TRUTH | {"cubic": cubic})
    with pytest.raises(BadInput, match="check units and parameters"):
        step_for(model, 1e-2, 4.0)
    sane = Oscillator.from_values(TRUTH)
    assert step_for(sane, 1e-2, 4.0) == internal_step(sane, sane.values(), 1e-2)
