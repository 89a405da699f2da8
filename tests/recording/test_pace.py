"""The cycle of a motion, where it is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.recording import Recording
from dashpot.recording.pace import cycle_of

FS = 500.0
T = np.arange(4000) / FS


def of(signal, noise=1e-4, **how):
    return Recording("run", FS, signal + noise * np.random.default_rng(5).standard_normal(signal.size), **how)


def released(frequency, damping, held, times):
    """What is pulled aside within half a second, held, and let go, again and again."""
    pulled = 0.5 * (1 - np.cos(np.pi * np.arange(250) / 250))
    freed = np.exp(-2 * np.pi * frequency * damping * T) * np.cos(2 * np.pi * frequency * T)
    return np.tile(np.concatenate([pulled, np.ones(round(held * FS)), freed]), times)


@pytest.mark.parametrize("held", [0.2, 3.0, 12.0])
@pytest.mark.parametrize("damping", [0.01, 0.1, 0.2])
def test_releases_by_hand_have_the_cycle_of_the_motion(held, damping):
    assert cycle_of(of(released(3.0, damping, held, 6))) == pytest.approx(1 / 3.0, rel=0.1)


def test_the_larger_of_two_modes_gives_the_cycle():
    """By 3 to 1, though the smaller one has twice the velocity."""
    slow, fast = (np.exp(-0.2 * T) * np.sin(2 * np.pi * f * T) for f in (4.0, 24.0))
    assert cycle_of(of(3.0 * slow + fast)) == pytest.approx(1 / 4.0, rel=0.25)
    assert cycle_of(of(slow + 3.0 * fast)) == pytest.approx(1 / 24.0, rel=0.25)


def test_an_acceleration_has_that_of_its_strongest_line_whatever_its_blows():
    ringing = np.exp(-1.0 * T) * np.sin(2 * np.pi * 10.0 * T)
    ringing[:3] += [30.0, 90.0, 30.0]
    assert cycle_of(of(ringing, quantity="acceleration", unit="m/s2")) == pytest.approx(0.1, rel=0.05)


def test_a_few_samples_a_cycle_are_enough():
    steady = np.sin(2 * np.pi * 61.7 * T + 0.3)  # 8.1 samples
    assert cycle_of(of(steady)) == pytest.approx(1 / 61.7, rel=0.05)


@pytest.mark.parametrize("still", [np.zeros(100), np.linspace(0.0, 1.0, 100), np.ones(100)])
def test_what_does_not_swing_has_some_cycle(still):
    assert cycle_of(of(still, noise=0.0)) > 0
    assert cycle_of(of(still)) > 0
