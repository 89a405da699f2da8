"""Inner states that begin at their limits."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.replay import replayed
from dashpot.identify.problem.state_limits import nearest_reach
from dashpot.model import oscillator_with
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

BASE = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.5, "dry": 0.0}
HYSTERESIS = {"stiffness": 900.0, "limit": 2e-4, "exponent": 10.0, "loading": 0.5}


def test_only_limited_states_move_and_the_best_place_wins():
    initial, reaches = np.array([1.0, 2.0, 0.1, 5.0]), np.array([0.0, 0.0, 1.0, 0.0])
    moved = nearest_reach(initial, reaches, (0, 1, 2, 3), lambda z: abs(z[2] + 1.0))
    assert moved == pytest.approx([1.0, 2.0, -0.98, 5.0])
    kept = nearest_reach(initial, reaches, (0, 1, 2, 3), lambda z: abs(z[2] - 0.1))
    assert np.array_equal(kept, initial)
    assert np.array_equal(nearest_reach(initial, reaches, (0, 1), lambda z: abs(z[2])), initial)


def test_a_decay_that_begins_sliding_is_replayed():
    model = oscillator_with(
        BASE | {f"hysteresis.{name}": value for name, value in HYSTERESIS.items()}, effects=("hysteresis",)
    )
    n, fs = 3000, 1000.0

    def rates(_t, state):
        """Its steps bend within a hair of the limit: small steps of a method that shares nothing with the product."""
        x, v, z = state
        slide = abs(z / HYSTERESIS["limit"]) ** HYSTERESIS["exponent"] * (0.5 * np.sign(v * z) + 0.5)
        force = BASE["viscous"] * v + BASE["omega0"] ** 2 * x + HYSTERESIS["stiffness"] * z
        return v, -force, v * (1 - slide)

    begin = (4e-3, 0.0, 0.97 * HYSTERESIS["limit"])
    times = np.arange(n) / fs
    clean = solve_ivp(rates, (0, n / fs), begin, "DOP853", times, rtol=1e-9, atol=1e-12, max_step=0.5 / fs).y[0]
    noise = 1e-6 * np.random.default_rng(2).standard_normal(n)
    simulated = replayed(model, Recording(name="decay", fs=fs, response=clean + noise)).response
    assert np.sqrt(np.mean((simulated - clean) ** 2)) < 3e-6
