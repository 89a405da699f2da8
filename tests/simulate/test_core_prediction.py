"""Prediction from sample to sample, and responses under signs that were kept; motions by the independent integrator."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.prediction import prediction_gain
from dashpot.model import Oscillator, Response
from dashpot.simulate import force as forces
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import force_between

DT, N = 1e-3, 3000
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
T = np.arange(N) * DT
FORCE = np.sin(2 * np.pi * (8.0 * T + 2.0 * T**2))


def core(quantity="displacement", **changed):
    values = TRUTH | changed
    model = Oscillator.from_values(values, response=Response(quantity, UNITS[quantity]))
    step = internal_step(model, model.values(), 9e-3)
    p = np.array(list(model.values().values()))

    def run(begin=(0.0, 0.0), force=FORCE, **more):
        return core_of(model).record(p, np.array(begin), force, N, DT, step, **more)

    return run


def shown(quantity, x, v, force):
    """What a sensor shows of the integrator's states, where the mass moves."""
    m, c, dry, w, c3, pre = (TRUTH[k] for k in ("mass", "viscous", "dry", "omega0", "cubic", "preload"))
    a = force / m - c * v - dry * np.sign(v) - w**2 * x - c3 * x**3 - pre * np.sign(x)
    return {"displacement": x, "velocity": v, "acceleration": a}[quantity]


@pytest.mark.parametrize("quantity", UNITS)
def test_a_gain_of_zero_is_simulation_to_the_bit(quantity):
    run = core(quantity)
    measured = np.random.default_rng(0).standard_normal(N)
    assert np.array_equal(run(measured=measured, gain=np.zeros(2)), run())
    states = run(measured=measured, gain=np.zeros(2), states=True)
    assert np.array_equal(states, run(states=True))


@pytest.mark.parametrize("memory", [1.0, 20.0])
@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_of_an_exact_model_nothing_is_left_to_correct(quantity, memory):
    x, v = integrate(TRUTH, FORCE, DT, 4e-3, 0.1)
    measured = shown(quantity, x, v, FORCE)
    gain = np.array(prediction_gain(memory, TRUTH["omega0"], DT, quantity))
    innovations = measured - core(quantity)((4e-3, 0.1), measured=measured, gain=gain)
    assert np.max(np.abs(innovations)) < 1e-6 * np.max(np.abs(measured))


def test_an_accelerations_innovations_vanish_but_for_the_samples_beside_a_jump():
    """Where an event falls within rounding of a sample, either side of it is right."""
    x, v = integrate(TRUTH, FORCE, DT, 4e-3, 0.1)
    measured = shown("acceleration", x, v, FORCE)
    gain = np.array(prediction_gain(5.0, TRUTH["omega0"], DT, "acceleration"))
    innovations = np.abs(measured - core("acceleration")((4e-3, 0.1), measured=measured, gain=gain))
    beside = (np.diff(np.sign(x), append=1) != 0) | (np.diff(np.sign(v), append=1) != 0)
    assert np.max(innovations[~beside]) < 1e-5 * np.max(np.abs(measured))


@pytest.mark.parametrize("quantity", UNITS)
def test_a_wrong_beginning_is_forgotten_at_the_rate_of_the_memory(quantity):
    """Small motion of a linear rig without damping, so that the closed form of the filter holds."""
    bare = {"cubic": 0.0, "preload": 0.0, "dry": 0.0, "viscous": 0.0}
    run, memory = core(quantity, **bare), 3.0
    cycle = 2 * np.pi / TRUTH["omega0"]
    x = 1e-3 * np.cos(TRUTH["omega0"] * T)
    measured = {"displacement": x, "velocity": None, "acceleration": -(TRUTH["omega0"] ** 2) * x}[quantity]
    if measured is None:
        measured = -1e-3 * TRUTH["omega0"] * np.sin(TRUTH["omega0"] * T)
    gain = np.array(prediction_gain(memory, TRUTH["omega0"], DT, quantity))
    errors = np.abs(run((2e-3, 0.0), None, measured=measured, gain=gain) - measured)
    count = round(memory * cycle / DT)
    sizes = [np.max(errors[k * count : (k + 1) * count]) for k in range(6)]
    assert np.array(sizes[1:]) / np.array(sizes[:-1]) == pytest.approx(np.exp(-1.0), rel=0.08)
    free = np.abs(run((2e-3, 0.0), None) - measured)
    assert np.max(free[-count:]) == pytest.approx(np.max(free[:count]), rel=0.01)  # which simulation never does


def test_a_prediction_follows_a_rig_that_is_not_the_model():
    """One per cent of frequency adds up to half a turn in simulation, and here to what a cycle's memory holds."""
    ringing = {"viscous": 0.3}
    x, _ = integrate(TRUTH | ringing, np.zeros(N), DT, 9e-3, 0.0)
    run = core(omega0=1.01 * TRUTH["omega0"], **ringing)
    gain = np.array(prediction_gain(1.0, TRUTH["omega0"], DT, "displacement"))
    predicted = run((9e-3, 0.0), None, measured=x, gain=gain)
    simulated = run((9e-3, 0.0), None)
    assert np.std(predicted - x) < 0.01 * 2 * np.pi * np.std(x)
    assert np.std(simulated - x) > 0.5 * np.std(x)


def test_under_kept_signs_a_jump_of_the_acceleration_has_a_derivative():
    """Another frequency moves each event by a part of a sample: at those that it passes the acceleration jumps."""
    base, step = TRUTH["omega0"], 1e-5
    begin, moving = (9e-3, 0.0), slice(0, 1200)  # long before it comes to rest

    def quotients(**more):
        back, at, ahead = (
            core("acceleration", omega0=base * (1 + k * step))(begin, None, **more)[moving] for k in (-1, 0, 1)
        )
        return (ahead - at) / (base * step), (at - back) / (base * step)

    model = Oscillator.from_values(TRUTH, response=Response("acceleration", UNITS["acceleration"]))
    signs = core_of(model).signs(N)
    core("acceleration")(begin, None, keep=signs)
    forward, backward = quotients(signs=signs)
    size = np.max(np.abs(forward))
    assert np.max(np.abs(forward - backward)) < 1e-3 * size
    plain = quotients()
    apart = np.abs(plain[0] - plain[1])
    assert np.max(apart) > size  # twice the preload over a small step
    smooth = apart < 1e-3 * size
    assert np.mean(smooth) > 0.95  # elsewhere both are the same derivative
    assert plain[0][smooth] == pytest.approx(forward[smooth], abs=2e-3 * size)


@pytest.mark.parametrize("quantity", UNITS)
def test_signs_kept_and_given_back_change_nothing(quantity):
    run = core(quantity)
    model = Oscillator.from_values(TRUTH, response=Response(quantity, UNITS[quantity]))
    signs = core_of(model).signs(N)
    plain = run(keep=signs)
    assert np.array_equal(run(signs=signs), plain)
    assert np.array_equal(run(), plain)


def test_kept_signs_are_those_of_the_motion():
    x, v = integrate(TRUTH, FORCE, DT, 4e-3, 0.1)
    signs = core_of(Oscillator.from_values(TRUTH)).signs(N)
    core()((4e-3, 0.1), keep=signs)
    surfaces = signs[:, :-1].astype(int)
    clear = (np.abs(x) > 1e-7) & (np.abs(v) > 1e-5)
    expected = {tuple(np.sign(x[clear]).astype(int)), tuple(np.sign(v[clear]).astype(int))}
    assert expected == {tuple(column) for column in surfaces[clear].T}


def test_a_force_that_is_too_short_is_refused():
    with pytest.raises(BadInput, match="the force covers 100 samples where 3000 are needed"):
        core()(force=FORCE[:100])


@pytest.mark.parametrize("hold", ["zero", "linear", "smooth"])
@pytest.mark.parametrize("highest", [10.0, 100.0])
def test_what_is_added_to_a_force_is_as_if_it_had_been_in_its_pieces(hold, highest):
    run, force = core(), force_between(FORCE, DT, hold, highest)
    samples = 0.1 * np.random.default_rng(0).standard_normal(N)
    expected = run(force=force.with_added(samples, DT).shifted(0.05))
    room = np.empty(N)
    assert run(force=force, added=samples, load=0.05, out=room) is room
    assert np.array_equal(room, expected)


def test_pieces_that_are_joined_on_the_way_are_those_of_a_coarser_force(monkeypatch):
    run, force = core(), force_between(FORCE, DT, "smooth", 150.0)
    assert force.fine == 5
    other = force_between(FORCE, DT, "smooth", 200.0)
    assert other.fine == 6
    expected = [run(force=force.coarser(5, DT)), run(force=other.coarser(3, DT))]
    monkeypatch.setattr(forces, "_LONG", 1000)
    joined = [force.coarser(5, DT), other.coarser(3, DT)]
    assert [one.joined for one in joined] == [5, 3]
    assert joined[0].pieces is force.pieces
    for one, y in zip(joined, expected, strict=True):
        assert run(force=one) == pytest.approx(y, abs=1e-12 * np.max(np.abs(y)))
