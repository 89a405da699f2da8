"""What a mismatch tells: a few numbers a stretch."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.identify.fit.mismatch import gain_of_mismatch

PER_CYCLE = 50


def segment(cycles):
    return SimpleNamespace(n=cycles * PER_CYCLE, dt=1.0 / PER_CYCLE, pace=2 * np.pi)


def wave(cycles, size):
    return size * np.sin(2 * np.pi * np.arange(cycles * PER_CYCLE) / PER_CYCLE)


@pytest.mark.parametrize(("cycles", "stretches"), [(5, 1), (11, 1), (12, 2), (17, 2), (60, 10)])
def test_a_stretch_of_six_cycles_tells_the_amplitude_and_phase_of_five_harmonics(cycles, stretches):
    """Ten numbers, each of which gains the logarithm of how much smaller what is left has become."""
    gain = gain_of_mismatch([wave(cycles, 2.0)], [wave(cycles, 1.0)], [segment(cycles)])
    assert gain == pytest.approx(10 * stretches * np.log(2.0))


def test_it_does_not_grow_with_the_sampling_rate():
    rarer = [wave(60, size)[::5] for size in (2.0, 1.0)]
    few = SimpleNamespace(n=60 * PER_CYCLE // 5, dt=5.0 / PER_CYCLE, pace=2 * np.pi)
    often = gain_of_mismatch([wave(60, 2.0)], [wave(60, 1.0)], [segment(60)])
    assert gain_of_mismatch(rarer[:1], rarer[1:], [few]) == pytest.approx(often)


def test_a_stretch_that_loses_counts_against_those_that_gain():
    before = np.concatenate([wave(6, 2.0), wave(6, 1.0)])
    after = np.concatenate([wave(6, 1.0), wave(6, 2.0)])
    assert gain_of_mismatch([before], [after], [segment(12)]) == pytest.approx(0.0)
    assert gain_of_mismatch([before[: before.size // 2]] * 2, [after[: after.size // 2]] * 2, [segment(6)] * 2) > 13.0
