"""A rig proved on: coverage counted as binomial chance has it, and recordings by either integrator alike."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.foresight import independent
from dashpot.foresight.excitation import Excitation
from dashpot.foresight.proof import prove, usual_tests
from dashpot.foresight.virtual import Noise, simulated
from dashpot.model import Oscillator
from dashpot.model.terms import with_term

MODEL = Oscillator.from_values(TRUTH, name="stand")
FREE = Oscillator.from_values({**TRUTH, "mass": None}, name="free")
RELEASE = Excitation("decay", 5e-3, 1.0, (12.7, 12.7), 3.0)


@pytest.mark.parametrize("played", [RELEASE, Excitation("sweep", 0.5, 1.0, (8.0, 18.0), 3.0)])
@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_both_integrators_make_the_same_recording(played, quantity):
    unit = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}[quantity]
    model = replace(MODEL, response=replace(MODEL.response, quantity=quantity, unit=unit))
    one, other = simulated(model, played, 800.0), independent()[1](model, played, 800.0)
    away = np.abs(one - other)
    # beside a jump of the acceleration the two may stand on either side of it
    assert np.quantile(away, 0.99) < 2e-5 * np.max(np.abs(one))


@pytest.fixture(scope="module")
def proof():
    return prove(FREE, [RELEASE], Noise(5e-6), fs=600.0, runs=5, integrator=independent())


def test_errors_that_hold_pass(proof):
    assert proof.passed, proof
    assert [c.name for c in proof.parameters] == ["omega0", "cubic", "preload", "viscous", "dry"]
    assert all(c.runs + c.left_out == 5 for c in proof.parameters)
    assert "The errors hold." in repr(proof)
    assert json.loads(json.dumps(proof.as_json(), allow_nan=False))["passed"] is True


def test_errors_that_do_not_hold_are_named():
    """A rig whose recordings are of a rig that is a little another: the errors are of noise alone."""
    other = replace(FREE, viscous=replace(FREE.viscous, value=1.02 * FREE.viscous.value))
    wrong = prove(
        FREE,
        [RELEASE],
        Noise(5e-6),
        fs=600.0,
        runs=4,
        integrator=("another rig", lambda _model, played, fs: simulated(other, played, fs)),
    )
    assert not wrong.passed
    assert any("errors of viscous do not hold: 0 of 4" in doubt for doubt in wrong.doubts)
    viscous = next(c for c in wrong.parameters if c.name == "viscous")
    assert viscous.within == (0.0, 0.0, 0.0)
    assert viscous.mean > 3


def test_what_is_hidden_is_to_be_named():
    rig = with_term(FREE, "quadratic-drag", {"coefficient": 30.0})
    how = {"fs": 600.0, "runs": 1, "hidden": "quadratic-drag"}
    right = prove(rig, [RELEASE], Noise(5e-6), diagnosing=lambda _model, _given: ["quadratic-drag"], **how)
    assert right.passed
    assert right.named == (("quadratic-drag",),)
    assert right.parameters == ()
    wrong = prove(rig, [RELEASE], Noise(5e-6), diagnosing=lambda _model, _given: ["dead-zone"], **how)
    assert wrong.doubts == ("quadratic-drag was named in 0 of 1 runs; named were dead-zone",)
    with pytest.raises(BadInput, match="no law 'stops' in it to hide"):
        prove(rig, [RELEASE], Noise(5e-6), fs=600.0, hidden="stops")


def test_the_usual_tests_keep_to_the_amplitude():
    (release, sweep), fs = usual_tests(MODEL, 4e-3, force=True)
    assert release.level == 4e-3
    moved = simulated(MODEL, sweep, fs)
    assert 2e-3 < np.max(np.abs(moved)) <= 4e-3
    assert len(usual_tests(FREE, 4e-3, force=False)[0]) == 1


def test_so_few_by_chance_is_binomial():
    from dashpot.foresight.proof import by_chance

    assert by_chance(0, 4, 0.5) == pytest.approx(1 / 16)
    assert by_chance(4, 4, 0.3) == pytest.approx(1.0)
    assert by_chance(1, 3, 0.68) == pytest.approx(0.32**3 + 3 * 0.68 * 0.32**2)
    assert math.isclose(by_chance(2, 3, 0.2), 1 - 0.2**3)
