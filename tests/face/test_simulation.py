"""A simulated response says where it goes further than what its model was identified in."""

from __future__ import annotations

from dataclasses import replace

from dashpot.examples.truth import TRUTH
from dashpot.face.simulation import simulated
from dashpot.model import Oscillator, Range


def test_a_motion_beyond_what_was_covered_is_said():
    model = replace(Oscillator.from_values(TRUTH, name="stand"), amplitude=Range(1e-4, 5e-3, "m"))
    far = simulated(model, (), (8e-3, 0.0), 1.0, {"fs": 1000.0})
    assert "it swings by" in far.beyond
    assert "identified up to 0.005 m" in repr(far)
    assert simulated(model, (), (4.9e-3, 0.0), 1.0, {"fs": 1000.0}).beyond == ""
