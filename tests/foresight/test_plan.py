"""Plans: within the limits, as good as they say by simulation and identification, and honest where nothing tells."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.foresight.plan import Bounds, plan
from dashpot.foresight.virtual import Noise, simulated
from dashpot.model import Oscillator

MODEL = Oscillator.from_values(TRUTH, name="stand")
NOISE = Noise(2e-6, 2e-3)


@pytest.fixture(scope="module")
def found():
    return plan(MODEL, ["cubic 8%"], Bounds(5e-3, force=0.5, tests=("sweep",)), NOISE, tries=1)


def test_it_reaches_what_is_wanted_when_it_is_identified(found):
    assert found.tells
    assert found.expected[0] <= 0.08 * TRUTH["cubic"]
    (trial,) = found.trials
    assert trial.reached
    assert trial.stated[0] == pytest.approx(found.expected[0], rel=0.35)
    assert trial.off[0] < 4 * trial.stated[0]
    assert found.passed


def test_it_keeps_to_stroke_and_force(found):
    assert found.excitation.kind == "sweep"
    assert found.excitation.level <= 0.5
    assert np.max(np.abs(found.signal)) <= 0.5
    moved = simulated(MODEL, found.excitation, found.fs)
    assert np.max(np.abs(moved)) <= 5e-3 * (1 + 1e-6)
    assert np.max(np.abs(moved)) == pytest.approx(found.peak, rel=0.01)


def test_it_says_so_and_gives_the_force(found):
    assert "cubic" in repr(found)
    data = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert data["excitation"]["kind"] == found.excitation.kind
    assert data["reached"] == 1
    lines = found.csv().splitlines()
    assert lines[0] == "time_s,force_N"
    assert len(lines) == found.signal.size + 1


def test_less_error_takes_more_releases():
    often, once = (
        plan(MODEL, [f"cubic {share}%"], Bounds(3e-3, tests=("decay",)), NOISE, tries=0) for share in (8, 40)
    )
    assert once.excitation.repeats == 1
    assert often.excitation.repeats >= 4
    assert often.tells
    assert once.tells
    assert often.signal is None
    with pytest.raises(BadInput, match="plays no force"):
        often.csv()


def test_what_cannot_be_told_is_said():
    small = plan(MODEL, ["cubic 0.1%"], Bounds(2e-4, seconds=20.0, tests=("sweep",)), NOISE, tries=0)
    assert not small.tells
    assert not small.passed
    assert "No test within the limits tells what is wanted" in repr(small)


def test_a_rig_without_a_mass_can_only_be_released():
    free = Oscillator.from_values({**TRUTH, "mass": None}, name="free")
    assert plan(free, ["dry 5%"], Bounds(3e-3), NOISE, tries=0).excitation.kind == "decay"
    with pytest.raises(BadInput, match="no test within the limits"):
        plan(free, ["dry 5%"], Bounds(3e-3, tests=("sweep",)), NOISE, tries=0)
