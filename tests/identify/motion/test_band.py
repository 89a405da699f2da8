"""A zero-phase band: what it passes stays as it was, what it takes of the noise is put back."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.band import in_band
from dashpot.identify.signals.hilbert import noise_level
from dashpot.model.oscillator import Band
from dashpot.recording import Recording

FS, N, NOISE = 200.0, 4000, 1e-4
BAND = Band(10.0, 5.0, 20.0)
REACH = round(2.0 / BAND.taper * FS)


def t(n=N):
    return np.arange(n) / FS


def tone(frequency, n=N):
    return np.cos(2 * np.pi * frequency * t(n))


def white(n=N, seed=0, level=NOISE):
    return level * np.random.default_rng(seed).standard_normal(n)


def swell(n=N):
    """Rests at both ends."""
    return np.exp(-(((np.arange(n) - n / 2) / (n / 12)) ** 2))


def recording(x, force=None):
    return Recording("run", FS, x, force, start=3.0)


def density(x, low, high):
    power = np.abs(np.fft.rfft(x)) ** 2 / x.size
    frequency = np.fft.rfftfreq(x.size, 1 / FS)
    return float(np.mean(power[(frequency > low) & (frequency < high)]))


# The response --------------------------------------------------------------------------------------------------------


def test_what_lies_in_the_band_stays_and_the_rest_goes():
    x = swell() * (tone(10.0) + 2.0 * tone(40.0)) + 7.0
    made = in_band(recording(x), BAND)
    assert made.n == N
    assert made.start == 3.0
    assert made.response == pytest.approx(swell() * tone(10.0), abs=2e-3)
    assert made.force is None
    assert made.struck == ()
    assert made.name == "run"


def test_a_band_without_a_lower_edge_keeps_the_level():
    x = swell() * (tone(10.0) + tone(60.0)) + 7.0 + 1e-5 * t()
    made = in_band(recording(x), Band(10.0, 0.0, 20.0))
    assert made.response == pytest.approx(swell() * tone(10.0) + 7.0, abs=2e-3)
    assert in_band(recording(x), Band(10.0, 5.0, None)).response == pytest.approx(
        swell() * (tone(10.0) + tone(60.0)), abs=2e-3
    )


def test_the_noise_has_no_hole():
    """White before and after, of the same level, and the same again at a second call."""
    x = swell() * tone(10.0) + white()
    made = np.asarray(in_band(recording(x), BAND).response)
    for low, high in ((1.0, 3.0), (30.0, 60.0), (60.0, 99.0)):
        assert density(made, low, high) == pytest.approx(NOISE**2, rel=0.35)
    assert density(made, 30.0, 99.0) == pytest.approx(NOISE**2, rel=0.12)
    assert np.array_equal(made, in_band(recording(x), BAND).response)
    assert made[:100] != pytest.approx(x[:100], abs=1e-6)  # it is other noise


# Its ends ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", [False, True])
@pytest.mark.parametrize("last", [False, True])
def test_an_end_in_motion_is_cut_off_as_far_as_the_band_reaches(first, last):
    level = np.ones(N)
    if not first:
        level[: N // 2] = swell()[: N // 2]
    if not last:
        level[N // 2 :] = swell()[N // 2 :]
    made = in_band(recording(level * tone(10.0) + white()), BAND)
    assert made.n == N - REACH * (first + last)
    assert made.start == pytest.approx(3.0 + REACH * first / FS)
    a = REACH * first
    assert made.response == pytest.approx((level * tone(10.0))[a : a + made.n], abs=0.02)


@pytest.mark.parametrize(("range_", "cut"), [(5.6, 0), (6.4, 1)])
@pytest.mark.parametrize("side", [0, 1])
def test_an_end_rests_within_three_deviations(range_, cut, side):
    """Over a cycle; seen from its own middle, of noise that has exactly this range there."""
    x = swell() * tone(10.0) + white()
    noise = white()
    end = slice(0, 20) if side == 0 else slice(N - 20, N)
    level = noise_level(x, FS)
    part = noise[end] - np.min(noise[end])
    x[end] = level * range_ * (part / np.max(part) - 0.5)
    other = slice(N - 20, N) if side == 0 else slice(0, 20)
    x[other] = 0.0
    made = in_band(recording(x), BAND)
    assert made.n == N - REACH * cut
    assert made.start == pytest.approx(3.0 + (REACH / FS if cut and side == 0 else 0.0))


@pytest.mark.parametrize(("times", "cut"), [(3.9, False), (4.1, True)])
def test_where_too_little_would_be_left_nothing_is_cut(times, cut):
    n = round(times * REACH)
    assert in_band(recording(tone(10.0, n)), BAND).n == (n - 2 * REACH if cut else n)


def test_a_motion_at_its_end_goes_on_by_point_reflection():
    """A line with a sine that crosses it at both ends is continued exactly; without a lower edge it stays as it is."""
    x = np.sin(2 * np.pi * 10.0 * t(4001)) + 0.3 * t(4001)
    made = in_band(recording(x), Band(10.0, 0.0, 20.0))
    reach = round(2.0 / Band(10.0, 0.0, 20.0).taper * FS)
    assert made.response == pytest.approx(x[reach : 4001 - reach], abs=2e-3)
    few = x[: 3 * reach // 20 * 20 + 1]
    assert in_band(recording(few), Band(10.0, 0.0, 20.0)).response == pytest.approx(few, abs=0.02)


def test_a_motion_that_comes_to_rest_elsewhere_goes_on_there():
    x = swell() * tone(10.0) + 5.0
    made = np.asarray(in_band(recording(x + white()), Band(10.0, 0.0, 20.0)).response)
    assert made == pytest.approx(x, abs=0.01)
    assert made[-1] == pytest.approx(5.0, abs=1e-3)


# The force -----------------------------------------------------------------------------------------------------------


def test_the_force_goes_through_the_same_band():
    force = swell() * (3.0 * tone(9.0) + tone(50.0)) + 0.5
    x = swell() * tone(9.0)
    made = in_band(recording(x + white(), force + white(N, 1, 1e-2)), BAND)
    assert made.force is not None
    assert made.struck == ()
    assert made.force == pytest.approx(swell() * 3.0 * tone(9.0), abs=0.06)
    assert density(np.asarray(made.force), 30.0, 99.0) == pytest.approx(1e-4, rel=0.15)
    # both noises are drawn apart
    rest = np.asarray(made.response)[:300] / NOISE, np.asarray(made.force)[:300] / 1e-2
    assert abs(np.corrcoef(*rest)[0, 1]) < 0.3


def test_a_force_of_zeros_stays():
    made = in_band(recording(swell() * tone(10.0), np.zeros(N)), BAND)
    assert made.force is not None
    assert not np.any(made.force)


def struck(*at, clipped=(), n=N):
    force = white(n, 1, 1e-3) + 0.2
    x = np.zeros(n)
    for k in at:
        force[k : k + 6] += 20.0 * np.sin(np.pi * (np.arange(6) + 0.5) / 6)
        later = np.maximum(t(n) - k / FS, 0.0)
        x += np.exp(-1.5 * later) * np.sin(2 * np.pi * 10.0 * later)
    for k in clipped:
        force[k + 1 : k + 5] = 25.0
    return in_band(recording(x + white(n), force), BAND)


def test_a_blow_is_drawn_out_by_the_band():
    made = struck(800, 2400)
    assert made.force is not None
    force = np.asarray(made.force)
    (a, b, first), (c, d, second) = made.struck
    assert not first
    assert not second
    assert 800 - REACH <= a < 780 < 830 < b <= 810 + REACH
    assert 2400 - REACH <= c < 2380 < 2430 < d <= 2410 + REACH
    # but for a thousandth of its largest it is in there, and no noise beside it
    outside = np.ones(N, bool)
    outside[a:b] = outside[c:d] = False
    largest = np.max(np.abs(force))
    assert np.max(np.abs(force[outside])) < 1.01e-3 * largest
    assert min(abs(force[k]) for k in (a, b - 1, c, d - 1)) > 0.99e-3 * largest
    # the band keeps its push at the mode: the sum with the sine's phase
    turn = np.exp(-2j * np.pi * 10.0 * t())
    pulse = np.zeros(N)
    for k in (800, 2400):
        pulse[k : k + 6] = 20.0 * np.sin(np.pi * (np.arange(6) + 0.5) / 6)
    assert abs(force @ turn) == pytest.approx(abs(pulse @ turn), rel=0.01)


def test_which_blow_was_clipped_is_known():
    assert [clipped for *_, clipped in struck(800, 2400, clipped=(2400,)).struck] == [False, True]


def test_drawn_out_blows_do_not_overlap():
    (a, b, _), (c, d, _) = struck(800, 930).struck
    assert b == c
    assert a < 800 < b
    assert c < d


def test_a_blow_within_the_first_cycle_is_no_motion_that_is_cut_off():
    made = struck(15, 2000)
    assert made.start == 3.0
    assert made.struck[0][0] == 0
    assert made.struck[0][1] > 20
