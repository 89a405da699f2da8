"""The noise of a struck rig where it rests."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decay import Blow
from dashpot.identify.motion.first_motion import first_motion
from dashpot.identify.motion.quiet import quiet_noise
from scipy.signal import lfilter

FS, CYCLE = 500.0, 100
PACE = 2 * np.pi * FS / CYCLE
N = 6000
BLOWS = (Blow(1000, 1005), Blow(3500, 3505))


def noise(memory: float) -> np.ndarray:
    """(n,) of the first order, of standard deviation one."""
    white = np.random.default_rng(4).standard_normal(N)
    return np.sqrt(1 - memory**2) * lfilter([1.0], [1.0, -memory], white)


def ringing(decay: float, size: float = 50.0, pace: float = PACE) -> np.ndarray:
    """(n,) what two blows set going."""
    t = np.arange(N) / FS
    swings = [np.where(t > b.stop / FS, np.exp(-decay * (t - b.stop / FS)), 0.0) for b in BLOWS]
    return size * sum(swings) * np.sin(pace * t)


@pytest.mark.parametrize("memory", [0.0, 0.6, 0.9])
def test_noise_of_any_colour_is_measured_where_the_rig_rests(memory):
    size, slow = quiet_noise(3.0 + ringing(4.0) + noise(memory), BLOWS, 1 / FS, PACE)
    assert size == pytest.approx(1.0, rel=0.2)
    # what does not average out over the first part of a cycle counts for more
    motion = np.array([np.divide(*first_motion(noise(memory)[k:], 1 / FS, PACE)) for k in range(0, N - 20, 15)])
    assert slow == pytest.approx(np.sqrt(np.mean(motion**2)), rel=0.35)


@pytest.mark.parametrize("pace", [0.7 * PACE, PACE, 6.0 * PACE])
def test_what_still_swings_is_no_rest(pace):
    """Whatever its frequency: a preload makes small swings fast."""
    shown = ringing(0.2, pace=pace) + 0.1 * noise(0.0)
    shown[: BLOWS[0].start] += 20.0 * np.sin(pace * np.arange(BLOWS[0].start) / FS)
    assert quiet_noise(shown, BLOWS, 1 / FS, PACE) == (0.0, 0.0)


@pytest.mark.parametrize(("swing", "rests"), [(1.2, True), (1.6, False)])
def test_a_swing_is_one_where_most_of_it_lies_about_one_frequency(swing, rests):
    """A sine of amplitude a beside noise of one makes a² / (a² + 2) of it."""
    shown = noise(0.0) + swing * np.sin(PACE * np.arange(N) / FS)
    assert (quiet_noise(shown, BLOWS, 1 / FS, PACE)[0] > 0) is rests


def test_rest_that_shows_a_constant_has_the_noise_of_rounding():
    rounded = 8.0 * np.round(ringing(4.0) / 8.0)
    assert quiet_noise(rounded, BLOWS, 1 / FS, PACE) == (0.0, 0.0)


def test_blows_that_follow_each_other_at_once_leave_no_rest():
    dense = tuple(Blow(k, k + 5) for k in range(100, N, 250))
    assert quiet_noise(noise(0.0), dense, 1 / FS, PACE) == (0.0, 0.0)


def test_what_nobody_struck_is_not_asked():
    """Something else may drive it there."""
    assert quiet_noise(noise(0.0), (), 1 / FS, PACE) == (0.0, 0.0)


@pytest.mark.parametrize(("samples", "asked"), [(1e-6, False), (4, False), (5, True)])
def test_a_pace_that_the_samples_do_not_follow_has_no_rest(samples, asked):
    """As a model without use may have it."""
    shown = noise(0.0)
    assert (quiet_noise(shown, BLOWS, 1 / FS, 2 * np.pi * FS / samples)[0] > 0) is asked


@pytest.mark.parametrize("swing", [0.0, 0.05])
def test_several_modes_that_ring_are_no_rest(swing):
    """Behind a blow no one frequency holds half of it; a swing that is left is no quieter than the noise."""
    times = np.arange(4000) / FS
    ring = sum(np.sin(2 * np.pi * f * times) for f in (31.0, 45.0, 67.0, 83.0)) * np.exp(-20.0 * times)
    shown = ring + swing * np.sin(PACE * times) + 1e-3 * np.random.default_rng(5).standard_normal(times.size)
    assert quiet_noise(shown, (Blow(0, 3, clipped=False),), 1 / FS, PACE)[0] < max(2 * swing, 2e-3)
