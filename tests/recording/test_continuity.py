"""Samples that no sensor saw are found where they are; motion with impacts, noise and rest has none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, told
from dashpot.recording import check
from dashpot.recording.continuity import folded, is_switched, leaps, repeated, without_noise, wrapped
from scipy.interpolate import CubicSpline

N, CYCLE = 4000, 80
PHASE = 2 * np.pi * np.arange(N) / CYCLE
NOISE = 1e-6 * np.random.default_rng(1).standard_normal(N)
MOTION = 1e-3 * np.sin(PHASE) + NOISE
#: Where the sine is fastest and slowest.
FAST, SLOW = 2000, 2020


def places(signal: np.ndarray) -> list[tuple[int, bool]]:
    return [(leap.first, leap.back) for leap in leaps(signal, CYCLE)]


def slipped(times: float, at: int = FAST) -> np.ndarray:
    """The motion with a sensor that slips by so many times the largest step of a sine."""
    return MOTION + np.where(np.arange(N) > at, (times - (at == FAST)) * 1e-3 * 2 * np.pi / CYCLE, 0.0)


@pytest.mark.parametrize(("times", "found"), [(2.8, []), (3.3, [(FAST, False)])])
def test_a_step_three_times_as_far_as_any_other_of_its_cycle_is_none_of_a_mass(times, found):
    assert places(slipped(times)) == found


def test_a_leap_bears_its_size_and_how_far_that_is():
    (leap,) = leaps(slipped(11.0), CYCLE)
    assert leap.size == pytest.approx(11.0 * 1e-3 * 2 * np.pi / CYCLE, rel=0.02)
    assert leap.times == pytest.approx(11.0, rel=0.1)


@pytest.mark.parametrize("lost", [5, 20])
def test_samples_that_are_lost_or_held_show_where_it_is_fast(lost):
    assert places(np.delete(MOTION, range(FAST, FAST + lost))) == [(FAST - 1, False)]
    held = MOTION.copy()
    held[FAST : FAST + lost] = held[FAST]
    assert places(held) == [(FAST + lost - 1, False)]


def test_a_sample_that_is_wrong_leads_back_at_once():
    spike = MOTION.copy()
    spike[FAST] += 2e-3
    spike[SLOW + 10 * CYCLE] -= 2e-3
    assert places(spike) == [(FAST - 1, True), (SLOW + 10 * CYCLE - 1, True)]


@pytest.mark.parametrize(("rest", "at"), [(0, -1), (400, -1), (0, 0)], ids=["last", "after a rest", "first"])
def test_a_sample_at_an_end_leads_nowhere(rest, at):
    ended = np.concatenate([MOTION, NOISE[:rest]])
    assert places(ended) == []
    ended[at] = 4.27  # m, of 4.27e-04 in a file that was cut short
    assert places(ended) == [(0 if at == 0 else N + rest - 2, True)]


def test_of_many_leaps_none_is_told():
    """A sensor that works so, or a thing that does."""
    spikes = MOTION.copy()
    spikes[100::700] += 2e-3
    assert len(places(spikes)) == 0
    spikes = MOTION.copy()
    spikes[100::800] += 2e-3
    assert len(places(spikes)) == 5


def test_impacts_rest_and_noise_are_no_leaps():
    bouncing = 1e-3 * np.abs(np.sin(PHASE / 2)) + NOISE
    released = np.where(np.arange(N) < FAST, 0.0, 1e-3 * (1 - np.cos(PHASE))) + NOISE
    struck = np.where(np.arange(N) < FAST, 0.0, 1e-3 * np.sin(PHASE)) + NOISE
    coarse = np.round(np.where(np.arange(N) < FAST, 0.0, 1e-4 * np.sin(PHASE)) + NOISE, 5)
    padded = np.where(np.arange(N) < FAST, 5e-3 + NOISE, MOTION)  # before it a rest that is cut from elsewhere
    for sound in (MOTION, bouncing, released, struck, coarse, padded, NOISE, NOISE[:100]):
        assert places(sound) == []


@pytest.mark.parametrize(("length", "found"), [(15, None), (16, (FAST, FAST - 16, 16)), (70, (FAST, FAST - 70, 70))])
def test_a_block_that_is_written_twice_is_found_with_its_length(length, found):
    doubled = np.concatenate([MOTION[:FAST], MOTION[FAST - length :]])
    assert repeated(doubled[None]) == found


def test_both_channels_must_repeat():
    doubled = np.concatenate([MOTION[:FAST], MOTION[FAST - 40 :]])
    force = np.random.default_rng(2).standard_normal(doubled.size)
    assert repeated(np.vstack([doubled, force])) is None
    assert repeated(np.vstack([doubled, np.concatenate([force[:FAST], force[FAST - 40 : -40]])])) is not None


def test_rest_and_few_levels_are_no_block():
    assert repeated(np.zeros((1, N))) is None
    assert repeated(np.round(MOTION / 5, 4)[None]) is None
    assert repeated(MOTION[None]) is None
    assert repeated(MOTION[None, :20]) is None


def pendulum(height: float) -> np.ndarray:
    """An angle that swings about pi, where many encoders wrap, and falls."""
    t = np.arange(2000) / 100.0
    return np.pi + height * np.exp(-0.1 * t) * np.cos(2 * np.pi * t)


def wrap(angle: np.ndarray) -> np.ndarray:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def test_a_wrapped_angle_is_found_wherever_it_was_wrapped():
    angle = pendulum(1.0)
    places = wrapped(wrap(angle))
    np.testing.assert_array_equal(places, np.flatnonzero(np.diff(np.floor((angle + np.pi) / (2 * np.pi)))) + 1)
    assert places.size > 30


def test_an_angle_that_runs_on_was_not_wrapped():
    assert wrapped(pendulum(1.0)).size == 0
    assert wrapped(np.linspace(0.0, 40.0, 500)).size == 0


@pytest.mark.parametrize(("short", "found"), [(0.0, True), (0.03, True), (0.2, False)])
def test_only_a_whole_turn_is_a_wrapped_one(short, found):
    # a step that is off a turn by more than the motion makes in a sample is a slip of the sensor
    angle = wrap(pendulum(1.0))
    angle = np.where(angle > 0, angle - short, angle)
    assert (wrapped(angle).size > 0) == found


def test_half_a_turn_in_a_sample_tells_no_direction():
    assert wrapped(np.array([0.0, np.pi - 0.01, 0.0, np.pi - 0.01])).size == 0
    assert wrapped(np.tile([0.0, 4.0], 20)).size == 0


def _wrap(signal, limit):
    return (signal + limit) % (2 * limit) - limit


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_signal_that_wraps_at_its_range_is_told_from_what_leaps_by_itself(noise):
    random = np.random.default_rng(3)
    t = np.arange(6000) / 500.0
    sweep = np.sin(2 * np.pi * (6 + 0.5 * t) * t)
    made = _wrap(sweep + noise * random.standard_normal(t.size), 0.7)
    places = folded(made)
    assert places.size > 100
    over = np.cumsum(np.isin(np.arange(t.size), places) * -np.sign(np.diff(made, prepend=made[0]))) * 1.4
    assert np.max(np.abs(made + over - sweep)) < 10 * noise + 1e-9
    late = t + 1e-4 * np.clip(random.standard_normal(t.size), -3, 3)
    switched = random.choice([-1.0, 1.0], 600)[np.arange(t.size) // 10]
    bounce = 1.0 - (6 * t) % 2.0  # a velocity turned round at two walls, and a sawtooth
    others = {
        "square": np.sign(sweep),
        "resampled command": CubicSpline(late, switched)(t),
        "bursts": np.sign(sweep) * (t % 2 < 0.4),
        "random": np.sign(random.standard_normal(t.size)),
        "noise": random.standard_normal(t.size),
        "sawtooth": bounce,
        "between walls": np.where((3 * t) % 2 < 1, 1.0, -1.0) * (1.0 - 0.2 * ((3 * t) % 1.0)),
        "sweep": sweep,
        "one": np.where(t < 3, 0.0, 1.0),
    }
    for kind, signal in others.items():
        assert folded(signal + noise * random.standard_normal(t.size)).size == 0, kind


def test_a_force_that_wraps_is_refused_for_that_alone():
    (record,) = [r for r in told(STANDS["built-in"], None) if r.name == "strong.csv"]
    problems = check(replace(record, force=_wrap(record.force, 0.7 * np.max(record.force))))
    assert [problem.severity for problem in problems] == ["error"]
    assert "the force wraps" in problems[0].sentence
    response = replace(record, response=_wrap(record.response, 0.8 * np.max(record.response)))
    assert "the response wraps" in check(response)[0].sentence


@pytest.mark.parametrize("dwell", [2, 7, 90])
def test_a_command_in_steps_is_switched_and_smooth_motion_is_not(dwell):
    random = np.random.default_rng(dwell)
    levels = np.repeat(random.uniform(-1, 1, 2 + 900 // dwell), dwell)[:900]
    assert is_switched(levels + 1e-3 * random.standard_normal(900))
    place = np.arange(900)
    tone = np.where(place < 501, np.cos(2 * np.pi * place / (20 + dwell)), 0.0)  # switched off amid a swing
    blow = np.exp(-0.5 * ((place - 300) / 1.2) ** 2)
    for smooth in (tone, blow, random.standard_normal(900), np.zeros(900)):
        assert not is_switched(smooth)


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_noise_of_a_sensor_is_taken_off_a_command_in_steps(noise):
    random = np.random.default_rng(3)
    levels = np.repeat(random.choice([-1.0, -0.3, 0.4, 1.0], 40), random.integers(20, 80, 40))
    shown = levels + noise * random.standard_normal(levels.size)
    assert np.std(without_noise(shown) - levels) < 0.5 * noise
    # what goes on between the edges, or carries no noise, stays as it is
    for kept in (shown + 0.02 * np.sin(np.arange(levels.size) / 7), levels, np.cos(np.arange(900) / 5)):
        np.testing.assert_array_equal(without_noise(kept), kept)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_three_levels_fold_nowhere(noise):
    """From none to the highest, a fifth down, and below none: what lies between the outer edges moves on by an edge."""
    levels = np.repeat([0.0, 129.8, 102.3, -14.8], [1582, 2186, 1390, 839])
    levels += noise * 129.8 * np.random.default_rng(4).standard_normal(levels.size)
    assert folded(levels).size == 0


def test_levels_with_noise_fold_nowhere():
    """Four dwells, the lowest and the highest twice: every leap goes over all of the range, and no dwell moves on."""
    random = np.random.default_rng(0)
    for _ in range(20):
        levels = np.repeat([0.0, 1.0, 0.0, 1.0], 300)
        assert folded(levels + 1e-3 * random.standard_normal(levels.size)).size == 0
