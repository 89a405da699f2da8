"""What a fit leaves, and what the measuring chain did, goes with the model file into every word on the model."""

from __future__ import annotations

from dataclasses import replace

import pytest
from dashpot.model import Provenance
from dashpot.model.file import dumps, loads
from dashpot.model.fit_state import MostLeft, beyond, faults_of_recordings, left_over, state_of_fit
from dashpot.model.show import as_json, describe, warnings

FAULT = "from 2.4 s on the response counts 0.9 ± 0.01 times what it should: its gain was changed; use the parts alone"


def of(rig, *recordings):
    entries = tuple({"file": f"{name}.csv", **more} for name, more in zip("abc", recordings, strict=False))
    return loads(dumps(replace(rig(), identified=Provenance(recordings=entries))))


@pytest.mark.parametrize(("over_noise", "told"), [(1.49, False), (1.51, True)])
def test_a_recording_that_holds_more_than_the_model_is_told_wherever_the_model_goes(rig, over_noise, told):
    o = of(rig, {"nrmse": 0.0123, "over_noise": over_noise})
    said = [sentence for sentence in warnings(o) if "a.csv" in sentence]
    assert len(said) == told == (state_of_fit(o) is not None)
    if told:
        assert said[0].startswith("a.csv: the model leaves 1.51 times the noise, 1.2 % of the motion, so ")
        assert said == [f"{sentence}." for sentence in left_over(o)]
        assert state_of_fit(o) == (
            "the model leaves more than noise of its recording, up to 1.51 times the noise and 1.2 % of the motion, "
            "so the parameters may be off by more than their errors"
        )
    assert left_over(of(rig, {"over_noise": over_noise})) == []


def test_a_fault_of_the_measuring_chain_stays_with_the_model(rig):
    o = of(rig, {"fault": FAULT}, {"nrmse": 0.01, "over_noise": 1.0})
    (sentence,) = faults_of_recordings(o)
    assert sentence == f"a.csv: {FAULT}; until then the parameters may be off by more than their errors"
    assert f"{sentence}." in describe(o)
    data = as_json(o)
    assert data["identified"]["recordings"][0]["fault"] == FAULT
    assert data["state_of_fit"] == state_of_fit(o)
    assert state_of_fit(o).startswith("1 of its 2 recordings bears a fault of the measuring chain, so ")


def test_one_sentence_has_all_and_can_stand_anywhere(rig):
    worst = {"nrmse": 0.123456, "over_noise": 1234567.0, "fault": FAULT}
    sentence = state_of_fit(of(rig, worst, worst, {"nrmse": 0.01, "over_noise": 1.0}))
    assert "of 2 of its 3 recordings, up to 1.2e+06 times the noise and 12 % of the motion, and 2 of its" in sentence
    assert sentence.isascii()
    assert len(sentence) <= 250


def test_of_a_fit_to_the_noise_and_of_given_numbers_nothing_is_said(rig):
    assert state_of_fit(of(rig, {"nrmse": 0.01, "over_noise": 1.0})) is None
    assert state_of_fit(rig()) is None
    assert as_json(rig())["state_of_fit"] is None


@pytest.mark.parametrize(
    ("left", "most", "exceeded"),
    [
        ({"nrmse": 0.051, "over_noise": 9.0}, MostLeft(part=0.05), True),
        ({"nrmse": 0.049, "over_noise": 9.0}, MostLeft(part=0.05), False),
        ({"nrmse": 0.2, "over_noise": 1.51}, MostLeft(part=0.05), True),
        ({"nrmse": 0.2, "over_noise": 1.49}, MostLeft(part=0.05), False),  # a recording that is mostly noise
        ({"nrmse": 0.001, "over_noise": 3.01}, MostLeft(times=3.0), True),
        ({"nrmse": 0.9, "over_noise": 2.99}, MostLeft(times=3.0), False),
        ({"nrmse": 0.9}, MostLeft(part=0.05), False),
    ],
)
def test_how_much_is_too_much_is_for_the_user_to_say(rig, left, most, exceeded):
    said = beyond(of(rig, left, {"nrmse": 0.01, "over_noise": 1.0}), most)
    assert len(said) == exceeded
    assert all(sentence.startswith("a.csv: the model leaves ") for sentence in said)
