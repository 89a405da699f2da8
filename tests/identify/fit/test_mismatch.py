"""What a mismatch tells: as much as there are unlike witnesses of it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.fit.limits import HARMONICS
from dashpot.identify.fit.mismatch import WITNESS, gain_of_mismatch, witnesses
from dashpot.identify.problem.segments import Segment

PER_CYCLE = 50


def phase(cycles, per_cycle=PER_CYCLE):
    return 2 * np.pi * np.arange(cycles * per_cycle) / per_cycle


def segment(cycles, left, per_cycle=PER_CYCLE, force=None):
    """A stretch whose simulated motion is a sine, and what is left of it."""
    response = 100.0 * np.cos(phase(cycles, per_cycle)) + left
    return Segment(0, 0, response.size, response, force, 1.0 / per_cycle, 0.0, 2 * np.pi)


def alike(cycles, size=1.0, per_cycle=PER_CYCLE):
    """The same third harmonic in every cycle."""
    return size * np.sin(3 * phase(cycles, per_cycle))


def unlike(cycles):
    """In every six cycles another harmonic, as many as a witness has components."""
    turns = [np.cos, np.sin]
    parts = [turns[i % 2]((1 + i // 2) * phase(6)) for i in range(cycles // 6)]
    return np.concatenate(parts)


def test_what_repeats_itself_is_one_witness_however_long_it_is():
    for cycles in (6, 60, 600):
        assert witnesses([alike(cycles)], [segment(cycles, alike(cycles))]) == pytest.approx(1.0, abs=0.11)


def test_blocks_that_have_nothing_in_common_count_each():
    left = unlike(6 * 2 * HARMONICS)
    assert witnesses([left], [segment(6 * 2 * HARMONICS, left)]) == pytest.approx(2 * HARMONICS, rel=1e-6)


def test_noise_is_unlike_in_every_block():
    left = np.random.default_rng(1).normal(size=600 * PER_CYCLE)
    assert witnesses([left], [segment(600, left)]) == pytest.approx(100.0, rel=0.2)


def test_a_gain_is_the_pooled_power_by_the_witnesses():
    gain, worth = gain_of_mismatch([alike(6, 2.0)], [alike(6, 1.0)], [segment(6, alike(6))])
    assert gain == pytest.approx(WITNESS * np.log(4.0))
    assert worth == pytest.approx(2 * WITNESS)


def test_it_does_not_grow_with_the_sampling_rate():
    often, rarer = (
        gain_of_mismatch([alike(60, 2.0, n)], [alike(60, 1.0, n)], [segment(60, alike(60, 1.0, n), n)])[0]
        for n in (PER_CYCLE, PER_CYCLE // 2)
    )
    assert rarer == pytest.approx(often, rel=1e-6)


def test_a_quiet_block_does_not_outvote_a_loud_one():
    """The same factor lost at a tenth of the size is a hundredth of the power."""
    before = np.concatenate([alike(6, 2.0), alike(6, 0.1)])
    after = np.concatenate([alike(6, 1.0), alike(6, 0.4)])
    gain, _ = gain_of_mismatch([before], [after], [segment(12, after)])
    back, _ = gain_of_mismatch([after], [before], [segment(12, after)])
    assert gain > WITNESS
    assert back == pytest.approx(-gain)


def test_bags_of_like_blocks_say_the_same():
    gains, _ = gain_of_mismatch([alike(60, 2.0)], [alike(60, 1.0)], [segment(60, alike(60))], bags=20)
    assert gains == pytest.approx(np.full(21, gains[0]), rel=1e-6)


def test_what_one_block_of_ten_says_many_bags_say_otherwise():
    """Drawn ten times of ten, a block is missing from a bag with the chance of 0.9 to the tenth power."""
    after = np.concatenate([alike(54, 1.1), alike(6, 0.1)])
    gains, _ = gain_of_mismatch([np.concatenate([alike(54), alike(6, 10.0)])], [after], [segment(60, after)], bags=4000)
    assert gains[0] > 0.0
    assert np.mean(gains < 0.0) == pytest.approx(0.9**10, abs=0.025)


def test_free_and_driven_stretches_have_a_level_each():
    left = alike(6)
    free, driven = segment(6, left), segment(6, left, force=np.ones(left.size))
    gain, worth = gain_of_mismatch([2 * left, 100 * left], [left, 100 * left], [free, driven])
    assert gain == pytest.approx(WITNESS * np.log(4.0))
    assert worth == pytest.approx(4 * WITNESS)
