"""The measured motion of what was struck: ringing, and blows that no window sees whole."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.data import data_of
from dashpot.identify.start.measured_motion import Regression
from dashpot.model import Oscillator, Response
from dashpot.recording import Recording
from scipy.signal import lsim, lti


def test_blows_say_nothing_of_the_mass_and_their_ringing_all_else():
    """A window of some cycles hardly sees a blow at its edge: regressed with the others the mass was off by 800."""
    fs, omega, viscous, mass = 3000.0, 2 * np.pi * 20.0, 4.0, 0.5
    t = np.arange(24000) / fs
    force, pulse = np.zeros(t.size), np.sin(np.pi * np.arange(12) / 12)
    for at, size in ((600, 1.0), (6900, 0.7), (12300, 1.3), (18300, 0.9)):
        force[at : at + pulse.size] = size * pulse
    rate, x = (lsim(lti([*top], [1.0, viscous, omega**2]), force / mass, t)[1] for top in ([1.0, 0.0], [1.0]))
    seen = force / mass - viscous * rate - omega**2 * x
    seen = seen + 1e-3 * np.std(seen) * np.random.default_rng(4).standard_normal(t.size)
    force = force + 1e-3 * np.random.default_rng(5).standard_normal(t.size)
    values = {"mass": mass, "omega0": omega, "cubic": 0.0, "preload": 0.0, "viscous": viscous, "dry": 0.0}
    model = Oscillator.from_values(values, response=Response("acceleration", "m/s2"))
    family = Regression(data_of([Recording("hits", fs, seen, force, "acceleration", "m/s2")], model), model).family()
    assert family is not None
    assert family.values["mass"] == mass
    assert family.values["omega0"] == pytest.approx(omega, rel=2e-3)
    assert family.values["viscous"] == pytest.approx(viscous, rel=0.1)
