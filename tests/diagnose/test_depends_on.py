"""On what a missing force depends: roles, the sentence, JSON, for hand-made shares."""

from __future__ import annotations

import pytest
from dashpot.diagnose.depends_on import DependsOn, Share, percent

BOTH = Share("displacement and velocity", 0.81, 0.04, 0.81, 0.04, within=True)


def test_the_sentence_says_what_is_first_what_adds_and_what_adds_nothing():
    shares = (
        BOTH,
        Share("memory", 0.3, 0.02, 0.08, 0.02),
        Share("velocity", 0.6, 0.03, 0.0, 0.0, within=True),
        Share("time", 0.0, 0.01, 0.002, 0.006),
        Share("sensor", 0.1, 0.2, 0.1, 0.2),
    )
    assert DependsOn(shares, 40).sentence == (
        "81 ± 4 % by displacement and velocity together; the motion before adds 8 ± 2 %; time adds nothing (at most "
        "0.2 ± 0.6 %); whether a sensor that is not straight adds anything is not told"
    )


def test_both_coordinates_are_not_said_beside_the_one_that_makes_them_add():
    first = Share("displacement", 0.9, 0.01, 0.9, 0.01, within=True)
    velocity = Share("velocity", 0.1, 0.01, 0.07, 0.01)
    both = Share("displacement and velocity", 0.97, 0.01, 0.071, 0.01)
    assert "together" not in DependsOn((first, both, velocity), 40).sentence
    more = Share("displacement and velocity", 0.99, 0.01, 0.09, 0.01)
    assert "together adds" in DependsOn((first, more, velocity), 40).sentence


def test_a_share_that_is_no_more_than_its_error_is_not_told():
    found = DependsOn((Share("memory", 0.45, 0.35, 0.45, 0.35, within=True), Share("time", 0.0, 0.0, 0.2, 0.01)), 40)
    assert not found.told
    assert found.sentence == "not told by these recordings; the most, 45 ± 35 % by the motion before"
    assert found.as_json()["told"] is False


def test_a_long_list_is_cut():
    kinds = ("time", "velocity", "force", "memory", "constant", "delay")
    shares = tuple(Share(kind, 0.0, 0.01, 0.0, 0.01) for kind in kinds)
    said = DependsOn((BOTH, *shares), 40).sentence
    assert "time, velocity, the recorded force, the motion before and 2 more add nothing (at most 0 ± 1 %)" in said


@pytest.mark.parametrize(
    ("adds", "std", "role"),
    [
        (0.05, 0.01, "adds"),
        (0.05, 0.02, "nothing"),
        (0.005, 0.0, "nothing"),
        (0.08, 0.04, "not-told"),
        (-0.2, 0.1, "nothing"),
    ],
)
def test_what_a_kind_adds_is_held_against_its_error(adds, std, role):
    assert Share("time", 0.0, 0.0, adds, std).role == role


def test_json_has_every_share_with_its_role():
    made = DependsOn((BOTH, Share("time", 0.0, 0.01, 0.002, 0.006)), 17).as_json()
    assert made["first"] == "displacement and velocity"
    assert [share["role"] for share in made["shares"]] == ["first", "nothing"]
    assert made["unexplained"] == {"share": pytest.approx(0.19), "std": 0.04}
    assert made["blocks"] == 17


@pytest.mark.parametrize(
    ("share", "std", "said"),
    [(0.812, 0.04, "81 ± 4 %"), (0.9987, 0.0012, "99.9 ± 0.1 %"), (-0.0001, 0.0, "0.0 ± 0.0 %")],
)
def test_shares_are_said_to_their_errors(share, std, said):
    assert percent(share, std) == said
