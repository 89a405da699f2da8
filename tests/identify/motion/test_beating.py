"""An envelope that beats, beside those that only look so."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.beating import without_beats
from dashpot.identify.motion.envelope import Envelope

PERIOD, BEAT, N = 16, 400, 4000


def envelope(size, floor=1e-3):
    return Envelope(size, PERIOD, floor, floor / 4)


def beating(depth=0.6, decay=3.0, beat=BEAT, n=N):
    """Two modes that decay alike: the envelope swings by ``depth`` about its middle."""
    part = np.arange(n) / N
    return np.exp(-decay * part) * (1.0 - depth * np.cos(2 * np.pi * np.arange(n) / beat))


def test_two_modes_beat_and_their_mean_decays():
    smoothed, beats = without_beats(envelope(beating()))
    assert beats
    inside = slice(2 * BEAT, -2 * BEAT)
    # the mean of the square of 1 - depth cos is 1 + depth²/2
    plain = np.exp(-3.0 * np.arange(N) / N) * np.sqrt(1 + 0.6**2 / 2)
    assert smoothed.size[inside] == pytest.approx(plain[inside], rel=0.05)
    assert (smoothed.period, smoothed.floor) == (PERIOD, 1e-3)


@pytest.mark.parametrize(("rise", "beats"), [(1.2, False), (1.3, True)])
def test_what_rises_by_a_quarter_beats(rise, beats):
    """From a steady low to a high, and as deep again."""
    size = np.where(np.arange(N) // 200 % 2, rise, 1.0) * np.exp(-1e-7 * np.arange(N))
    assert without_beats(envelope(size))[1] is beats


@pytest.mark.parametrize(("crests", "beats"), [(2, False), (3, True)])
def test_three_crests_show_an_interval_twice(crests, beats):
    n = crests * BEAT
    assert without_beats(envelope(beating(n=n)))[1] is beats


@pytest.mark.parametrize(("shift", "beats"), [(10, True), (130, False)])
def test_a_hand_that_pushes_again_is_not_even(shift, beats):
    places = np.array([200, 600, 1000 + shift, 1400])
    size = sum(np.exp(-(((np.arange(2000) - place) / 60.0) ** 2)) * 0.8**i for i, place in enumerate(places))
    assert without_beats(envelope(0.2 * 0.8 ** (np.arange(2000) / 400) + size))[1] is beats


def test_what_is_pushed_higher_does_not_decay():
    given = envelope(beating(decay=-1.0))
    left, beats = without_beats(given)
    assert not beats
    assert left is given


def test_crests_below_the_noise_are_none():
    assert not without_beats(envelope(beating(), floor=1.0))[1]
