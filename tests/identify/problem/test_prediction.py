"""The gain from simulation to prediction against the closed loop that it makes: eigenvalues, and an error that dies."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.prediction import FREE, prediction_gain

OMEGA = 79.6
#: What each quantity shows of displacement and velocity, for an undamped oscillator.
SHOWN = {"displacement": (1.0, 0.0), "velocity": (0.0, 1.0), "acceleration": (-(OMEGA**2), 0.0)}


def turned(dt):
    """Exact transition of x'' + omega² x = 0 over dt."""
    c, s = np.cos(OMEGA * dt), np.sin(OMEGA * dt)
    return np.array([[c, s / OMEGA], [-OMEGA * s, c]])


def closed_loop(memory, dt, quantity):
    gain = np.array(prediction_gain(memory, OMEGA, dt, quantity))
    return turned(dt) @ (np.eye(2) - np.outer(gain, SHOWN[quantity]))


@pytest.mark.parametrize("quantity", SHOWN)
@pytest.mark.parametrize("per_cycle", [20, 80, 1000])
@pytest.mark.parametrize("memory", [1.0, 8.0, 64.0, 512.0])
def test_an_error_falls_to_one_e_th_in_the_memory(quantity, per_cycle, memory):
    dt = 2 * np.pi / OMEGA / per_cycle
    slowest = np.max(np.abs(np.linalg.eigvals(closed_loop(memory, dt, quantity))))
    cycles = -1.0 / (per_cycle * np.log(slowest))
    assert cycles == pytest.approx(memory, rel=0.05)


@pytest.mark.parametrize("quantity", SHOWN)
def test_an_error_of_the_state_dies_sample_by_sample(quantity):
    """From whichever side of the cycle it starts: nothing of it may hide from the sensor."""
    memory, per_cycle = 3.0, 50
    loop = closed_loop(memory, 2 * np.pi / OMEGA / per_cycle, quantity)
    over = np.linalg.matrix_power(loop, round(memory * per_cycle))
    scaled = np.diag([1.0, 1.0 / OMEGA]) @ over @ np.diag([1.0, OMEGA])  # both in units of displacement
    for phase in np.linspace(0.0, np.pi, 9):
        begin = np.array([np.cos(phase), np.sin(phase)])
        assert np.linalg.norm(scaled @ begin) == pytest.approx(np.exp(-1.0), rel=0.25)


@pytest.mark.parametrize("quantity", SHOWN)
def test_the_gain_is_that_of_the_rig_whatever_its_pace(quantity):
    """The same memory in cycles at another frequency and the same samples a cycle: the same loop."""
    slow = prediction_gain(5.0, 2.0, 0.05, quantity)
    fast = prediction_gain(5.0, 200.0, 0.0005, quantity)
    unit = 100.0 ** {"displacement": 0, "velocity": 1, "acceleration": 2}[quantity]
    assert fast[0] * unit == pytest.approx(slow[0], rel=1e-9)
    assert fast[1] * unit == pytest.approx(100.0 * slow[1], rel=1e-9)


@pytest.mark.parametrize("quantity", SHOWN)
@pytest.mark.parametrize("per_cycle", [7, 60])
def test_the_gain_is_the_limit_of_a_kalman_filter_run_sample_by_sample(quantity, per_cycle):
    """In SI units, what the latent force adds within a sample by quadrature, and Riccati's recursion (Kalman 1960)."""
    memory, dt = 0.7, 2 * np.pi / OMEGA / per_cycle
    order = list(SHOWN).index(quantity)
    sensor = OMEGA ** (2 * order) / dt  # variance of a sample where the displacement's noise has a density of one
    push = (OMEGA**2 / (np.pi * memory)) ** 2
    nodes, weights = np.polynomial.legendre.leggauss(20)
    ages = 0.5 * dt * (nodes + 1.0)
    moved = np.array([np.sin(OMEGA * ages) / OMEGA, np.cos(OMEGA * ages)])  # by a unit of impulse at that age
    added = push * (moved * (0.5 * dt * weights)) @ moved.T
    seen, spread = np.array(SHOWN[quantity]), np.eye(2)
    for _ in range(40 * per_cycle):
        gain = spread @ seen / (seen @ spread @ seen + sensor)
        spread = turned(dt) @ (spread - np.outer(gain, seen @ spread)) @ turned(dt).T + added
    assert prediction_gain(memory, OMEGA, dt, quantity) == pytest.approx(tuple(gain), rel=1e-6)


@pytest.mark.parametrize("quantity", SHOWN)
def test_a_free_model_is_not_corrected(quantity):
    assert prediction_gain(FREE, OMEGA, 1e-3, quantity) == (0.0, 0.0)
    far = np.array(prediction_gain(1e4, OMEGA, 1e-3, quantity)) * np.abs(SHOWN[quantity][0] or SHOWN[quantity][1])
    assert 0.0 < np.hypot(far[0], far[1] / OMEGA) < 1e-3  # ... to which long memories lead


@pytest.mark.parametrize("quantity", ["", "strain"])
def test_a_quantity_that_nobody_knows_is_an_error(quantity):
    with pytest.raises(ValueError, match="index"):
        prediction_gain(1.0, OMEGA, 1e-3, quantity)


@pytest.mark.parametrize("quantity", SHOWN)
def test_half_the_sampling_rate_has_a_gain_too(quantity):
    """There no sample shows the phase, and the filter's equation has no solution."""
    assert np.all(np.isfinite(prediction_gain(1.0, OMEGA, np.pi / OMEGA, quantity)))
