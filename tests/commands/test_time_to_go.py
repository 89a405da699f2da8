"""The time to go, from the part that is done."""

from __future__ import annotations

import pytest
from dashpot.commands.time_to_go import Reached, in_words


def test_what_is_left_runs_as_fast_as_what_was_done():
    assert Reached(0.5, 30.0).to_go(30.0) == pytest.approx(30.0)
    assert Reached(0.5, 30.0).to_go(40.0) == pytest.approx(20.0)
    assert Reached(0.8, 40.0).to_go(45.0) == pytest.approx(45.0 / 8)
    assert Reached(1.0, 40.0).to_go(40.0) == 0.0


@pytest.mark.parametrize("pace", [0.6, 1.0, 1.6])
def test_it_is_within_a_factor_of_two_where_the_rest_runs_about_as_fast(pace):
    for now in range(20, 60, 5):
        reached = Reached(now / 100.0, float(now))
        told, true = reached.to_go(now), (100.0 - now) / pace
        assert told is not None
        assert 0.5 < told / true < 2.0


def test_a_step_that_takes_long_leaves_time_to_go():
    reached = Reached(0.9, 90.0)
    assert all((reached.to_go(now) or 0.0) > 4.0 for now in (95.0, 100.0, 200.0))


def test_too_little_says_nothing():
    assert Reached(0.01, 60.0).to_go(60.0) is None
    assert Reached(0.5, 1.0).to_go(1.0) is None
    assert in_words(None) == ""


def test_it_is_said_to_one_digit():
    assert [in_words(s) for s in (0.2, 34.0, 57.0, 61.0, 430.0)] == [
        "about 1 s to go",
        "about 30 s to go",
        "about 60 s to go",
        "about 1 min to go",
        "about 7 min to go",
    ]
