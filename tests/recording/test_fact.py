"""Facts of a recording: measured once, kept by what does not change them."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording.fact import changed, fact
from dashpot.recording.oscillation import oscillation_of
from dashpot.recording.recording import Recording

CALLS: list[str] = []


@fact()
def all_of_it(recording: Recording) -> float:
    CALLS.append("all")
    return float(np.sum(recording.response))


@fact("force", "fs")
def of_the_force(recording: Recording) -> float:
    CALLS.append("force")
    return float(np.sum(recording.force))


@fact("response")
def refused(recording: Recording) -> float:
    CALLS.append("refused")
    raise BadInput(f"{recording.name}: does not move")


@pytest.fixture
def recording():
    CALLS.clear()
    return Recording("a", 10.0, np.arange(5.0), np.ones(5))


def test_a_fact_is_measured_when_asked_for_and_never_again(recording):
    assert CALLS == []
    assert [all_of_it(recording), all_of_it(recording)] == [10.0, 10.0]
    assert CALLS == ["all"]


def test_recordings_that_look_alike_have_facts_of_their_own(recording):
    all_of_it(recording)
    all_of_it(Recording("a", 10.0, np.arange(5.0), np.ones(5)))
    assert CALLS == ["all", "all"]


@pytest.mark.parametrize(
    ("changes", "again"),
    [
        ({"hold": "zero"}, []),
        ({"notes": ("a word",)}, []),
        ({"name": "b"}, ["all"]),
        ({"response": np.arange(5.0) - 1.0}, ["all"]),
        ({"force": 2 * np.ones(5)}, ["all", "force"]),
        ({"fs": 20.0}, ["all", "force"]),
    ],
)
def test_what_a_change_does_not_touch_stays_known(recording, changes, again):
    all_of_it(recording), of_the_force(recording)
    CALLS.clear()
    other = changed(recording, **changes)
    assert all_of_it(other) == np.sum(other.response)
    assert of_the_force(other) == np.sum(other.force)
    assert again == CALLS


def test_a_field_that_is_given_as_it_was_is_no_change(recording):
    all_of_it(recording)
    all_of_it(changed(recording, force=recording.force, notes=("checked",)))
    assert CALLS == ["all"]


def test_what_is_replaced_or_cut_knows_nothing_yet(recording):
    all_of_it(recording)
    assert all_of_it(replace(recording, hold="zero")) == 10.0
    assert all_of_it(recording.slice(0, 3)) == 3.0
    assert CALLS == ["all", "all", "all"]


def test_what_cannot_be_measured_says_so_each_time(recording):
    for _ in range(2):
        with pytest.raises(BadInput, match="does not move"):
            refused(recording)


def test_a_recording_travels_with_its_facts(recording):
    all_of_it(recording)
    assert all_of_it(pickle.loads(pickle.dumps(recording))) == 10.0
    assert CALLS == ["all"]


def test_how_a_recording_oscillates_is_a_fact():
    t = np.arange(2000) / 100.0
    recording = Recording("a", 100.0, np.sin(2 * np.pi * 3.0 * t))
    assert oscillation_of(recording).frequency == pytest.approx(3.0)
    assert oscillation_of(recording) is oscillation_of(changed(recording, hold="linear"))


@fact("motion", "fs")
def of_the_motion(recording: Recording) -> float:
    CALLS.append("motion")
    return float(np.ptp(recording.response))


@pytest.mark.parametrize(
    ("changes", "again"),
    [
        ({"response": np.arange(5.0) - 1.0, "same_motion": True}, []),
        ({"response": np.arange(5.0) - 1.0}, ["motion"]),
        ({"response": np.arange(5.0) - 1.0, "fs": 20.0, "same_motion": True}, ["motion"]),
        ({"force": None}, []),
    ],
)
def test_a_zero_of_the_sensor_leaves_the_motion_known(recording, changes, again):
    of_the_motion(recording)
    CALLS.clear()
    of_the_motion(changed(recording, **changes))
    assert again == CALLS
