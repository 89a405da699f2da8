"""Turning points of a motion: where it was let go, where it was caught."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decay import Decay
from dashpot.identify.motion.envelope import Envelope
from dashpot.identify.motion.swings import Swings, caught, falls_steadily, release, swell_of, swings_of

EVERY = 50


def turns(size, at=None, noise=1e-6, n=None):
    """Turning points whose swings have given sizes, at given samples or evenly."""
    size = np.asarray(size, float)
    value = np.concatenate([[0.0], np.cumsum(size * (-1.0) ** np.arange(size.size))])
    at = EVERY * np.arange(value.size) if at is None else np.asarray(at)
    return Swings(at, value, noise, int(at[-1]) + EVERY if n is None else n)


def shape(swings):
    """A motion (n,) that runs between its turning points as half a cosine does."""
    x = np.full(swings.n, swings.value[-1])
    x[: swings.at[0]] = swings.value[0]
    for a, b, u, v in zip(swings.at[:-1], swings.at[1:], swings.value[:-1], swings.value[1:], strict=True):
        x[a:b] = u + (v - u) * (1 - np.cos(np.pi * np.arange(b - a) / (b - a))) / 2
    return x


def falling(count, factor=0.95, first=1.0):
    return first * factor ** np.arange(count)


# Which they are ------------------------------------------------------------------------------------------------------


def envelope(size, period, noise=0.0, floor=0.0):
    return Envelope(np.asarray(size, float), period, floor, noise)


@pytest.mark.parametrize("period", [20, 64, 320])
def test_turning_points_of_a_decay_in_closed_form(period):
    """Of exp(-a t) cos(w t) at t_k = (k pi - atan(a / w)) / w."""
    n, rate = 12 * period, 0.02 / period
    t = np.arange(n)
    omega = 2 * np.pi / period
    fall = np.exp(-rate * t)
    made = swings_of(fall * np.cos(omega * t), envelope(fall, period, 1e-6))
    exact = np.concatenate([[0.0], (np.arange(1, 24) * np.pi - np.arctan(rate / omega)) / omega])
    step = max(1, period // 32)
    assert made.at[:24] == pytest.approx(exact, abs=step)
    assert made.value[:24] == pytest.approx(np.exp(-rate * exact) * np.cos(omega * exact), abs=0.02)
    assert made.size[:22] == pytest.approx(np.abs(np.diff(made.value[:23])))
    assert made.noise == pytest.approx(1e-6 / np.sqrt(step))
    assert made.n == n


@pytest.mark.parametrize(("part", "more"), [(0.2, False), (0.3, True)])
def test_a_turn_back_by_less_than_half_an_amplitude_is_another_modes(part, more):
    """A small fast motion upon a slow one turns back by twice its amplitude."""
    t = np.arange(3200)
    slow = np.cos(2 * np.pi * t / 1600)
    made = swings_of(slow + part * np.cos(2 * np.pi * t / 32), envelope(np.ones(t.size), 100))
    assert (made.at.size > 6) is more


@pytest.mark.parametrize(("level", "count"), [(0.9, True), (1.1, False)])
@pytest.mark.parametrize("by", ["noise", "floor"])
def test_noise_turns_no_motion(level, count, by):
    """Where a swing is five deviations of the noise, or half of the level at which a decay ends."""
    t = np.arange(1000)
    limit = {by: level * 2.0 / {"noise": 5.0, "floor": 0.5}[by]}
    made = swings_of(np.cos(2 * np.pi * t / 31), envelope(np.zeros(t.size), 31, **limit))
    assert (made.at.size > 0) is count


def test_what_stands_still_has_none():
    assert swings_of(np.zeros(500), envelope(np.zeros(500), 40, 1e-3)).at.size == 0


def test_a_loud_cycle_near_by_counts():
    """The largest amplitude within a cycle: what remains of a loud motion does not turn by its own rest."""
    t = np.arange(600)
    size = np.where(t < 300, 1.0, 0.1)
    made = swings_of(size * np.cos(2 * np.pi * t / 40), envelope(size, 40))
    gaps = made.at[(made.at > 300) & (made.at < 335)]
    assert gaps.size <= 1
    assert np.sum(made.at > 345) > 10


# Where it was caught -------------------------------------------------------------------------------------------------


def test_a_motion_that_nobody_stops_is_not_caught():
    for factor in (0.95, 0.7):
        assert caught(turns(falling(20, factor)), 0, 1000) is None
    dry = turns(np.linspace(1.0, 0.05, 20))
    assert caught(dry, 0, 1000) is None


@pytest.mark.parametrize(("rest", "found"), [(0.497, 500), (0.503, None)])
def test_a_swing_that_loses_half_was_stopped(rest, found):
    """The tenth: twice what those before it lost, and half of itself."""
    size = falling(20, 0.99)
    size[10:] = rest * size[8] * falling(10, 0.99)
    assert caught(turns(size), 0, 1000) == found


@pytest.mark.parametrize(("factor", "found"), [(0.95, 500), (0.90, None)])
def test_and_twice_what_the_others_lost(factor, found):
    size = falling(14, factor)
    size[10:] = 0.45 * size[8] * falling(4, factor)
    usual = np.max(size[4:8] - size[6:10])
    assert bool(0.55 * size[8] > 2 * usual) is (found is not None)
    assert caught(turns(size), 0, 10_000) == found


def test_only_within_the_stretch_and_after_six_swings():
    size = falling(20, 0.99)
    size[12:] = 0.2
    assert caught(turns(size), 0, 1000) == 600
    assert caught(turns(size), 0, 601) == 600
    assert caught(turns(size), 0, 600) is None
    assert caught(turns(size), 301, 1000) is None
    assert caught(turns(size), 300, 1000) == 600
    assert caught(turns(size[:5]), 0, 1000) is None


def test_the_last_swing_may_be_cut_off_by_the_record():
    size = np.append(falling(12, 0.99), 0.2)
    assert caught(turns(size, n=12 * EVERY + 2 * EVERY + EVERY), 0, 10_000) == 600
    assert caught(turns(size, n=13 * EVERY + EVERY - 1), 0, 10_000) is None


@pytest.mark.parametrize(("lasts", "found"), [(90, None), (110, 500)])
def test_what_stands_still_far_out_is_held(lasts, found):
    """Its last swing lasts twice as long as those before; dry friction cannot hold it there."""
    at = EVERY * np.arange(13)
    at[11:] += lasts - EVERY
    assert caught(turns(falling(12, 0.98), at, n=2000), 0, 10_000) == found


@pytest.mark.parametrize(("loss", "found"), [(0.35, None), (0.25, 500)])
def test_dry_friction_holds_what_swings_no_further_than_two_losses(loss, found):
    at = EVERY * np.arange(13)
    at[11:] += 100
    size = 0.6 + loss / 2 * (9 - np.arange(12.0))
    assert bool(size[9] > 2 * loss) is (found is not None)
    assert caught(turns(size, at, n=2000), 0, 10_000) == found


# How far it falls ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("last", "steady"), [(0.91, False), (0.88, True)])
def test_a_steady_fall_is_by_a_tenth(last, steady):
    assert falls_steadily(turns(np.linspace(1.0, last, 20)), 0, 10_000) is steady


def test_a_steady_fall_is_far_beyond_what_scatters_it():
    """A push in its middle is no scatter; a frame that is off is, and so are noise and a ripple of another mode."""
    size = np.linspace(1.0, 0.5, 20)
    assert falls_steadily(turns(size), 0, 10_000)
    pushed = size.copy()
    pushed[9:] += 0.2
    assert not falls_steadily(turns(pushed), 0, 10_000)
    off = size.copy()
    off[9] += 0.1
    assert falls_steadily(turns(off), 0, 10_000)
    assert falls_steadily(turns(size, noise=0.035), 0, 10_000)
    assert not falls_steadily(turns(size, noise=0.045), 0, 10_000)  # a twelfth of the fall


@pytest.mark.parametrize(("ripple", "steady"), [(0.03, True), (0.12, False)])
def test_a_ripple_scatters_the_swings(ripple, steady):
    size = np.linspace(1.0, 0.6, 40) + ripple * np.sin(0.9 * np.arange(40))
    assert falls_steadily(turns(size), 0, 10_000) is steady


def test_where_the_record_begins_and_ends_is_no_turning_point():
    """Half a swing each, as a record has that begins and ends anywhere."""
    size = np.linspace(1.0, 0.8, 20)
    assert falls_steadily(turns(np.concatenate([[0.3], size, [0.4]])), 0, 10_000)


@pytest.mark.parametrize(("first", "steady"), [(0.08, False), (0.14, True)])
def test_what_is_driven_at_first_loses_nothing(first, steady):
    """The first half of the swings loses half of what the second does, or more."""
    size = np.concatenate([np.linspace(1.0, 1.0 - first, 11), np.linspace(1.0 - first, 0.75 - first, 11)[1:]])
    assert falls_steadily(turns(size), 0, 10_000) is steady


def test_three_swings_in_either_direction_at_least():
    size = np.linspace(1.0, 0.5, 20)
    assert falls_steadily(turns(size), 0, 7 * EVERY + 1)
    assert not falls_steadily(turns(size), 0, 7 * EVERY)  # the first of eight is the record's beginning
    assert falls_steadily(turns(size), 1, 7 * EVERY + 1)


# Where it was let go -------------------------------------------------------------------------------------------------


def let_go(hold, sizes, noise=1e-6):
    swings = turns(sizes, hold + EVERY * np.arange(len(sizes) + 1), noise)
    return shape(swings), swings


def test_a_hold_ends_with_the_first_turning_point_after_it():
    x, swings = let_go(300, falling(16))
    for start in (300 + 6 * EVERY, 300 + 2 * EVERY):
        assert release(x, swings, start) == 300 + EVERY
    assert release(x, swings, 300) == 300 + EVERY
    assert release(x, swings, 300 + 16 * EVERY) is None  # too late to be seen


@pytest.mark.parametrize(("stands", "found"), [(44, None), (47, 100 + EVERY)])
def test_a_hold_lasts_longer_than_a_turning_point(stands, found):
    """Half a swing on either side; within a fiftieth of it half a cosine itself dwells for 0.09 of its length."""
    x, swings = let_go(100, falling(16))
    x[: 100 - stands] += 1.0
    assert release(x, swings, 100 + 6 * EVERY) == found


@pytest.mark.parametrize(("stands", "found"), [(24, None), (27, 1 + EVERY)])
def test_a_record_that_begins_with_a_turning_point_shows_one_side_of_it(stands, found):
    x, swings = let_go(1, falling(16))
    x[:stands] = swings.value[0]
    assert release(x, swings, 1 + 6 * EVERY) == found


@pytest.mark.parametrize(("part", "found"), [(0.015, 300 + EVERY), (0.025, None)])
def test_a_still_hand_keeps_within_a_fiftieth_of_the_swing(part, found):
    x, swings = let_go(300, falling(16))
    x[:290] += part * np.cos(0.5 * np.pi * np.arange(290))
    x[:290:2] += part * np.sign(x[:290:2])
    moved = np.max(np.abs(x[:290]))
    x[:290] *= part / moved
    assert release(x, swings, 300 + 6 * EVERY) == found


@pytest.mark.parametrize(
    ("lasts", "stands", "found"),
    [((30, 50), 29, True), ((30, 50), 25, False), ((100, 50), 44, True), ((100, 50), 38, False)],
)
def test_a_hold_is_measured_by_the_shorter_of_the_swings_after_it(lasts, stands, found):
    """More than half of it on both sides, of which half a cosine dwells for 0.09 of the first swing."""
    at = 200 + np.concatenate([[0, lasts[0]], lasts[0] + lasts[1] * np.arange(1, 16)])
    swings = turns(falling(16), at)
    x = shape(swings)
    x[: 200 - stands] += 1.0
    assert bool(stands + 0.09 * lasts[0] > min(lasts)) is found
    assert release(x, swings, int(at[6])) == (at[1] if found else None)


def test_a_push_is_told_by_the_swing_before_it():
    """A swing smaller than four fifths of the next in its direction was pushed; a larger one may have been driven."""
    for part, found in ((0.7, 2 * EVERY), (0.9, None)):
        sizes = np.concatenate([[part * 0.9, part * 0.95], falling(14)])
        swings = turns(sizes)
        assert release(shape(swings), swings, 8 * EVERY) == found


def test_what_rings_from_the_record_s_beginning_was_not_released_in_it():
    swings = turns(falling(16))
    assert release(shape(swings), swings, 6 * EVERY) is None


def test_a_swing_that_lasts_long_before_the_others_was_held():
    sizes = np.concatenate([[0.9, 0.97], falling(14)])
    at = EVERY * np.arange(17)
    at[2:] += 80
    swings = turns(sizes, at)
    assert release(shape(swings), swings, int(at[8])) == at[2]
    at[2:] -= 50
    swings = turns(sizes, at)
    assert release(shape(swings), swings, int(at[8])) is None


# What swells ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("count", "swells"), [(4, False), (5, True), (20, True)])
def test_what_grows_more_often_than_a_hand_turns_back_swells(count, swells):
    """A hand's way of six parameters has four turning points, each of which may end a larger swing."""
    size = np.concatenate([falling(10), 1.1 ** np.arange(count), falling(10, first=0.9)])
    swings = turns(size)
    expected = (EVERY * 8, EVERY * (10 + count)) if swells else None
    assert swell_of(swings, ()) == expected


def test_what_grows_by_no_more_than_the_noise_does_not_swell():
    assert swell_of(turns(1.0 + 1e-7 * np.arange(40)), ()) is None


def test_what_grows_within_a_decay_is_its_beat():
    swings = turns(np.concatenate([falling(10), 1.1 ** np.arange(20), falling(10)]))
    assert swell_of(swings, (Decay(0, 60 * EVERY),)) is None
    assert swell_of(swings, (Decay(0, 8 * EVERY),)) is not None


@pytest.mark.parametrize(("share", "swells"), [(0.3, False), (0.7, True)])
def test_what_grows_to_less_than_a_third_of_what_falls_has_driven_none_of_it(share, swells):
    grown = share * np.linspace(0.05, 1.0, 12)
    swings = turns(np.concatenate([grown, falling(10)]))
    found = swell_of(swings, (Decay(12 * EVERY, 22 * EVERY),))
    assert (found is not None) is swells


def test_releases_ever_larger_do_not_swell():
    """Each release is a piece of its own: what lies between two of them is too short to have been driven."""
    swings = turns(np.exp(0.05 * np.arange(40)))
    pieces = tuple(Decay(k * EVERY + 5, (k + 1) * EVERY + 5) for k in range(2, 38, 5))
    assert swell_of(swings, ()) is not None
    assert swell_of(swings, pieces) is None
    assert swell_of(swings, pieces[:4]) == (19 * EVERY, 40 * EVERY)
