"""The two figures of what is left, against what can be computed by hand."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.model.fit_state import Left
from dashpot.model.left import over, rms, share_of_motion, times_the_noise

MOTION = np.sin(2 * np.pi * np.arange(1000) / 50)


def test_the_rms_is_of_all_samples_together():
    assert rms([np.full(3, 2.0), np.full(1, 4.0)]) == pytest.approx(np.sqrt(7.0))
    assert rms([]) == 0.0
    assert rms([np.array([1.0, np.nan])]) == np.inf


def test_the_share_of_a_motion_is_of_that_about_its_mean():
    assert share_of_motion([np.full(1000, 0.3)], [2.0 * MOTION + 7.0]) == pytest.approx(0.3 / np.sqrt(2.0))
    assert share_of_motion([MOTION], [MOTION]) == pytest.approx(1.0)
    assert share_of_motion([np.zeros(1000)], [MOTION]) == 0.0


def test_what_does_not_move_or_runs_away_has_no_share():
    assert share_of_motion([MOTION], [np.ones(1000)]) == np.inf
    assert share_of_motion([np.full(1000, np.nan)], [MOTION]) == np.inf
    assert share_of_motion([np.full(1000, np.inf)], [MOTION]) == np.inf


def test_stretches_count_by_their_samples():
    """A second one of half the length, twice as far off and three times as loud."""
    left, motion = [np.full(1000, 0.3), np.full(500, 0.6)], [MOTION, 3.0 * MOTION[:500]]
    assert share_of_motion(left, motion) == pytest.approx(np.sqrt((0.09 + 0.5 * 0.36) / (0.5 + 0.5 * 4.5)))
    assert times_the_noise(left, [0.1, 0.4]) == pytest.approx(np.sqrt((0.09 + 0.18) / (0.01 + 0.08)))


def test_any_two_of_the_three_figures_give_the_third():
    left, noise = [0.3 * MOTION, MOTION], [0.01, 0.02]
    levels = [np.full(1000, level) for level in noise]
    share, times = share_of_motion(left, [MOTION, MOTION]), times_the_noise(left, noise)
    assert share / times == pytest.approx(share_of_motion(levels, [MOTION, MOTION]))
    assert Left("run", share, times).noise == pytest.approx(share / times)


def test_without_a_noise_nothing_is_so_many_times_it():
    assert over(0.1, 0.0) == over(np.inf, 1.0) == over(np.nan, 1.0) == np.inf
    assert times_the_noise([MOTION], [0.0]) == np.inf
