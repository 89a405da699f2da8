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


def test_not_where_something_is_left():
    assert verdict_of((), "0.7 % of the motion remains", [row()]) == "unexplained"


@pytest.mark.parametrize("remainder", [None, "0.7 % of the motion remains"])
def test_what_is_named_is_missing_whatever_remains(remainder):
    assert verdict_of((DRAG,), remainder, [row(5.0)]) == "missing-physics"


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


# --- the sentence


def test_consistent_says_that_nothing_is_missing():
    said = sentence_of("consistent", (), None, [row()], left(1.0), left(1.0))
    assert said == "Nothing is missing: the model reproduces every recording to within its noise."


@pytest.mark.parametrize(("times", "within"), [(1.09, True), (1.11, False), (8.0, False)])
def test_it_is_bound_to_its_own_table(times, within):
    """Noise of a colour leaves more than the highest frequencies show: that is said with its figures."""
    rows = [row(), row(0.01 * times, file="worst")]
    said = sentence_of("consistent", (), None, rows, left(1.0), left(1.0))
    assert ("to within its noise" in said) is within
    if times == 8.0:
        assert "left in worst, 8 times the noise of its highest frequencies and 8 % of the motion" in said


def test_unexplained_says_what_is_left():
    said = sentence_of("unexplained", (), "3 % of the motion remains in a.csv", [row()], left(9.0), left(9.0))
    assert "no effect of the library explains" in said
    assert "3 % of the motion remains in a.csv" in said


def test_unexplained_with_nothing_left_names_the_recording_whose_simulation_is_farthest():
    rows = [row(0.02, file="near"), row(0.30, floor=0.01, file="far"), row(0.50, floor=0.1, file="noisy")]
    said = sentence_of("unexplained", (), None, rows, left(1.0), left(1.0))
    assert "a free simulation of far is off by 30 % of the motion" in said
    assert sentence_of("unexplained", (), None, [], [], []).count("see the notes") == 1


@pytest.mark.parametrize("rows", [[row(math.nan, file="lost"), row(0.3)], [row(0.3), row(math.nan, file="lost")]])
def test_a_simulation_that_breaks_off_is_worst_and_no_figure_is_made_of_it(rows):
    said = sentence_of("unexplained", (), None, rows, left(1.0), left(1.0))
    assert "a free simulation of lost does not come to its end" in said
    assert "nan" not in said


def test_an_effect_is_named_and_what_it_takes_of_the_lack():
    rows = [row(0.2, 0.02, file="a"), row(0.3, 0.03, 0.02, file="b", holdout=True)]
    said = sentence_of("missing-physics", (DRAG,), "0.7 % of the motion remains", rows, left(3.0), left(math.sqrt(5.0)))
    assert "It takes 50 % of what the model lacked" in said
    assert "the held-out error falls from 30 to 3 % of the motion in b (noise 2 %)" in said
    assert said.endswith("0.7 % of the motion remains.")
    assert said.startswith("Missing: ")


def test_where_nothing_remains_no_share_is_told():
    said = sentence_of("missing-physics", (DRAG,), None, [row()], left(3.0), left(1.0))
    assert "of what the model lacked" not in said
    assert "held-out" not in said


def test_two_effects_take_together_and_rivals_stand_beside_theirs():
    said = sentence_of("missing-physics", (DRAG, STOP), "1 % remains", [row()], left(3.0), left(math.sqrt(5.0)))
    assert "They take 50 % of what the model lacked" in said
    for name in ("quadratic-drag", "one-sided-stop", "quintic-stiffness", "cubic-stiffness"):
        assert name in said
    assert said.index("one-sided-stop") < said.index("quintic-stiffness")


def test_effects_and_rivals_are_said_in_the_words_of_the_field():
    said = sentence_of("missing-physics", (STOP,), None, [row()], left(3.0), left(1.0))
    assert said == (
        "Missing: a stop on one side (one-sided-stop), or else a spring whose stiffness changes with the fourth power "
        "of the displacement (quintic-stiffness) or a spring whose stiffness changes with the square of the "
        "displacement (cubic-stiffness)."
    )
    variant = Effect("softening-stiffness", "softening-stiffness/sine", "restoring", {})
    said = sentence_of("missing-physics", (DRAG, FRICTION, variant), None, [row()], left(3.0), left(1.0))
    assert said == (
        "Missing: drag that grows with the square of the speed (quadratic-drag), friction that is larger at rest and "
        "falls with speed (stribeck) and a part of the spring that bends over as gravity on a pendulum does "
        "(softening-stiffness/sine)."
    )


def test_three_effects_with_their_rivals_can_still_be_read():
    """Which rival is whose is told by semicolons, and what is named beside it bears its name alone."""
    rival = Effect("quadratic-drag", "quadratic-drag", "dissipation", {}, ("cubic-damping",))
    said = sentence_of("missing-physics", (rival, STOP, FRICTION), None, [row()], left(3.0), left(1.0))
    assert said == (
        "Missing: drag that grows with the square of the speed (quadratic-drag), or else cubic-damping; a stop on one "
        "side (one-sided-stop), or else quintic-stiffness or cubic-stiffness; and friction that is larger at rest and "
        "falls with speed (stribeck)."
    )
    few = sentence_of("missing-physics", (rival, FRICTION), None, [row()], left(3.0), left(1.0))
    assert "or else damping that grows with the cube of the speed (cubic-damping); and friction" in few


def test_an_effect_without_a_law_is_said_by_its_name():
    free = Effect("free/inertia", "free/inertia", "inertia", {})
    assert sentence_of("missing-physics", (free,), None, [], [], []) == "Missing: free/inertia."


def test_a_held_out_error_that_rises_is_said_to():
    said = sentence_of("missing-physics", (DRAG,), None, [row(0.1, 0.2, 0.1, holdout=True)], left(2.0), left(1.0))
    assert "The held-out error rises from 10 to 20 %" in said
    assert said.endswith("(noise 10 %).")


@pytest.mark.parametrize("falls", [0, 1, 2])
def test_beside_one_that_rises_those_that_fall_are_counted(falls):
    rows = [row(0.2, 0.3, 0.01, holdout=True)]
    rows += [row(0.1, 0.05 if i < falls else 0.15, 0.01, file=f"{i}", holdout=True) for i in range(2)]
    said = sentence_of("missing-physics", (DRAG,), None, rows, left(2.0), left(1.0))
    assert "The held-out error rises from 20 to 30 %" in said
    assert (f"and falls in {falls} of the 2 others" in said) == bool(falls)


def test_of_the_held_out_the_one_that_the_family_told_worst():
    rows = [
        row(0.5, 0.1, 0.5, file="loud noise", holdout=True),
        row(0.3, 0.1, 0.01, file="worst", holdout=True),
        row(9.0, 0.1, 0.01, file="learnt from"),
    ]
    said = sentence_of("missing-physics", (DRAG,), None, rows, left(2.0), left(1.0))
    assert "in worst" in said
    lost = [row(math.inf, 0.1, 0.01, file="lost", holdout=True), *rows]
    said = sentence_of("missing-physics", (DRAG,), None, lost, left(2.0), left(1.0))
    assert "falls from where nothing simulates to 10 % of the motion in lost" in said
    # one that the mended model does not simulate has no error to tell
    worse = [row(0.9, math.inf, 0.01, file="runs away", holdout=True)]
    assert "runs away" not in sentence_of("missing-physics", (DRAG,), None, worse, left(2.0), left(1.0))
