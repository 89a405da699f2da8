"""Laws along a motion that is given: a linear law of the force's path is a filter, exact at any of its times."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.equivalent import along_of
from dashpot.model.library import find

DT = 1e-4
T = DT * np.arange(20_000)
OMEGA = 2 * np.pi * 12.0


def driven(force):
    return np.column_stack([0 * T, 0 * T, T, force])


@pytest.mark.parametrize("time", [1e-7, 1e-5, 1e-3, 3e-2])
def test_a_lag_of_first_order_in_closed_form(time):
    (arrived,) = along_of(find("actuator-lag"))({"time": time}, driven(np.sin(OMEGA * T)), DT)
    turn = OMEGA * time
    exact = (np.sin(OMEGA * T) - turn * np.cos(OMEGA * T) + turn * np.exp(-T / time)) / (1 + turn**2)
    assert np.max(np.abs(arrived - exact)) < 1e-5  # straight lines between points err by (omega dt)² / 8 = 7e-6


@pytest.mark.parametrize("delay", [1e-7, 1e-5, 1e-3, 3e-2])
def test_a_delay_of_any_size(delay):
    (arrived,) = along_of(find("time-delay"))({"delay": delay}, driven(np.sin(OMEGA * T)), DT)
    late = slice(T.size // 4, None)  # what the all-pass makes of the start has passed
    assert np.max(np.abs(arrived - np.sin(OMEGA * (T - delay)))[late]) < 1e-5 + (OMEGA * delay) ** 7 / 100800


def test_what_switches_is_no_filter():
    (arrived,) = along_of(find("actuator-saturation"))({"limit": 0.5}, driven(np.sin(OMEGA * T)), DT)
    assert arrived == pytest.approx(np.clip(np.sin(OMEGA * T), -0.5, 0.5), abs=1e-12)
