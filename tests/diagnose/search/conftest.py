"""A rig with nothing missing, for the search to be let loose on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.recording import Recording

RIG = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0, "viscous": 1.0}


@pytest.fixture(scope="module")
def plain():
    """Data of a linear rig with nothing missing, let go at two places, and its model."""
    time = np.arange(2000) / 500.0
    pace = np.sqrt(RIG["omega0"] ** 2 - 0.25 * RIG["viscous"] ** 2)
    wave = np.exp(-0.5 * RIG["viscous"] * time) * np.cos(pace * time)
    noise = 1e-5 * np.random.default_rng(0).standard_normal((2, time.size))
    decays = [Recording(f"decay {i}", 500.0, size * wave + noise[i]) for i, size in enumerate((8e-3, 5e-3))]
    model = Oscillator.from_values(RIG)
    return data_of(decays, model), model


@pytest.fixture(scope="session")
def bent():
    """``bent(model, **factors)``: the model with some values multiplied."""

    def multiplied(model, **factors: float):
        known = model.parameters()
        return model.with_parameters(
            {name: replace(known[name], value=known[name].value * factor) for name, factor in factors.items()}
        )

    return multiplied
