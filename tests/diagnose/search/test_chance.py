"""What a random smooth force takes away of what a model leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search import chance
from dashpot.diagnose.search.chance import by_chance
from dashpot.diagnose.search.weigh import forget
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording
from dashpot.simulate.core import Core

VALUES = {"mass": 1.0, "omega0": 20.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.4, "dry": 0.0}
N, DT = 3000, 0.005


@pytest.fixture(autouse=True)
def forgotten():
    yield
    forget()
    chance._drawn.cache_clear()


def decay(**changed: float) -> np.ndarray:
    model = Oscillator.from_values(VALUES | changed)
    return Core(model).record(np.array(list(model.values().values())), np.array([1e-3, 0.0]), None, N, DT, DT)


def left_by_a_linear_rig(response: np.ndarray) -> tuple[Fitted, Data]:
    """A linear rig with the right values, along a decay of another one; its frequency and damping are fitted."""
    response = response + 1e-8 * np.random.default_rng(3).normal(size=N)
    recording = Recording("decay.csv", 1.0 / DT, response)
    model = Oscillator.from_values(VALUES)
    data = data_of([recording], model)
    fixed = [name for name in model.parameters() if name not in ("omega0", "viscous")]
    return Structure(model, data, fixed).fit(), data


def test_of_what_a_cubic_spring_leaves_chance_takes_much_and_of_noise_nothing():
    """All that bends a spring alike over the amplitudes of a decay takes the same away, up to its sign."""
    fitted, data = left_by_a_linear_rig(decay(cubic=1e6))
    smooth = by_chance(fitted, data, 1)
    noise = np.random.default_rng(1).normal(size=len(fitted.residuals[0])) * np.std(fitted.residuals[0])
    rough = by_chance(replace(fitted, residuals=(noise,)), data, 1)
    assert 0.2 < smooth <= 0.99
    assert rough < 0.01


def test_it_is_a_share_whatever_the_units():
    fitted, data = left_by_a_linear_rig(decay(cubic=1e6))
    larger = replace(fitted, residuals=tuple(3.0 * r for r in fitted.residuals))
    assert by_chance(larger, data, 2) == pytest.approx(by_chance(fitted, data, 2), rel=1e-6)


def test_several_forces_together_take_more_and_of_noise_next_to_nothing():
    """Of n samples of noise each takes a share that is chi-squared with one degree of freedom, over n."""
    fitted, data = left_by_a_linear_rig(decay(cubic=1e6))
    shares = [by_chance(fitted, data, count) for count in (1, 2, 4)]
    assert shares == sorted(shares)
    noise = np.random.default_rng(1).normal(size=len(fitted.residuals[0])) * np.std(fitted.residuals[0])
    rough = by_chance(replace(fitted, residuals=(noise,)), data, 4)
    assert rough < 4 * 3.84 / noise.size
