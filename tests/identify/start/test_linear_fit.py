"""A linear rig fitted from no start at all: against motions in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify.problem.segments import Segment
from dashpot.identify.start.linear_fit import LinearFit, _free_places, _peaks, linear_fit
from dashpot.identify.start.linear_response import Signal, linear_response
from dashpot.simulate.force import staircase, straight_lines
from scipy.signal import cont2discrete

OMEGA0, VISCOUS, MASS = 30.0, 1.5, 0.4
QUANTITIES = ("displacement", "velocity", "acceleration")
A = np.array([[0.0, 1.0], [-(OMEGA0**2), -VISCOUS]])


def segment(response, dt, force=None, pace=OMEGA0, **more):
    given = {"recording": 0, "start": 0, "stop": response.size, "time": 0.0}
    return Segment(response=response, force=force, dt=dt, pace=pace, **(given | more))


def shown(x, v, push, quantity):
    return {"displacement": x, "velocity": v, "acceleration": push - OMEGA0**2 * x - VISCOUS * v}[quantity]


def free(dt, n, quantity="displacement", begin=(1e-3, 0.02), offset=0.0, **more):
    """Damped sine in closed form."""
    rate = VISCOUS / 2
    omega = np.sqrt(OMEGA0**2 - rate**2)
    t = dt * np.arange(n)
    b = (begin[1] + rate * begin[0]) / omega
    fall = np.exp(-rate * t)
    x = fall * (begin[0] * np.cos(omega * t) + b * np.sin(omega * t))
    v = fall * ((b * omega - rate * begin[0]) * np.cos(omega * t) - (begin[0] * omega + rate * b) * np.sin(omega * t))
    return segment(shown(x, v, 0.0, quantity) + offset, dt, quantity=quantity, **more)


def driven(dt, n, quantity="displacement", hold="zero", offset=0.0, sign=1.0, **more):
    """From rest, by the exact discrete form of the state space for a force that is held, or in straight lines."""
    t = dt * np.arange(n)
    push = np.where(t > 0.0, np.sin(2 * np.pi * (2.0 * t + 3.0 / t[-1] * t**2)) + 0.3, 0.0)
    plant = (A, np.array([[0.0], [1.0 / MASS]]), np.eye(2), np.zeros((2, 1)))
    top, below, c, d = cont2discrete(plant, dt, {"zero": "zoh", "linear": "foh"}[hold])[:4]
    x, v = (states_of(top, below, push) @ c.T + np.outer(push, d[:, 0])).T
    force = staircase(sign * push) if hold == "zero" else straight_lines(sign * push, dt)
    return segment(shown(x, v, push / MASS, quantity) + offset, dt, force, quantity=quantity, **more)


def states_of(top, below, push):
    """(n, 2) z[k + 1] = top z[k] + below push[k] from zero."""
    states = np.zeros((push.size, 2))
    for k in range(push.size - 1):
        states[k + 1] = top @ states[k] + below[:, 0] * push[k]
    return states


def fit(*segments) -> LinearFit:
    found = linear_fit(segments)
    assert found is not None
    return found


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize(("dt", "n"), [(0.01, 700), (1e-3, 5000)])
def test_a_free_decay(quantity, dt, n):
    """21 and 209 samples a cycle, of which 32 are enough."""
    offset = 0.7 * OMEGA0 ** QUANTITIES.index(quantity) * 1e-3
    found = fit(free(dt, n, quantity, offset=offset))
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-6)
    assert found.viscous == pytest.approx(VISCOUS, rel=1e-5)
    assert found.mass is None
    assert found.initial[0] == pytest.approx([1e-3, 0.02], rel=1e-4)
    assert found.offsets == pytest.approx([offset], rel=1e-4)
    assert found.nrmse[0] < 1e-5


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_driven_motion(quantity, hold):
    """Held or in straight lines at 21 samples a cycle: exact."""
    offset = 0.7 * OMEGA0 ** QUANTITIES.index(quantity) * 1e-3
    found = fit(driven(0.01, 800, quantity, hold, offset))
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-5)
    assert found.viscous == pytest.approx(VISCOUS, rel=1e-4)
    assert found.mass == pytest.approx(MASS, rel=1e-4)
    assert found.offsets == pytest.approx([offset], rel=1e-2)
    assert np.abs(found.initial[0]) == pytest.approx([0.0, 0.0], abs=1e-5)
    assert found.nrmse[0] < 1e-4


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_of_many_samples_a_cycle_some_are_enough(hold):
    found = fit(driven(1e-3, 6000, hold=hold))
    assert found.omega0 == pytest.approx(OMEGA0, rel=2e-4)
    assert found.viscous == pytest.approx(VISCOUS, rel=5e-3)
    assert found.mass == pytest.approx(MASS, rel=1e-2)
    assert found.nrmse[0] < 0.01


def test_all_segments_agree_on_one_rig():
    """Each has its own beginning and its own zero, and counts alike however large it is."""
    parts = free(0.01, 700, begin=(2e-3, 0.0)), driven(0.01, 800, offset=1e-3), free(0.005, 1500, begin=(0.0, 3.0))
    found = fit(*parts)
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-5)
    assert found.mass == pytest.approx(MASS, rel=1e-3)
    assert found.initial == pytest.approx(np.array([[2e-3, 0.0], [0.0, 0.0], [0.0, 3.0]]), abs=2e-5)
    assert found.offsets == pytest.approx([0.0, 1e-3, 0.0], abs=1e-5)
    assert found.nrmse.size == 3


def test_what_it_leaves_is_a_part_of_the_motion():
    decay = free(0.01, 2000, begin=(1e-3, 0.0))
    spread = float(np.std(decay.response))
    noise = 0.3 * spread * np.random.default_rng(0).standard_normal(2000)
    noisy = replace(decay, response=decay.response + noise)
    assert fit(noisy).nrmse[0] == pytest.approx(0.3 / np.hypot(1.0, 0.3), rel=0.05)


def test_a_rig_that_goes_against_its_force_has_no_mass():
    found = fit(driven(0.01, 800, sign=-1.0))
    assert found.mass is None
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-5)


@pytest.mark.parametrize("pace", [OMEGA0 / 4.0, OMEGA0 * 4.0])
def test_it_is_found_far_from_the_pace(pace):
    found = fit(driven(0.01, 800, pace=pace))
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-3)
    assert fit(free(0.01, 700, pace=pace)).omega0 == pytest.approx(OMEGA0, rel=1e-3)


def test_what_rings_the_longest_is_fitted_and_not_what_is_loud_at_once():
    """Of two modes the one that takes most of the motion."""
    t = 0.01 * np.arange(1500)
    other = 1e-3 * np.exp(-20.0 * t) * np.cos(80.0 * t)
    decay = free(0.01, 1500)
    assert fit(replace(decay, response=decay.response + other)).omega0 == pytest.approx(OMEGA0, rel=5e-3)


def test_of_several_ends_of_the_search_the_best_is_taken():
    """Two modes of nearly the same power; the rate of the weaker one is among those tried, that of the stronger not."""
    t = 0.01 * np.arange(700)
    rates, omegas = np.array([1.7, 1.0]) / t[-1], (30.0, 47.0)
    power = (1 - np.exp(-2 * rates * t[-1])) / rates
    sizes = np.sqrt(np.array([1.03, 1.0]) / power)
    x = sum(a * np.exp(-r * t) * np.cos(w * t) for a, r, w in zip(sizes, rates, omegas, strict=True))
    assert fit(segment(np.asarray(x), 0.01)).omega0 == pytest.approx(30.0, rel=1e-2)


def test_peaks_are_the_three_highest():
    """Of a plateau its last; the ends are none."""
    assert _peaks(np.array([9.0, 1.0, 2.0, 0.0, 5.0, 5.0, 0.0, 3.0, 0.0, 2.5, 0.0, 8.0])) == [5, 7, 9]
    assert _peaks(np.array([1.0, 2.0, 3.0])) == []


def test_places_to_begin_at():
    """The frequencies of both motions, also that which the coarser sampling does not hold; rates by the longest."""
    slow = free(0.01, 700)
    t = 0.005 * np.arange(600)
    fast = segment(np.exp(-0.5 * t) * np.cos(400.0 * t), 0.005)
    places = _free_places([Signal(slow), Signal(fast)])
    omegas, rates = map(np.array, zip(*places, strict=True))
    assert np.min(np.abs(omegas - OMEGA0)) < 0.3
    assert np.min(np.abs(omegas - 400.0)) < 0.3
    assert np.unique(rates) == pytest.approx(np.array([0.3, 1.0, 3.0, 10.0, 30.0]) / (699 * 0.01))
    assert np.min(omegas) >= 4 * np.pi / (699 * 0.01)  # two cycles
    assert len(places) <= 15
    assert _free_places([]) == []


def test_where_there_is_no_frequency_there_is_no_fit():
    assert linear_fit([]) is None
    assert linear_fit([segment(np.zeros(80), 0.01)]) is None  # at rest
    assert linear_fit([free(0.01, 700, slide=True)]) is None
    assert linear_fit([free(0.01, 700), free(0.01, 700, slide=True)]) is None


def test_a_segment_that_stands_still_spoils_nothing():
    found = fit(free(0.01, 700), segment(np.full(700, 2.0), 0.01))
    assert found.omega0 == pytest.approx(OMEGA0, rel=1e-5)
    assert found.offsets[1] == pytest.approx(2.0)


def test_what_falls_within_a_sample_is_no_column_to_divide_by():
    """A sine begins at zero, and of one that is over at the next sample nothing is left."""
    signal = Signal(free(1e-3, 4000))
    (rest,) = linear_response([signal], np.log([1e7, 1e7])).rests
    assert np.sum(rest**2) == pytest.approx(np.sum((signal.measured - np.mean(signal.measured)) ** 2), rel=2e-2)


@pytest.mark.parametrize("seed", range(4))
def test_no_alias_of_the_samples_that_places_are_compared_by_is_taken(seed):
    """A sine and its alias leave the same of every seventh sample; the last digits, here of seeds 0 and 2, decide."""
    decay = free(2 * np.pi / OMEGA0 / 56, 40 * 56, begin=(1e-3, 0.0))
    noise = 1e-6 * np.random.default_rng(seed).standard_normal(decay.n)
    assert fit(replace(decay, response=decay.response + noise)).omega0 == pytest.approx(OMEGA0, rel=1e-4)
