"""Time stamps: order, gaps, rounding, jitter, and agreement with --fs."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording.sampling import uniform_sampling

N = 2000
GRID = 3.0 + np.arange(N) / 250


def signal(time: np.ndarray, frequency: float = 7) -> np.ndarray:
    return np.sin(2 * np.pi * frequency * time)[:, None]


def sample(time, fs=None, frequency: float = 7):
    return uniform_sampling("rig.csv", time, fs, signal(GRID if time is None else time, frequency))


def test_uniform_time():
    sampling = sample(GRID)
    assert (sampling.fs, sampling.start, sampling.notes) == (pytest.approx(250, rel=1e-12), 3.0, ())
    assert sample(GRID, fs=250.0).fs == pytest.approx(250)
    assert sample(None, fs=250.0).start == 0.0


def test_small_jitter_of_a_logger_is_accepted_as_it_is():
    time = GRID + np.random.default_rng(0).uniform(-1e-3, 1e-3, N) / 250
    sampling = sample(time)
    assert sampling.notes == ()
    np.testing.assert_array_equal(sampling.columns, signal(time))


def test_rate_is_freed_from_rounded_end_stamps():
    time = np.round(np.arange(N) / 600, 6)
    assert (N - 1) / time[-1] != 600
    assert sample(time).fs == 600


@pytest.mark.parametrize("rate", [600, 800, 1700])
def test_stamps_rounded_to_a_millisecond_are_no_gaps_and_no_jitter(rate):
    sampling = sample(np.round(np.arange(N) / rate, 3))
    assert sampling.fs == rate
    assert "rounded to 0.001 s" in sampling.notes[0]


@pytest.mark.parametrize("rounded", [np.round, lambda time, digits: np.floor(time * 10**digits) / 10**digits])
@pytest.mark.parametrize("rate", [302.37, 300.0])
def test_stamps_rounded_to_thirty_samples_tell_the_rate_to_a_part_of_one(rounded, rate):
    sampling = sample(rounded(900.0137 + np.arange(N) / rate, 1))
    known = float(sampling.notes[0].split("tell to ")[1].split(" %")[0]) / 100
    assert abs(sampling.fs / rate - 1) <= known < 2 / N  # where the ends alone tell it to 30 / N
    assert sampling.notes[0].endswith(" %, and frequencies no better; --fs states the rate")


def test_a_stated_rate_that_rounded_stamps_bear_out_is_taken():
    sampling = sample(np.round(np.arange(N) / 302.3712, 1), fs=302.3712)
    assert sampling.fs == 302.3712
    assert sampling.notes[0].endswith("at 302.371 Hz")


def test_moderate_jitter_is_resampled_onto_the_grid():
    jitter = np.random.default_rng(1).uniform(-0.15, 0.15, N) / 250
    jitter[[0, -1]] = 0
    sampling = sample(GRID + jitter)
    assert "resampled" in sampling.notes[0]
    raw = np.abs(signal(GRID + jitter) - signal(GRID)).max()
    assert np.abs(sampling.columns - signal(GRID)).max() < 0.01 * raw


@pytest.mark.parametrize("way", [1, -1], ids=["last", "first"])
def test_a_stamp_beyond_the_grid_of_the_others_is_resampled(way):
    """A grid of least squares ends before a last stamp that is most of a sample late."""
    time = np.arange(400.0)
    time[[-3, -1]] += 0.6, 0.7  # one step is short, so the long ones miss no sample
    time = time / 200.0 if way > 0 else (399.0 - time[::-1]) / 200.0
    made = uniform_sampling("x.csv", time, None, np.cos(2 * np.pi * 0.3 * time)[:, None])
    grid = made.start + np.arange(len(made.columns)) / made.fs
    off = np.abs(made.columns[:, 0] - np.cos(2 * np.pi * 0.3 * grid))
    assert off.size == 400
    assert np.count_nonzero(np.isnan(off)) <= 2  # in the long steps
    assert np.nanmax(off) < 1e-6


@pytest.mark.parametrize(("step", "kept"), [(0.015, True), (1e-4, False)])
def test_a_converter_s_steps_stay_where_they_are_larger_than_what_the_stamps_move(step, kept):
    """Between large steps a spline would show none; between small ones it is nearer to the signal than a sample."""
    random = np.random.default_rng(1)
    time = GRID + np.concatenate([[0.0], random.uniform(-0.15, 0.15, N - 2), [0.0]]) / 250
    sampling = uniform_sampling("rig.csv", time, None, step * np.round(signal(time, 1) / step))
    made = sampling.columns[:, 0]
    assert bool(np.all(np.abs(made / step - np.round(made / step)) < 1e-9)) is kept
    assert ("by the nearest stamp" in sampling.notes[0]) is kept
    assert np.std(made - signal(GRID, 1)[:, 0]) < (1.13 if kept else 1.42) * step / np.sqrt(12)


def test_a_channel_without_a_number_is_left_to_the_check_for_numbers():
    time = GRID + np.random.default_rng(1).uniform(-0.15, 0.15, N) / 250
    columns = np.column_stack([signal(time)[:, 0], np.full(N, np.nan)])
    assert np.flatnonzero(np.all(np.isnan(uniform_sampling("rig.csv", time, None, columns).columns), axis=0)) == [1]


@pytest.mark.parametrize("lost", [[500], [500, 501], [37, 500, 501, 903, 1800], list(range(700, 1500))])
def test_where_stamps_are_missing_the_samples_are_none(lost):
    sampling = sample(np.delete(GRID, lost), frequency=6)
    assert sampling.columns.shape == (N, 1)
    assert sampling.fs == pytest.approx(250, rel=1e-9)
    assert np.flatnonzero(np.isnan(sampling.columns)).tolist() == lost
    kept = np.delete(np.arange(N), lost)
    np.testing.assert_array_equal(sampling.columns[kept], signal(GRID[kept], 6))


def test_lost_samples_are_found_among_jitter():
    jitter = np.clip(0.15 * np.random.default_rng(5).standard_normal(N), -0.4, 0.4) / 250
    jitter[[0, -1]] = 0
    lost = [500, 900, 901, 902]
    sampling = sample(np.delete(GRID + jitter, lost), frequency=6)
    gone = np.flatnonzero(np.isnan(sampling.columns[:, 0]))
    near = (gone / (sampling.columns.shape[0] - 1) * (N - 1))[:, None] - np.array(lost)
    assert np.all(np.min(np.abs(near), axis=1) < 1)
    assert np.all(np.min(np.abs(near), axis=0) < 1)


def test_a_discontinuity_in_two_rows_is_one_instant():
    """As simulators write events: the displacement goes on, the force jumps; after the stamp the second row holds."""
    force = np.where(np.arange(N) < 500, 0.0, 5.0)
    rows = np.sort(np.append(np.arange(N), 500))
    before = np.column_stack([signal(GRID)[rows, 0], force[rows]])
    before[500, 1] = 0.0
    sampling = uniform_sampling("rec", GRID[rows], None, before)
    np.testing.assert_array_equal(sampling.columns, np.column_stack([signal(GRID), force]))
    assert "1 discontinuities stand in two rows" in sampling.notes[0]


def test_a_row_that_is_written_twice_is_one():
    rows = np.sort(np.append(np.arange(N), [37, 38, 500]))
    sampling = uniform_sampling("rec", GRID[rows], None, signal(GRID)[rows])
    np.testing.assert_array_equal(sampling.columns, signal(GRID))
    assert "3 row(s) are written twice" in sampling.notes[0]


def test_a_gap_of_ages_takes_no_memory():
    with pytest.raises(BadInput, match="most of it is missing"):
        sample(np.append(GRID, 1e16))


@pytest.mark.parametrize(
    ("first", "said"),
    [
        (12.0, None),
        (86400.0, "the time stamps begin at 86400 s; counted"),
        (1.7e9, "begin at 1700000000 s since 1970 (2023-11-14 22:13:20 UTC); counted"),
        (3.9e11, "begin at 3.9e+11 s; counted"),
    ],
)
def test_times_count_from_the_first_sample_where_the_clock_has_run_for_long(first, said):
    found = uniform_sampling("a.csv", first + np.arange(2000) / 1000.0, None, np.zeros((2000, 1)))
    assert found.fs == pytest.approx(1000.0, rel=1e-4)
    assert found.start == (0.0 if said else first)
    assert (said in found.notes[-1]) if said else not found.notes


@pytest.mark.parametrize(("part", "taken"), [(0.0095, True), (0.0105, False)])
def test_jitter_that_is_little_of_a_cycle_is_no_guess(part, taken):
    """A logger of 250 Hz that wavers by more than a quarter of a step, beside a cycle that is slow enough."""
    jitter = np.random.default_rng(4).uniform(-0.4, 0.4, N) / 250
    jitter[[0, -1]] = 0
    time = GRID + jitter
    frequency = part / np.std(np.diff(time))
    if taken:
        sampling = sample(time, frequency=frequency)
        grid = sampling.start + np.arange(N) / sampling.fs
        assert np.abs(sampling.columns - signal(grid, frequency)).max() < 1e-3
    else:
        with pytest.raises(BadInput, match=r"jitter by 3. %"):
            sample(time, frequency=frequency)


@pytest.mark.parametrize(
    ("time", "fs", "words"),
    [
        (None, None, "no time column.*--time.*--fs"),
        (None, 0.0, "must be a positive number"),
        (None, float("nan"), "must be a positive number"),
        (GRID, 500.0, "--fs says 500 Hz but the time column says 250 Hz"),
        (GRID[::-1], None, "does not increase"),
        (
            np.where(np.arange(N) == 100, GRID[98], GRID),
            None,
            "does not increase at 1 place.*row 100 of.*0.396 s from the start",
        ),
        (
            np.concatenate([GRID[: N // 2]] * 2),
            None,
            f"starts anew 1 time.s., first in row {N // 2 + 1} .* holds 2 runs",
        ),
        (np.where(np.arange(N) == 7, np.nan, GRID), None, "time column has 1 value.*row 8"),
        (GRID + np.tile([0, 0.45], N // 2) / 250, None, "jitter by 45 %"),
        (GRID + np.random.default_rng(3).uniform(-0.45, 0.45, N) / 250, None, "jitter by 3. %"),
    ],
)
def test_bad_time(time, fs, words):
    with pytest.raises(BadInput, match=words):
        sample(time, fs)


def test_jitter_does_not_make_a_switched_channel_ring():
    jitter = np.clip(0.15 * np.random.default_rng(5).standard_normal(N), -0.4, 0.4) / 250
    force = np.repeat(np.random.default_rng(6).choice([-2.0, 2.0], N // 10), 10)[:N]
    made = uniform_sampling("rig.csv", GRID + jitter, None, np.column_stack([signal(GRID + jitter), force]))
    np.testing.assert_array_equal(made.columns[:, 1], force)
    # the grid is that of all stamps, not of the first and the last
    assert made.start == pytest.approx(GRID[0], abs=0.03 / 250)
    raw = np.abs(signal(GRID + jitter) - signal(GRID)).max()
    assert np.abs(made.columns[:, :1] - signal(GRID)).max() < 0.1 * raw


@pytest.mark.parametrize("samples", [7.3, 4.2])
def test_a_white_command_stays_as_its_rows_say_and_a_tone_does_not(samples):
    jitter = np.clip(0.15 * np.random.default_rng(5).standard_normal(N), -0.4, 0.4) / 250
    force, frequency = np.random.default_rng(6).standard_normal(N), 250 / samples
    shown = np.column_stack([signal(GRID + jitter, frequency), force])
    made = uniform_sampling("rig.csv", GRID + jitter, None, shown)
    np.testing.assert_array_equal(made.columns[:, 1], force)
    raw, left = (np.std(x[:, :1] - signal(GRID, frequency)) for x in (shown, made.columns))
    assert left < 0.6 * raw


@pytest.mark.parametrize("noise", [0.0, 2e-3])
def test_jitter_does_not_make_what_a_switched_force_accelerates_ring(noise):
    """An acceleration is what its force makes it, to the last instant before an edge; the stamp says on which side."""
    random = np.random.default_rng(5)
    jitter = np.clip(0.15 * random.standard_normal(N), -0.4, 0.4) / 250
    force = np.repeat(np.random.default_rng(6).choice([-2.0, 2.0], N // 10), 10)[:N]
    acts = force[np.maximum(np.arange(N) - (jitter < 0), 0)]
    shown = np.column_stack([9 * signal(GRID + jitter)[:, 0] + acts, force + noise * random.standard_normal(N)])
    made = uniform_sampling("rig.csv", GRID + jitter, None, shown).columns[:, 0]
    assert np.abs(made - 9 * signal(GRID)[:, 0] - force).max() < 0.05
