"""Dry friction below zero, by how much, and what an identification says then."""

from __future__ import annotations

from dataclasses import replace

import pytest
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify


@pytest.fixture(scope="module")
def identification():
    return identify([recording_of(TRUTH, begin=(9e-3, 0.0), seconds=4.0, noise=2e-6, name="decay")])


@pytest.mark.parametrize(("times", "told"), [(-2.0, False), (-4.0, True), (4.0, False)])
def test_by_more_than_its_error_it_says_that_the_parameters_may_be_off(identification, times, told):
    """With it the model would never come to rest."""
    oscillator = identification.oscillator
    dry = replace(oscillator.dry, value=times * oscillator.dry.std)
    fit = replace(identification.fit, oscillator=oscillator.with_parameters({"dry": dry}))
    unexplained = replace(identification, fit=fit).unexplained
    assert (unexplained is not None and "would give energy" in unexplained) is told
