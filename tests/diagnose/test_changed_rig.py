"""Backbones of two decays lie on one another where the rig is one, whatever its laws."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.changed_rig import changed_rig
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.recording import Recording

FS = 1000.0


def decay(name, begin, factor=1.0, noise=1e-3, seed=0, quantity="displacement"):
    """A decay of the built-in rig from so many metres, its natural frequency times a factor."""
    rig = TRUTH | {"omega0": factor * TRUTH["omega0"]}
    x, v = integrate_pieces(rig, np.zeros((3000, 1)), 1 / FS, begin, 0.0)
    signal = v if quantity == "velocity" else x
    signal = signal + noise * np.max(np.abs(signal)) * np.random.default_rng(seed).standard_normal(signal.size)
    unit = "m/s" if quantity == "velocity" else "m"
    return Recording(name, FS, signal, unit=unit, quantity=quantity)


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_of_one_rig_nothing_is_said(noise, quantity):
    """Its cubic and preload bend the backbone by some ten per cent from the one amplitude to the other."""
    training = [decay("strong", 8e-3, noise=noise, seed=1, quantity=quantity)]
    for seed in range(2, 6):
        assert changed_rig(training, [decay("weak", 4e-3, noise=noise, seed=seed, quantity=quantity)]) is None


@pytest.mark.parametrize(("factor", "told"), [(1.0005, False), (1.01, True), (0.99, True)])
def test_a_rig_that_was_changed_is_told_from_a_thousandth_on(factor, told):
    said = changed_rig([decay("before.csv", 8e-3)], [decay("after.csv", 6e-3, factor, seed=1)])
    assert (said is not None) is told
    if said:
        faster, slower = ("after.csv", "before.csv") if factor > 1 else ("before.csv", "after.csv")
        words = said.split()
        hertz = {name: float(words[words.index(name) + 3]) for name in (faster, slower)}
        assert hertz[faster] / hertz[slower] == pytest.approx(max(factor, 1 / factor), abs=3e-3)


def test_where_the_training_recordings_keep_apart_themselves_nothing_is_said_of_a_change():
    """A frequency that is not the amplitude's alone: a spring that warms, a second mode, a friction that remembers."""
    training = [decay("before", 8e-3), decay("again", 7e-3, 1.01, seed=2)]
    assert changed_rig(training, [decay("after", 6e-3, 1.02, seed=1)]) is None
    assert changed_rig(training[:1], [decay("after", 6e-3, 1.02, seed=1)]) is not None


def test_each_training_recording_must_keep_apart():
    training = [decay("before", 8e-3), decay("again", 7e-3, seed=2)]
    assert changed_rig(training, [decay("after", 6e-3, 1.02, seed=1)]) is not None
    assert changed_rig([*training, decay("short of it", 6e-3, seed=3)], [decay("same", 5e-3, seed=1)]) is None


def test_what_does_not_swing_freely_or_at_other_amplitudes_says_nothing():
    still = Recording("still", FS, 1e-5 * np.random.default_rng(0).standard_normal(3000))
    assert changed_rig([decay("before", 8e-3)], [still]) is None
    assert changed_rig([still], [decay("after", 8e-3)]) is None
    short = decay("loud", 8e-3)
    loud = Recording("loud", FS, short.response[:400])
    assert changed_rig([loud], [decay("weak", 1e-3, 1.05, seed=1)]) is None
