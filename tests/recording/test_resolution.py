"""The converter's step, and signals that have none."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.signals.hilbert import noise_level
from dashpot.recording.resolution import converter_step

T = np.arange(4000) / 500.0
RANDOM = np.random.default_rng(4)


@pytest.mark.parametrize("step", [1e-6, 0.013])
def test_the_step_of_a_quantised_signal_is_found(step):
    signal = np.round((np.sin(2 * np.pi * 7 * T) + 0.1 * RANDOM.standard_normal(T.size)) / step) * step
    assert converter_step(signal) == pytest.approx(step, rel=1e-6)
    assert converter_step(np.array([float(f"{v:.7g}") for v in signal])) == pytest.approx(step, rel=1e-3)


def test_a_signal_that_is_not_quantised_has_none():
    assert converter_step(np.sin(2 * np.pi * 7 * T) + 0.1 * RANDOM.standard_normal(T.size)) == 0.0
    assert converter_step(np.zeros(50)) == 0.0


def test_a_signal_that_switches_between_few_levels_has_none():
    assert converter_step(np.sign(np.sin(2 * np.pi * 7 * T))) == 0.0
    assert converter_step(RANDOM.choice([-1.0, 0.0, 1.0], 500)) == 0.0


def test_quantised_motion_of_few_steps_is_as_noisy_as_its_steps():
    slow = np.round(8 * np.sin(2 * np.pi * 0.5 * T))
    assert noise_level(slow, 500.0) == pytest.approx(1 / np.sqrt(12), rel=1e-6)


@pytest.mark.parametrize(("across", "found"), [(4, True), (80, False)])
def test_an_encoder_whose_zero_was_set_anew_still_has_its_step(across, found):
    """Two lattices, one 7 hundredths of a step beside the other; where most steps lead across there is no lattice."""
    swing = np.round(40 * np.sin(2 * np.pi * 0.25 * T))
    half = (np.arange(T.size) * across // T.size) % 2
    assert (converter_step(4e-4 * (swing + 0.072 * half)) == pytest.approx(4e-4, rel=1e-3)) is found


def test_steps_that_are_one_but_for_rounding_make_no_lattice():
    """A ramp with a jump of half a step in it, whose steps differ by less than two values that are one level."""
    steps = np.ones(300)
    steps[150] = 1.5
    steps[1::2] += 1e-9 * float(np.sum(steps[1:]))
    assert converter_step(np.cumsum(steps)) == 0.0
