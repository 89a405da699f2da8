"""A load cell's zero and a negative preload imitate a sensor off zero: which valley the answer lies in."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify import identify
from dashpot.recording.recording import Recording

RIG = {"mass": 0.127, "omega0": 98.4, "cubic": 0.0, "preload": 0.31, "viscous": 41.4, "dry": 0.0}


@pytest.mark.parametrize("seed", [2, 4])
def test_a_preload_under_a_force_of_two_levels_is_not_two_wells(seed):
    """From one side the search ends at a negative preload, 20 in log-likelihood below: eight to fourteen errors off."""
    random, fs, n = np.random.default_rng(seed), 780.0, 3000
    edges = np.cumsum(random.uniform(0.4, 1.6, 400) * 25).astype(int)
    lengths = np.diff([0, *edges[edges < n], n])
    force = 6.0 * np.repeat(random.choice([-1.0, 1.0], lengths.size), lengths)
    x = integrate_pieces(RIG, force[:, None], 1 / fs, 0.0, 0.0)[0][:n]
    shown = x + 0.012 + 1e-4 * random.standard_normal(n)
    found = identify([Recording("levels", fs, shown, force + 5e-3 * random.standard_normal(n))])
    for name, p in found.oscillator.parameters().items():
        assert p.std is not None
        assert abs(p.value - RIG[name]) < 3.5 * p.std, name
