"""Laws told apart by prediction where a simulation is lost; the motion by the linear systems of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.search.by_prediction import by_prediction
from dashpot.identify.fit.from_prediction import keeps_step
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator
from dashpot.model.library import find
from dashpot.recording import Recording
from scipy import signal

FS, MASS, OMEGA, VISCOUS, LAG = 300.0, 0.3, 60.0, 3.0, 0.01
LAWS = [find(name) for name in ("actuator-lag", "quadratic-drag", "softening-stiffness", "sensor-lag")]
ENOUGH = 5.0  # a parameter's cost


def recorded(lag: float) -> Recording:
    """A sweep that comes to the mass with a lag, a third of a radian at resonance."""
    t = np.arange(round(8 * FS)) / FS
    force = 2.0 * np.sin(2 * np.pi * (4.0 + t) * t)
    rig = np.polymul([1.0, VISCOUS, OMEGA**2], [lag, 1.0])
    _, x, _ = signal.lsim(([1.0 / MASS], rig), force, t)
    x = x + 1e-5 * np.random.default_rng(3).standard_normal(t.size)
    return Recording("sweep", FS, x, force, hold="linear")


def lost(lag: float) -> tuple[Fitted, Data]:
    """A linear rig a fifth too slow, which has lost the motion."""
    model = Oscillator.from_values(
        {"mass": MASS, "omega0": 0.8 * OMEGA, "cubic": 0.0, "preload": 0.0, "viscous": VISCOUS, "dry": 0.0}
    )
    data = data_of([recorded(lag)], model)
    fitted = Structure(model, data, ("cubic", "preload", "dry")).fit(most=1)
    assert not keeps_step(data.segments, fitted.residuals)
    return fitted, data


@pytest.fixture(scope="module")
def proposed():
    fitted, data = lost(LAG)
    return fitted, by_prediction(fitted, data, LAWS, ENOUGH)


def test_what_is_missing_predicts_best_and_is_led_to_its_simulation(proposed):
    _, proposals = proposed
    best = max(proposals, key=lambda proposal: proposal.gain)
    values = best.model.values()
    assert best.law == "actuator-lag"
    assert values["actuator-lag.time"] == pytest.approx(LAG, rel=0.02)
    assert values["omega0"] == pytest.approx(OMEGA, rel=1e-3)
    assert values["mass"] == pytest.approx(MASS, rel=0.02)
    assert best.initial is None


def test_the_others_gain_half_as_much_or_are_left(proposed):
    _, proposals = proposed
    best = max(proposal.gain for proposal in proposals)
    assert all(proposal.gain > 0.5 * best for proposal in proposals)
    assert "quadratic-drag" not in {proposal.law for proposal in proposals}


def test_what_the_structure_keeps_is_kept(proposed):
    fitted, proposals = proposed
    assert {"cubic", "preload", "dry"}.isdisjoint(fitted.free)
    for proposal in proposals:
        assert [proposal.model.values()[name] for name in ("cubic", "preload", "dry")] == [0.0] * 3


def test_where_nothing_is_missing_nothing_is_proposed():
    """The linear rig itself, lost as it is, predicts as well as it does with a law more."""
    fitted, data = lost(0.0)
    assert by_prediction(fitted, data, LAWS, ENOUGH) == []
