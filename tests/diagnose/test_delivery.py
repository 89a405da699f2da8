"""A structure of a search as it is delivered, from where the search has left it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.delivery import refitted
from dashpot.identify.problem.structure import Fitted
from dashpot.model import oscillator_with
from dashpot.recording import Recording


@pytest.mark.parametrize("segments", [1, 2])
def test_a_search_with_other_segments_leaves_the_values_alone(segments):
    """Zeros that are taken off after the search may end a quiet recording's motion elsewhere, or leave none of it."""
    omega, rate, fs = 10.0, 0.2, 200.0
    time = np.arange(2000) / fs
    swing = np.sqrt(omega**2 - rate**2)
    response = np.exp(-rate * time) * (np.cos(swing * time) + rate / swing * np.sin(swing * time))
    response += 1e-4 * np.random.default_rng(0).standard_normal(time.size)
    values = {"mass": 1.0, "omega0": 1.01 * omega, "viscous": 2.0 * rate, "cubic": 0.0, "preload": 0.0, "dry": 0.0}
    model = oscillator_with(values, effects=())
    fitted = Fitted(model, np.tile([1.0, 0.0], (segments, 1)), (), 0.0, tuple(values))
    found = refitted(fitted, model, [Recording(name="decay", fs=fs, response=response)]).oscillator
    assert found.omega0.value == pytest.approx(omega, abs=5 * found.omega0.std)
    assert found.omega0.std < 1e-3
