"""A model run along a recording begins where the motion does, whatever the sensor shows at zero."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify.replay import replayed
from dashpot.model import Oscillator
from dashpot.recording import Recording

SOFT = {"mass": 5.0, "omega0": 5.5, "cubic": -90.0, "preload": 0.0, "viscous": 0.5, "dry": 0.02}
DT = 0.01


def driven(load):
    """Driven about the angle that a constant part of the force holds it at."""
    t = DT * np.arange(2000)
    force = 1.5 * np.sin(2 * np.pi * 0.8 * t) + load
    begin = load / (5.0 * 5.5**2) - 0.02, -0.15
    return force, integrate_pieces(SOFT, force[:-1, None], DT, *begin)[0], begin


@pytest.mark.parametrize("offset", [0.0, 1.4, -1.4])
@pytest.mark.parametrize("load", [0.0, 20.0])
def test_an_offset_far_beyond_the_motion_is_no_place_to_start_from(offset, load):
    """At 1.4 the softening spring pushes away: a simulation from there does not come back."""
    force, moved, begin = driven(load)
    recording = Recording("lab", 1 / DT, moved + offset, force, unit="rad", hold="zero")
    simulated, initial, shown = replayed(Oscillator.from_values(SOFT), recording)
    assert np.sqrt(np.mean((simulated - recording.response) ** 2)) < 1e-3 * np.std(moved)
    assert shown == pytest.approx(offset, abs=1e-4)
    assert initial[:2] == pytest.approx(begin, abs=1e-3)
