"""A sensor's walk and a swing that is cut off are told from noise, from lines and from what a rounding makes."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.part_kinds import cut_off, walk
from dashpot.identify.segments import Segment

N = 2000


def noise(size: float = 1.0, seed: int = 0) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(N)


@pytest.mark.parametrize("step", [0.3, 3.0])
def test_a_walk_is_known_by_its_differences(step):
    assert walk(np.cumsum(noise(step)) + noise(1.0, 1)) == pytest.approx(step, rel=0.15)


LINE = np.sin(0.3 * np.arange(N)) + noise(0.1)
RINGING = np.exp(-np.arange(50) / 9.0) * np.sin(np.arange(50))


@pytest.mark.parametrize("left", [LINE, np.convolve(noise(), RINGING)[:N]], ids=["line", "resonance"])
def test_what_rings_walks_not(left):
    assert walk(left) is None


def test_white_noise_has_all_but_no_steps():
    step = walk(noise())
    assert step is None or step < 0.05


@pytest.mark.parametrize(("top", "cut"), [(0.95, True), (1.5, False)])
def test_the_top_of_a_swing_that_is_cut_off_is_seen_where_the_motion_goes_on(top, cut):
    dt, size = 1e-3, 1e-4
    motion = np.sin(2 * np.pi * 5.0 * dt * np.arange(N))
    shown = np.minimum(motion + noise(size), top)
    segment = Segment(0, 0, N, shown, None, dt, 2.0, 2 * np.pi * 5.0)
    inside = np.arange(N) < 200
    found = cut_off(segment, shown - motion, inside, size)
    assert (found is not None) == cut
    if cut:
        assert found == pytest.approx((top, 2.05), abs=0.01)


def test_equal_samples_at_which_the_motion_does_not_go_on_are_rounding():
    dt, step = 1e-3, 1e-2
    motion = np.sin(2 * np.pi * 5.0 * dt * np.arange(N))
    shown = step * np.round(motion / step)
    segment = Segment(0, 0, N, shown, None, dt, 0.0, 2 * np.pi * 5.0)
    assert cut_off(segment, shown - motion, np.ones(N, bool), step) is None
