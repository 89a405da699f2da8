"""What the examples of control promise: the nonlinear model tracks better, one linear about the motion damps better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.control import damping, tracking
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.export.platforms import own_platform
from dashpot.model import Oscillator, Range


@pytest.fixture(scope="module")
def model():
    return replace(Oscillator.from_values(TRUTH, name="stand"), amplitude=Range(1e-4, 9e-3, "m"))


@pytest.fixture(scope="module")
def fmu(model, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("dashpot.export.fmu.further_contents", lambda *_: {})
        patch.setattr("dashpot.export.fmu.documentation", lambda *_: "")
        return export_fmu(model, tmp_path_factory.mktemp("fmu") / "rig.fmu", platforms=(own_platform(),))


@pytest.mark.long
def test_the_nonlinear_prediction_halves_the_error_of_the_best_linear_one(model, fmu, tmp_path):
    worst = []
    for linear in (True, False):
        force = tracking.controller(tracking.predictor(model, tmp_path, linear=linear))
        x = tracking.follow(fmu, force, 0.4)
        error = x - tracking.reference(tracking.SAMPLE * np.arange(x.size))
        worst.append(np.max(np.abs(error[10:])) / tracking.AMPLITUDE)
    assert worst[1] < 0.5 * worst[0] < 0.02


def test_a_regulator_about_the_motion_damps_and_knows_it_better_than_one_at_rest(model, fmu):
    late, unknown = [], []
    for pair in (damping.about_motion(model), damping.at_rest(model)):
        states, known = damping.run(fmu, damping.regulator(*pair), 0.3)
        late.append(np.max(np.abs(states[150:, 0])))
        unknown.append(np.std((known - states)[:, 1]))
    assert late[0] < 0.05 * damping.START
    assert late[1] > 0.2 * damping.START
    assert unknown[0] < 0.1 * unknown[1]
