"""A sensor's walk and a swing that is cut off are told from noise, from lines and from what a rounding makes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.identify.faults.part_kinds import cut_off, kind_of_part, lone, stands_still, walk
from dashpot.identify.problem.segments import Segment
from dashpot.recording import Recording
from scipy.signal import lfilter

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


@pytest.mark.parametrize(("memory", "walks"), [(8, False), (3000, True)])
def test_what_forgets_where_it_was_walks_not(memory, walks):
    """A tracker's jitter that lasts some frames has a walk's differences; only a walk's slowest lines are as large."""
    slow = lfilter([1.0], [1.0, -np.exp(-1.0 / memory)], noise(1.0)[:1700])
    assert (walk(slow + noise(1.0, 1)[:1700]) is not None) is walks


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


@pytest.mark.parametrize(("level", "cut"), [(0.52, True), (0.48, False)])
def test_what_has_shown_twice_as_much_elsewhere_is_at_no_limit(level, cut):
    """A cart that comes to rest on the step of a coarse ranger, where the model swings on."""
    dt, size = 1e-3, 1e-4
    motion = np.sin(2 * np.pi * 5.0 * dt * np.arange(N))
    shown = motion + noise(size)
    shown /= np.max(shown)
    shown[230:270] = level  # around the top of the second swing
    segment = Segment(0, 0, N, shown, None, dt, 0.0, 2 * np.pi * 5.0)
    assert (cut_off(segment, shown - motion, np.ones(N, bool), size) is not None) is cut


def test_equal_samples_at_which_the_motion_does_not_go_on_are_rounding():
    dt, step = 1e-3, 1e-2
    motion = np.sin(2 * np.pi * 5.0 * dt * np.arange(N))
    shown = step * np.round(motion / step)
    segment = Segment(0, 0, N, shown, None, dt, 0.0, 2 * np.pi * 5.0)
    assert cut_off(segment, shown - motion, np.ones(N, bool), step) is None


@pytest.mark.parametrize(("value", "stood"), [(0.0, True), (0.5, True), (None, False)])
def test_what_stands_still_while_the_motion_passes_is_told_from_a_swing_that_is_cut_off(value, stood):
    dt, size = 1e-3, 1e-4
    motion = np.sin(2 * np.pi * 5.0 * dt * np.arange(N))
    shown = motion + noise(size)
    if value is None:
        shown = np.minimum(shown, 0.95)
    else:
        shown[300:400] = value
    segment = Segment(0, 0, N, shown, None, dt, 2.0, 2 * np.pi * 5.0)
    found = stands_still(segment, shown - motion, np.abs(np.arange(N) - 350) < 100, size)
    assert (found is not None) == stood
    if stood:
        assert found == pytest.approx((value, 2.3, 2.399), abs=1e-6)
        at_rest = Segment(0, 0, 400, shown[:400], None, dt, 2.0, 2 * np.pi * 5.0)  # and does not move again
        assert stands_still(at_rest, (shown - motion)[:400], np.arange(400) > 250, size) is None


@pytest.mark.parametrize(("samples", "told"), [(1, True), (2, True), (5, False), (0, False)])
def test_a_sample_or_two_that_are_off_are_a_spike(samples, told):
    left = noise(1e-4)
    left[700 : 700 + samples] += 0.02
    segment = Segment(0, 0, N, left, None, 1e-3, 0.0, 30.0)
    found = lone(segment, left, np.abs(np.arange(N) - 700) < 100, 1e-4)
    assert (found is not None) == told
    if told:
        assert found == pytest.approx((0.02, 0.7), abs=2e-3)


def test_where_the_model_runs_away_nothing_is_said_of_the_part():
    left = noise()
    left[N // 2 :] = np.nan  # a softening spring that gave way
    segment = Segment(0, 0, N, noise(seed=1), None, 1e-3, 0.0, 2 * np.pi * 5.0)
    part = SimpleNamespace(recording=0, holds=lambda segment: np.arange(segment.n) >= N // 4)
    found = SimpleNamespace(other=None, part=part, left=(left,))
    recordings = [Recording(name="a", fs=1e3, response=segment.response)]
    assert kind_of_part(found, SimpleNamespace(segments=[SimpleNamespace(segment=segment)]), recordings) is None
