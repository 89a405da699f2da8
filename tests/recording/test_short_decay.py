"""Few swings: what their errors say decides, not how many there are."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.recording.short_decay import damped_sine, is_short_decay

FS, N = 100.0, 500
T = np.arange(N) / FS


def swings(cycles, fall, noise, seed, offset=0.3):
    random = np.random.default_rng(seed)
    turn = 2 * np.pi * cycles * T / T[-1] + random.uniform(0, 2 * np.pi)
    return offset + np.exp(-fall * T / T[-1]) * np.cos(turn) + noise * random.standard_normal(N)


@pytest.mark.parametrize(("cycles", "noise"), [(1.6, 1e-3), (2.5, 0.05), (4.0, 0.05)])
def test_its_errors_are_honest(cycles, noise):
    fits = [damped_sine(swings(cycles, 0.5, noise, seed), FS) for seed in range(30)]
    frequency = [(fit.frequency - cycles / T[-1]) / fit.frequency_std for fit in fits]
    rate = [(fit.rate - 0.5 / T[-1]) / fit.rate_std for fit in fits]
    for scores in (frequency, rate):
        assert 0.6 < np.sqrt(np.mean(np.square(scores))) < 1.5


@pytest.mark.parametrize(
    ("cycles", "fall", "noise", "decays"),
    [
        (3.2, 0.3, 0.02, True),
        (1.6, 0.3, 0.005, True),
        (1.2, 0.3, 0.005, False),  # two turning points: a loss or an offset
        (3.2, 0.3, 1.0, False),  # lost in noise
        (3.2, 0.0, 0.005, False),  # a steady tone
        (3.2, 0.04, 0.005, False),  # ... whose amplitude wanders
    ],
)
def test_a_fall_that_stands_out_of_its_error_is_a_decay(cycles, fall, noise, decays):
    answers = [is_short_decay(swings(cycles, fall, noise, seed), FS) for seed in range(10)]
    assert answers == [decays] * 10


def test_noise_is_no_decay():
    random = np.random.default_rng(1)
    assert not any(is_short_decay(random.standard_normal(N), FS) for _ in range(20))
