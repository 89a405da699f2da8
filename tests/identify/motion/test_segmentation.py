"""A recording divided into what is free, held or moved, by the likelihood of a simple model of each."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.motion.free_motion import periods_of
from dashpot.identify.motion.pieces import FREE, HELD, free_pieces
from dashpot.identify.motion.segmentation import segmented
from dashpot.recording import Recording

FS = 200.0


def ringing(zeta: float, seconds: float, frequency: float = 1.5, size: float = 1.0) -> np.ndarray:
    """(n,) let go at rest from ``size``, linear."""
    t, omega = np.arange(round(seconds * FS)) / FS, 2 * np.pi * frequency
    turn = omega * np.sqrt(1 - zeta**2)
    return size * np.exp(-zeta * omega * t) * (np.cos(turn * t) + zeta * omega / turn * np.sin(turn * t))


def seen(*parts: np.ndarray, noise: float = 1e-3, seed: int = 1) -> np.ndarray:
    whole = np.concatenate(parts)
    return whole + noise * np.random.default_rng(seed).standard_normal(whole.size)


def ramp(a: float, b: float, seconds: float) -> np.ndarray:
    s = np.linspace(0, 1, round(seconds * FS))
    return a + (b - a) * s**3 * (10 - 15 * s + 6 * s**2)


@pytest.mark.parametrize("zeta", [0.03, 0.1, 0.2, 0.35, 0.6])
def test_a_release_after_a_hold(zeta):
    """It begins where it was let go, and its fall is right to its error, however few cycles it has."""
    x = seen(np.ones(200), ringing(zeta, 5.0))
    pieces = segmented(x, FS, 1e-3, periods_of(x))[0]
    assert pieces[0].kind == HELD
    (piece,) = free_pieces(pieces)
    assert 200 <= piece.start < 200 + FS / 1.5 / 2
    assert piece.stop == x.size
    assert piece.rate == pytest.approx(zeta * 3 * np.pi, abs=4 * piece.rate_std)
    assert piece.rate_std < piece.rate / 10


@pytest.mark.parametrize(("zeta", "least"), [(0.05, 6), (0.1, 4), (0.2, 3)])
def test_releases_of_one_file_are_pieces_of_their_own(zeta, least):
    """The more damping, the fewer cycles tell where each begins; what is taken is right."""
    sizes = [10.0, 8.0, -6.0, 9.0, 5.0, -7.0]
    parts = [p for size in sizes for p in (ramp(0, size, 0.8), np.full(100, size), ringing(zeta, 6.0, size=size))]
    recording = Recording("six", FS, 1e-3 * seen(*parts, noise=1e-2))
    decays = find_free_motion(recording).decays
    begun = np.arange(6) * 1460 + 260
    assert len(decays) >= least
    assert all(0 <= d.start - begun[begun <= d.start][-1] < 3 * FS / 1.5 for d in decays)  # within three cycles
    assert all(d.omega == pytest.approx(3 * np.pi, rel=0.01) for d in decays)
    assert all(d.rate == pytest.approx(zeta * 3 * np.pi, rel=0.01) for d in decays)


@pytest.mark.parametrize("times", [(0.4, 1.5, 2.6, 3.7), (0.4, 1.5, 3.3, 4.4)])
def test_plucks_to_a_beat_or_not_are_the_same(times):
    """Each pluck moves the velocity at once: what rings on and what begins are two pieces."""
    x, fs = np.zeros(round(5.4 * 532.48)), 532.48
    for place, size in zip(times, (12.0, 10.8, 9.6, 8.4), strict=True):
        first = round(place * fs)
        t = np.arange(x.size - first) / fs
        x[first:] += size * np.exp(-0.04 * 42 * np.pi * t) * np.cos(42 * np.pi * t)
    x += 0.02 * np.random.default_rng(2).standard_normal(x.size) - 0.93
    decays = find_free_motion(Recording("plucks", fs, x, quantity="acceleration", unit="m/s2")).decays
    assert len(decays) == 4
    assert all(abs(d.start / fs - place) < 0.02 for d, place in zip(decays, times, strict=True))


def test_a_stop_by_hand_is_left_out():
    free = ringing(0.02, 8.0)
    x = seen(free, ramp(float(free[-1]), 0.0, 0.15), np.zeros(600))
    (piece,) = free_pieces(segmented(x, FS, 1e-3, [FS / 1.5])[0])
    assert free.size - 100 < piece.stop <= free.size + 10


def test_the_period_that_is_likeliest_is_taken():
    x = seen(ringing(0.05, 8.0))
    (piece,) = free_pieces(segmented(x, FS, 1e-3, [1600.0, 800.0, FS / 1.5, 20.0])[0])
    assert piece.omega == pytest.approx(3 * np.pi, rel=1e-3)


STEADY = np.sin(3 * np.pi * np.arange(2000) / FS)


@pytest.mark.parametrize(
    "x",
    [
        pytest.param(seen(np.zeros(2000)), id="noise"),
        pytest.param(seen(STEADY), id="tone"),
        pytest.param(seen(np.exp(0.3 * np.arange(2000) / FS) * STEADY), id="growth"),
    ],
)
def test_what_does_not_fall_is_no_free_piece(x):
    assert free_pieces(segmented(x, FS, 1e-3, [FS / 1.5])[0]) == ()
    with pytest.raises(BadInput, match="neither a free decay nor"):
        identify(Recording("still", FS, 1e-3 * x))


def test_what_stands_still_has_no_pieces():
    assert segmented(np.ones(400), FS, 0.0, [100.0]) == ((), 0.0)


def test_pieces_follow_one_another():
    x = seen(np.ones(300), ringing(0.1, 5.0), ramp(0, 1, 0.8), np.ones(100), ringing(0.1, 5.0))
    pieces = segmented(x, FS, 1e-3, [FS / 1.5])[0]
    assert all(a.stop <= b.start for a, b in pairwise(pieces))
    assert {piece.kind for piece in pieces} >= {FREE, HELD}


@pytest.mark.parametrize("zeta", [0.1, 0.35])
def test_the_plain_answer_of_a_held_release_is_right(zeta):
    found = identify(Recording("held", FS, 3e-3 * seen(np.ones(200), ringing(zeta, 5.0)))).oscillator.parameters()
    for name, true in (("omega0", 3 * np.pi), ("viscous", 2 * zeta * 3 * np.pi)):
        parameter = found[name]
        assert parameter.std is not None
        assert parameter.value == pytest.approx(true, abs=3.5 * parameter.std)
