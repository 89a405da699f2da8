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
    assert sampling.fs == pytest.approx(rate, rel=1e-3)
    assert "rounded to 0.001 s" in sampling.notes[0]


def test_moderate_jitter_is_resampled_onto_the_grid():
    jitter = np.random.default_rng(1).uniform(-0.15, 0.15, N) / 250
    jitter[[0, -1]] = 0
    sampling = sample(GRID + jitter)
    assert "resampled" in sampling.notes[0]
    raw = np.abs(signal(GRID + jitter) - signal(GRID)).max()
    assert np.abs(sampling.columns - signal(GRID)).max() < 0.01 * raw


@pytest.mark.parametrize("lost", [[500], [500, 501], [37, 500, 501, 903, 1800]])
def test_gaps_that_are_short_beside_a_cycle_are_bridged(lost):
    """The longest step is at most a twelfth of a cycle: to a thousandth of the motion, as was computed from theory."""
    sampling = sample(np.delete(GRID, lost), frequency=6)
    assert sampling.columns.shape == (N, 1)
    assert sampling.fs == pytest.approx(250, rel=1e-9)
    assert np.abs(sampling.columns - signal(GRID, 6)).max() < 1e-3
    assert f"{len(lost)} sample(s) are missing in" in sampling.notes[0]


@pytest.mark.parametrize(("samples", "bridged"), [(24.8, True), (23.8, False)])
def test_a_gap_of_a_twelfth_of_a_cycle_is_the_longest(samples, bridged):
    """One sample lost, a step of two intervals: 24 samples are twelve such steps."""
    time = np.delete(GRID, 500)
    if bridged:
        assert sample(time, frequency=250 / samples).columns.shape == (N, 1)
    else:
        with pytest.raises(BadInput, match="gap in time"):
            sample(time, frequency=250 / samples)


@pytest.mark.parametrize(("every", "taken"), [(34, True), (38, False)])
def test_a_twelfth_of_the_samples_is_the_fewest(every, taken):
    """Bursts of three samples, of a motion so slow that each gap is short beside a cycle."""
    time = GRID[np.arange(N) % every < 3]
    if taken:
        assert sample(time, frequency=0.5).columns.shape[1] == 1
    else:
        with pytest.raises(BadInput, match="gap in time"):
            sample(time, frequency=0.5)


def test_a_gap_of_ages_takes_no_memory():
    with pytest.raises(BadInput, match="gap in time after"):
        sample(np.append(GRID, 1e16))


@pytest.mark.parametrize(("part", "taken"), [(0.0095, True), (0.0105, False)])
def test_jitter_that_is_little_of_a_cycle_is_no_guess(part, taken):
    """A logger of 250 Hz that wavers by more than a quarter of a step, beside a cycle that is slow enough."""
    jitter = np.random.default_rng(4).uniform(-0.4, 0.4, N) / 250
    jitter[[0, -1]] = 0
    time = GRID + jitter
    frequency = part / np.std(np.diff(time))
    if taken:
        sampling = sample(time, frequency=frequency)
        assert np.abs(sampling.columns - signal(GRID, frequency)).max() < 1e-3
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
        (np.where(np.arange(N) == 100, GRID[98], GRID), None, "does not increase at 1 place.*row 100 of"),
        (
            np.concatenate([GRID[: N // 2]] * 2),
            None,
            f"starts anew 1 time.s., first in row {N // 2 + 1} .* holds 2 runs",
        ),
        (np.delete(GRID, [500, 501, 502]), None, r"gap in time after 4\.996 s, 3 sample"),
        (np.delete(GRID, [500, 900, 901, 902]), None, r"after 6\.596 s, 3 sample.*4 samples in 2 gaps"),
        (np.where(np.arange(N) == 7, np.nan, GRID), None, "time column has 1 value.*row 8"),
        (GRID + np.tile([0, 0.45], N // 2) / 250, None, "jitter by 45 %"),
        (GRID + np.random.default_rng(3).uniform(-0.45, 0.45, N) / 250, None, "jitter by 3. %"),
    ],
)
def test_bad_time(time, fs, words):
    with pytest.raises(BadInput, match=words):
        sample(time, fs)
