"""Which modes a free motion shows: sums of damped sines, of which frequencies and shares are known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.mode_lines import modes_of
from dashpot.recording import Recording

FS, N = 200.0, 4000
T = np.arange(N) / FS


def ring(frequency, size=1.0, rate=0.15, phase=0.0):
    return size * np.exp(-rate * T) * np.cos(2 * np.pi * frequency * T + phase)


def white(level, seed=0):
    return level * np.random.default_rng(seed).standard_normal(N)


def recording(*parts, noise=1e-4, free=True):
    return Recording("run", FS, np.sum(parts, axis=0) + white(noise), free=free)


def modes(*parts, noise=1e-4, free=True, whole=False):
    return modes_of([recording(*parts, noise=noise, free=free)], whole=whole)


def frequencies(*parts, **more):
    return [round(mode.frequency, 1) for mode in modes(*parts, **more)]


def test_two_modes_and_their_shares():
    """The power of a damped sine is A² / (4 rate)."""
    low, high = modes(ring(10.0), ring(26.3, 0.5, 0.3))
    assert low.frequency == pytest.approx(10.0, abs=0.02)
    assert high.frequency == pytest.approx(26.3, abs=0.02)
    powers = np.array([1.0 / 0.15, 0.25 / 0.3])
    assert [low.share, high.share] == pytest.approx(powers / np.sum(powers), rel=0.03)
    assert (low.strongest, high.strongest) == (True, False)
    for mode in (low, high):
        assert mode.low <= mode.frequency <= mode.high
        assert mode.high - mode.low < 0.1


def test_one_mode_has_all_of_the_motion():
    (mode,) = modes(ring(10.0))
    assert mode.share == 1.0
    assert mode.strongest


def test_the_strongest_need_not_be_the_lowest():
    low, high = modes(ring(7.3, 0.3), ring(26.0))
    assert (low.strongest, high.strongest) == (False, True)


def test_offset_and_drift_are_no_modes():
    assert frequencies(ring(10.0), 5.0 + 0.01 * T) == [10.0]


@pytest.mark.parametrize("order", [2, 3, 5])
def test_a_harmonic_is_no_mode(order):
    assert frequencies(ring(10.0), ring(10.0 * order, 0.2, order * 0.15)) == [10.0]
    assert frequencies(ring(10.0), ring(10.0 * order + 3.0, 0.2, order * 0.15)) == [10.0, 10.0 * order + 3.0]


def test_no_harmonic_is_larger_than_its_fundamental():
    """One that outlives it by far is a mode of its own."""
    assert frequencies(ring(10.0, 1.0, 1.0), ring(20.0, 0.5, 0.1)) == [10.0, 20.0]


@pytest.mark.parametrize(("size", "found"), [(0.13, [10.0]), (0.2, [10.0, 40.3])])
def test_a_line_far_above_its_series_is_no_harmonic(size, found):
    """Of the fourth order on: more than twice as large as all those before it."""
    series = [ring(10.0 * n, 0.08, 0.15) for n in (2, 3)]
    assert frequencies(ring(10.0), *series, ring(40.3, size, 0.15)) == found


def test_the_third_is_a_harmonic_however_far_above_the_second():
    assert frequencies(ring(10.0), ring(20.0, 0.01), ring(30.3, 0.6)) == [10.0]


def test_a_steady_tone_is_no_mode():
    assert frequencies(ring(10.0), 0.1 * np.cos(2 * np.pi * 26.3 * T)) == [10.0]
    assert frequencies(ring(10.0), 0.1 * np.cos(2 * np.pi * 26.3 * T), whole=True) == [10.0, 26.3]


def test_without_free_motion_the_whole_is_looked_at_where_asked():
    tones = np.cos(2 * np.pi * 10.0 * T), 0.3 * np.cos(2 * np.pi * 26.3 * T)
    assert frequencies(*tones, free=False) == []
    assert frequencies(*tones, free=False, whole=True) == [10.0, 26.3]


@pytest.mark.parametrize(("size", "found"), [(0.58, [10.0]), (0.72, [10.0, 26.3])])
def test_a_mode_that_a_fit_would_not_notice_is_none(size, found):
    """It adds less than a fifth to the noise's power: A² / (4 rate) against sigma² of the whole."""
    noise, rate = 0.05, 0.15
    amplitude = size * noise * np.sqrt(4 * rate * T[-1] * 0.5)
    assert frequencies(ring(10.0), ring(26.3, amplitude, rate), noise=noise) == found


def test_noise_is_no_mode():
    for seed in range(5):
        made = modes_of([Recording("run", FS, ring(10.0) + white(0.1, seed), free=True)])
        assert [round(mode.frequency, 1) for mode in made] == [10.0]


def test_sums_and_differences_of_two_modes_are_none():
    joint = [ring(f, 0.02, 0.3) for f in (26.3 - 10.0, 26.3 + 10.0, 2 * 26.3 - 10.0, 26.3 + 2 * 10.0)]
    assert frequencies(ring(10.0), ring(26.3, 0.5), *joint) == [10.0, 26.3]
    assert frequencies(ring(10.0), ring(26.3, 0.5), ring(17.1, 0.02, 0.3)) == [10.0, 17.1, 26.3]


def test_a_frequency_that_moves_with_the_amplitude():
    """From 12 to 10 Hz as it dies away: one mode between them, and its harmonic is none."""
    turn = 2 * np.pi * (10.0 * T + 2.0 * (1 - np.exp(-0.3 * T)) / 0.3)
    x = np.exp(-0.15 * T) * (np.cos(turn) + 0.1 * np.cos(3 * turn))
    (mode,) = modes(x)
    assert mode.low == pytest.approx(10.0, abs=0.2)
    assert mode.high == pytest.approx(12.0, abs=0.5)
    assert mode.low < mode.frequency <= mode.high


def test_what_a_recorders_filter_takes_is_no_mode():
    assert frequencies(ring(10.0), ring(87.3, 0.1)) == [10.0, 87.3]
    assert frequencies(ring(10.0), ring(91.3, 0.1)) == [10.0]


@pytest.mark.parametrize(("size", "found"), [(0.15, [10.0]), (0.25, [10.0, 33.7])])
def test_what_folds_back_is_below_what_lies_at_the_top(size, found):
    """Harmonics fold back anywhere: of what is less than four times the power there nobody knows what it is."""
    assert frequencies(ring(10.0), ring(90.3, 0.1), ring(33.7, size)) == found


def test_the_strongest_is_followed_to_both_sides_of_where_it_is_loudest():
    """It swells as it falls, from 10 to 12 Hz and back."""
    fall = np.exp(-0.3 * np.abs(T - 10.0))
    turn = 2 * np.pi * np.cumsum(10.0 + 2.0 * fall) / FS
    (mode,) = modes(fall * np.cos(turn))
    assert mode.low == pytest.approx(10.0, abs=0.3)
    assert mode.high == pytest.approx(12.0, abs=0.5)
    assert mode.frequency == pytest.approx(12.0, abs=0.6)


def test_recordings_of_one_rig_are_joined():
    made = modes_of([recording(ring(10.0)), recording(ring(10.0, 0.5), ring(26.3, 0.5, 0.3))])
    assert [round(mode.frequency, 1) for mode in made] == [10.0, 26.3]
    powers = np.array([1.25 / 0.15, 0.25 / 0.3])
    assert [mode.share for mode in made] == pytest.approx(powers / np.sum(powers), rel=0.05)


def test_too_little_shows_none():
    assert modes_of([]) == []
    assert modes(np.zeros(N), noise=0.0) == []
    # windows of sixteen cycles, three of them a quarter of one apart
    both = ring(10.0, rate=0.5) + ring(26.3, 0.5, 0.5) + white(1e-4)
    for cycles, found in ((23.5, []), (24.5, [10, 26])):
        short = Recording("short", FS, both[: round(cycles * 20)], free=True)
        assert [round(mode.frequency) for mode in modes_of([short])] == found


def coloured(power, level, seed):
    """Noise whose power falls with this power of the frequency, of this rms."""
    lines = np.fft.rfft(white(1.0, seed))
    place = np.arange(lines.size, dtype=float)
    place[0] = np.inf
    noise = np.fft.irfft(lines * place ** (-power / 2.0), N)
    return level * noise / np.std(noise)


@pytest.mark.parametrize("power", [1.0, 2.0])
@pytest.mark.parametrize("level", [0.003, 0.03])
def test_noise_of_a_colour_is_no_mode_and_hides_none_that_stands_out_of_it(power, level):
    """Judged by the noise of the highest frequencies, which is less, eight such records in ten had further modes."""
    for seed in range(10):
        noise = coloured(power, level, seed)
        assert frequencies(ring(10.0), noise) == [10.0]
        assert frequencies(ring(10.0), ring(26.3, 0.3), noise) == [10.0, 26.3]
