"""Held-out recordings of another rig, by whole fits to motions of the reference integrator."""

from __future__ import annotations

import pytest
from dashpot.diagnose.family import cut_for, family_of, stranger
from dashpot.diagnose.search.residual_test import leftovers
from dashpot.diagnose.search.search import best_of_family
from dashpot.diagnose.search.weigh import judged
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator

MODEL, NOISE = Oscillator.from_values(TRUTH), 2e-6


@pytest.fixture(scope="module")
def told_apart(recorded):
    """``told_apart(omega0=1.02)``: what is said where values of the held-out rig are so many times others."""
    decay = recorded(begin=(8e-3, 0.0), seconds=2.5, noise=NOISE, seed=5, name="decay")
    sweep = recorded(sweep=(1.0, 5.0, 20.0), seconds=8.0, noise=NOISE, seed=6, name="sweep")

    def said(**factors: float) -> str | None:
        values = TRUTH | {name: factor * TRUTH[name] for name, factor in factors.items()}
        held = recorded(values, sweep=(0.6, 5.0, 20.0), seconds=6.0, noise=NOISE, seed=7, name="held out")
        family = family_of(MODEL, [decay, sweep], [held])
        data, holdout = (cut_for(family, group, MODEL) for group in (family.recordings, family.holdout))
        final = best_of_family(family.model, data)
        left = [*leftovers(final, data), *leftovers(judged(final.model, holdout), holdout)]
        return stranger(final, data, holdout, left)

    return said


def test_a_held_out_recording_of_another_rig_is_told(told_apart):
    said = told_apart(omega0=1.02)
    assert said is not None
    assert "held out" in said
    assert "12.92 Hz instead of 12.67 Hz" in said


@pytest.mark.parametrize("factors", [{}, {"omega0": 1.0000001}])
def test_a_held_out_recording_of_the_same_rig_is_not(told_apart, factors):
    assert told_apart(**factors) is None


def test_friction_that_differs_makes_no_other_rig(told_apart):
    """Frequency and mass are what a rig keeps."""
    assert told_apart(viscous=1.3) is None
