"""The verdict and its sentence, on values small enough to judge by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.diagnose.result import Effect, RecordFit
from dashpot.diagnose.search.residual_test import Leftover
from dashpot.diagnose.verdict import explained_share, sentence_of, verdict_of
from dashpot.model import Response

NOTHING = np.zeros(2)
DRAG = Effect("quadratic-drag", "quadratic-drag", "dissipation", {})
FRICTION = Effect("stribeck", "stribeck", "dissipation", {})
STOP = Effect("one-sided-stop", "one-sided-stop", "restoring", {}, ("quintic-stiffness", "cubic-stiffness"))


def row(before=0.01, after=0.01, floor=0.01, file="run", holdout=False):
    return RecordFit(file, holdout, before, after, floor, NOTHING, NOTHING, NOTHING, NOTHING, None, Response())


def left(*ratios):
    return [Leftover(f"run {i}", ratio, 0.0, 0.0, None) for i, ratio in enumerate(ratios)]


# --- the verdict


def test_nothing_left_and_every_row_near_its_floor_is_consistent():
    assert verdict_of((), None, [row(), row(0.02)]) == "consistent"


@pytest.mark.parametrize(("times", "verdict"), [(9.9, "consistent"), (10.1, "unexplained"), (2300.0, "unexplained")])
def test_not_where_a_row_is_far_from_its_floor(times, verdict):
    """A residual that is white says nothing where the free simulation is off by ten times the noise."""
    assert verdict_of((), None, [row(), row(times * 0.01, floor=0.01)]) == verdict
    assert verdict_of((), None, [row(), row(times * 0.01, floor=0.01, holdout=True)]) == verdict


def test_not_where_a_row_does_not_simulate():
    assert verdict_of((), None, [row(), row(math.inf)]) == "unexplained"
    assert verdict_of((), None, [row(), row(math.nan)]) == "unexplained"


@pytest.mark.parametrize(
    ("left", "verdict"), [(0.099, "consistent"), (0.101, "unexplained"), (math.nan, "unexplained")]
)
def test_what_leaves_a_hundredth_of_the_power_is_good_enough_and_what_leaves_more_is_not(left, verdict):
    assert verdict_of((), "there remains a little", [row(0.01), row(left, floor=1e-3)]) == verdict


@pytest.mark.parametrize("remainder", [None, "0.7 % of the motion remains"])
def test_what_is_named_is_missing_whatever_remains(remainder):
    assert verdict_of((DRAG,), remainder, [row(5.0)]) == "missing-physics"


def test_where_time_ran_out_nobody_knows_whether_something_is_missing():
    rows = [row(0.035, floor=1e-3)]
    assert verdict_of((), "there remains a little", rows, untried=True) == "unexplained"
    assert verdict_of((), None, [row()], untried=True) == "consistent"
    said = sentence_of("unexplained", (), "there remains a little", rows, left(20.0), left(20.0), untried=True)
    assert said.startswith("Undecided: something is left")
    assert said.endswith("raise --seconds.")
    named = sentence_of("missing-physics", (DRAG,), "a little remains", rows, left(20.0), left(9.0), untried=True)
    assert "drag" in named
    assert named.endswith("raise --seconds.")


# --- the share


@pytest.mark.parametrize(
    ("before", "after", "share"),
    [
        ((3.0,), (1.0,), 1.0),  # 8 of 8
        ((3.0,), (math.sqrt(5.0),), 0.5),  # 4 of 8
        ((3.0, 1.0), (1.0, 3.0), 0.0),  # moved from one to the other
        ((3.0,), (5.0,), 0.0),  # worse is none
        ((3.0,), (0.5,), 1.0),  # below the noise is no more than all of it
        ((3.0, 3.0), (1.0, 3.0), 0.5),
    ],
)
def test_the_share_is_of_the_power_beyond_the_noise(before, after, share):
    assert explained_share(left(*before), left(*after)) == pytest.approx(share)


@pytest.mark.parametrize(
    ("before", "after"), [((1.0, 0.9), (1.0,)), ((math.inf,), (1.0,)), ((2.0,), (math.inf,)), ((), ())]
)
def test_where_there_is_nothing_to_share_there_is_none(before, after):
    assert explained_share(left(*before), left(*after)) is None


# --- the sentence: each stands in tests/sentences.yaml

FREE = Effect("free/modulation", "free/modulation", "inertia", {})
PENDULUM = Effect("softening-stiffness", "softening-stiffness/sine", "restoring", {})
RIVAL = Effect("quadratic-drag", "quadratic-drag", "dissipation", {}, ("cubic-damping",))
HELD_OUT = [
    row(0.5, 0.1, 0.5, file="loud noise", holdout=True),
    row(0.3, 0.1, 0.01, file="worst", holdout=True),
    row(9.0, 0.1, 0.01, file="learnt from"),
]
HALF, WHOLE = (left(3.0), left(math.sqrt(5.0))), (left(3.0), left(1.0))
NOISE, NO_DATA = (left(1.0), left(1.0)), ([], [])


def beside_one_that_rises(falls):
    others = [row(0.1, 0.05 if i < falls else 0.15, 0.01, file=f"{i}", holdout=True) for i in range(2)]
    return [row(0.2, 0.3, 0.01, holdout=True), *others]


SENTENCES = {
    "nothing is missing": ("consistent", (), None, [row()], *NOISE),
    "within 1.1 times the noise": ("consistent", (), None, [row(), row(0.0109, file="worst")], *NOISE),
    "beyond 1.1 times the noise": ("consistent", (), None, [row(), row(0.0111, file="worst")], *NOISE),
    "noise of a colour, with its figures": ("consistent", (), None, [row(), row(0.08, file="worst")], *NOISE),
    "what no law explains": ("unexplained", (), "3 % of the motion remains in a.csv", [row()], left(9.0), left(9.0)),
    "good enough for many uses": (
        "consistent",
        (),
        "there remains a little",
        [row(0.02, file="near"), row(0.024, floor=0.001, file="worst")],
        left(9.0),
        left(9.0),
    ),
    "the farthest beside its noise": (
        "unexplained",
        (),
        None,
        [row(0.02, file="near"), row(0.30, floor=0.01, file="far"), row(0.50, floor=0.1, file="noisy")],
        *NOISE,
    ),
    "nothing to name": ("unexplained", (), None, [], *NO_DATA),
    "two laws, neither of them named": (
        "missing-physics",
        (),
        "1 % remains",
        [row(0.2, 0.02, holdout=True)],
        *HALF,
        {"attached-resonator": 0.93, "softening-stiffness": None},
    ),
    "one named beside one that is not": ("missing-physics", (DRAG,), "1 % remains", [row()], *HALF, {"clearance": 0.5}),
    "one law, not named": ("missing-physics", (), "1 % remains", [row()], *HALF, {"clearance": 0.5}),
    "one that breaks off, first": ("unexplained", (), None, [row(math.nan, file="lost"), row(0.3)], *NOISE),
    "one that breaks off, last": ("unexplained", (), None, [row(0.3), row(math.nan, file="lost")], *NOISE),
    "its share, and what remains": (
        "missing-physics",
        (DRAG,),
        "0.7 % of the motion remains",
        [row(0.2, 0.02, file="a"), row(0.3, 0.03, 0.02, file="b", holdout=True)],
        *HALF,
    ),
    "no share where nothing remains": ("missing-physics", (DRAG,), None, [row()], *WHOLE),
    "two with a rival": ("missing-physics", (DRAG, STOP), "1 % remains", [row()], *HALF),
    "one with two rivals": ("missing-physics", (STOP,), None, [row()], *WHOLE),
    "three, one a variant": ("missing-physics", (DRAG, FRICTION, PENDULUM), None, [row()], *WHOLE),
    "three with rivals": ("missing-physics", (RIVAL, STOP, FRICTION), None, [row()], *WHOLE),
    "two, one with a rival": ("missing-physics", (RIVAL, FRICTION), None, [row()], *WHOLE),
    "without a law": ("missing-physics", (FREE,), None, [], *NO_DATA),
    "the held-out error rises": (
        "missing-physics",
        (DRAG,),
        None,
        [row(0.1, 0.2, 0.1, holdout=True)],
        left(2.0),
        left(1.0),
    ),
    **{
        f"{falls} fall beside one that rises": (
            "missing-physics",
            (DRAG,),
            None,
            beside_one_that_rises(falls),
            left(2.0),
            left(1.0),
        )
        for falls in (0, 1, 2)
    },
    "the worst that was held out": ("missing-physics", (DRAG,), None, HELD_OUT, left(2.0), left(1.0)),
    "held out and did not simulate": (
        "missing-physics",
        (DRAG,),
        None,
        [row(math.inf, 0.1, 0.01, file="lost", holdout=True), *HELD_OUT],
        left(2.0),
        left(1.0),
    ),
    "held out and no longer simulates": (
        "missing-physics",
        (DRAG,),
        None,
        [row(0.9, math.inf, 0.01, file="runs away", holdout=True)],
        left(2.0),
        left(1.0),
    ),
}


@pytest.mark.parametrize("case", SENTENCES)
def test_the_sentence(case, reads):
    said = sentence_of(*SENTENCES[case])
    reads(said)
    assert "nan" not in said
    assert "inf" not in said
