"""Waves of a recorder's speed are found by what they leave of a motion that is large for a while only."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.faults.wavering import waves_of_time
from dashpot.identify.problem.segments import Segment

N, DT, HERTZ = 4000, 0.0025, 6.0
TIME = np.arange(N) * DT


def passing(t: np.ndarray) -> np.ndarray:
    """A motion as of a sweep through a resonance: a second long, of ten."""
    return np.exp(-(((t - 4.0) / 1.5) ** 2)) * np.sin(2 * np.pi * HERTZ * t)


def found(response: np.ndarray, made: np.ndarray) -> list[float]:
    segment = Segment(0, 0, N, response, None, DT, 0.0, 2 * np.pi * HERTZ)
    return waves_of_time(response - made, segment)


@pytest.mark.parametrize("wave", [0.45, 1.3, 2.7])
def test_a_wave_is_found_to_a_part_of_its_width(wave):
    late = 1e-3 * np.sin(2 * np.pi * wave * TIME + 0.4)
    assert found(passing(TIME + late), passing(TIME))[0] == pytest.approx(wave, abs=0.05)


def test_a_delay_and_another_rate_are_no_wave():
    wave = 1e-5 * np.sin(2 * np.pi * 2.0 * TIME)  # a hundred times less than the delay
    assert found(passing(TIME + 1e-3 + 1e-4 * TIME + wave), passing(TIME))[0] == pytest.approx(2.0, abs=0.1)


def test_a_few_cycles_have_no_waves():
    segment = Segment(0, 0, 200, passing(TIME)[:200], None, DT, 0.0, 2 * np.pi * HERTZ)
    assert waves_of_time(np.zeros(200), segment) == []
