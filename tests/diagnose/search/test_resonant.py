"""What rings with the rig is told from noise of any colour."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.search.residual_test import resonant_share

TURN = 0.15  # rad a sample: 42 samples a cycle


def coloured(n: int, slope: float, seed: int) -> np.ndarray:
    """Noise whose density is the frequency to minus the slope; its rms is one."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(n))
    frequency = np.maximum(np.arange(spectrum.size), 1)
    noise = np.fft.irfft(spectrum * frequency ** (-0.5 * slope), n)
    return noise / np.std(noise)


def ringing(n: int, seed: int, damping: float = 0.02) -> np.ndarray:
    """What a rig of that damping makes of a force without a colour; its rms is one."""
    from scipy.signal import lfilter

    pole = np.exp(TURN * complex(-damping, 1.0))
    rung = lfilter([1.0], np.poly([pole, pole.conjugate()]).real, np.random.default_rng(seed).standard_normal(2 * n))
    return rung[n:] / np.std(rung[n:])


@pytest.mark.parametrize("slope", [-2.0, -1.0, 0.0, 1.0, 2.0])
@pytest.mark.parametrize("n", [500, 4000])
def test_noise_of_any_colour_does_not_ring(slope, n):
    assert not any(resonant_share(coloured(n, slope, seed), TURN) > 0 for seed in range(200))


def test_noise_beyond_a_corner_at_the_rigs_frequency_does_not_ring():
    """A filter's corner bends the spectrum there, and lifts it above neither side."""
    from scipy.signal import butter, lfilter

    for order in (1, 2, 4):
        for kind in ("low", "high"):
            b, a = butter(order, TURN / np.pi, kind)
            white = np.random.default_rng(order).standard_normal(40_000)
            assert resonant_share(lfilter(b, a, white)[1000:], TURN) == 0.0


@pytest.mark.parametrize("size", [0.5, 1.0, 3.0])
def test_the_share_is_that_of_what_rings(size):
    n = 20_000
    shares = [resonant_share(coloured(n, 0.0, seed) + size * ringing(n, 1000 + seed), TURN) for seed in range(20)]
    assert np.mean(shares) == pytest.approx(size**2 / (1 + size**2), abs=0.08)


def test_it_is_asked_around_the_frequency_of_the_motion():
    rung = coloured(8000, 0.0, 1) + ringing(8000, 2)
    assert resonant_share(rung, TURN) > 0.3
    assert resonant_share(rung, 0.3 * TURN) == 0.0


@pytest.mark.parametrize("beside", [0, 2])
def test_what_noise_has_by_chance_once_in_a_thousand_does_not_count(beside):
    """A hump over one octave that is 3.5 or 3.9 times as far above the higher of its neighbours as chance goes."""
    n = 4000
    angle = 2.0 * np.pi * np.arange(n // 2 + 1) / n
    octaves = [(angle >= m * TURN / np.sqrt(2)) & (angle < m * TURN * np.sqrt(2)) for m in (0.5, 1.0, 2.0)]
    count = [np.count_nonzero(octave) for octave in octaves]
    deviation = np.sqrt(1 / count[1] + 1 / count[beside])
    phases = np.exp(2j * np.pi * np.random.default_rng(3).uniform(size=angle.size))
    for times, rings in ((3.5, False), (3.9, True)):
        size = np.where(octaves[1], np.exp(0.5 * times * deviation), np.where(octaves[beside], 1.0, 0.1))
        size[[0, -1]] = 0.0
        assert (resonant_share(np.fft.irfft(size * phases, n), TURN) > 0) == rings


def test_where_an_octave_has_no_lines_nothing_is_told():
    rung = ringing(2000, 5)
    assert resonant_share(rung[:60], TURN) == 0.0  # one and a half cycles: nothing lies below
    assert resonant_share(rung, 2.9) == 0.0  # nothing lies above
    assert resonant_share(np.zeros(2000), TURN) == 0.0
    assert resonant_share(np.ones(2000), TURN) == 0.0
