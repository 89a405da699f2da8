"""What a model leaves over, in words: how much of what, the worst first, and by which of its fits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.residual_test import Leftover, nearer, sentence
from dashpot.model.fit_state import Left


def left(ratio, *, motion=0.0, step=0.0, burst=None, short=False, file="run"):
    return Leftover(file, ratio, motion, step, burst, short)


def test_each_recording_is_told_once_the_worst_first():
    said = sentence(
        [
            left(3.0, motion=0.5, file="a"),
            left(7.0, step=0.4, file="b"),
            left(9.0, motion=0.5, step=0.4, file="a"),
            left(99.0, file="noise of another colour"),
            left(2.0, burst=12.34567, file="c"),
        ]
    )
    assert said == (
        "there remains 9.00 times the noise in a, growing with the motion; "
        "7.00 times the noise in b, in step with the motion; 2.00 times the noise in c, in a burst at 12.35 s"
    )


def test_what_is_left_is_told_as_a_part_of_the_motion_first():
    """An engineer asks how large it is before how many times the noise that is."""
    assert sentence([replace(left(12.0, step=0.4), part=0.00712, order=3)]) == (
        "there remains 0.71 % of the motion (12 times the noise) in run, in step with the motion, most at 3 times its "
        "frequency"
    )
    assert "frequency" not in str(sentence([replace(left(12.0, step=0.4), part=0.007, order=1)]))


def test_of_several_stretches_of_a_recording_the_worst_is_told_with_its_time():
    """What is left there is no figure of the whole recording, which may be told far better."""
    several = [
        replace(left(3.0, step=0.4), part=0.004, span=(0.0, 8.0)),
        replace(left(9.0, step=0.4), part=0.025, span=(8.0, 8.51234)),
        replace(left(2.0, step=0.4, file="other"), part=0.01, span=(0.0, 8.0)),
    ]
    assert sentence(several) == (
        "there remains 2.5 % of the motion (9.00 times the noise) in run, where it is worst, 8 to 8.512 s, in step "
        "with the motion; 1 % of the motion (2.00 times the noise) in other, in step with the motion"
    )


def test_of_a_recording_in_one_stretch_the_figures_are_those_of_the_table():
    """The search's own fit may have left a little more or less than what is delivered."""
    one = [replace(left(9.0, step=0.4), part=0.025, span=(0.0, 8.0))]
    assert "2.4 % of the motion (8.50 times the noise) in run, in step" in str(sentence(one, table(0.024, 8.5)))
    several = [*one, replace(left(2.0, step=0.4), part=0.004, span=(8.0, 9.0))]
    for stretches, times in ((several, 8.5), (one, 1.05)):  # what is no more than noise does not remain
        said = str(sentence(stretches, table(0.024, times)))
        assert "2.5 % of the motion (9.00 times the noise) in run, where it is worst, 0 to 8 s" in said


def table(part, times):
    return {"run": Left("run", part, times)}


def test_more_than_three_recordings_are_counted():
    four = [left(2.0 + k, motion=0.5, file=f"run{k}") for k in range(4)]
    assert str(sentence(four)).endswith("in run1, growing with the motion, and more in 1 further recording")
    assert "further" not in str(sentence(four[:3]))
    assert sentence([left(12.0, short=True)]) == "there remains 12 times the noise in run"


def test_what_rings_is_told_where_nothing_surer_is():
    assert str(sentence([replace(left(3.0), resonant=0.2)])).endswith("in run, around the rig's own frequency")
    assert str(sentence([replace(left(3.0, step=0.4), resonant=0.2)])).endswith("in run, in step with the motion")


@pytest.mark.parametrize(
    ("first", "second", "nearer_is"),
    [
        ((2.0, 3.0), (2.0, 2.9), 1),
        ((2.0, 3.0), (3.0, 2.0), 0),
        ((1.0, np.inf), (50.0, 50.0), 1),
        ((9.0,), (np.nan,), 0),
    ],
)
def test_of_two_fits_of_one_structure_the_nearer_is_told(first, second, nearer_is):
    both = [[left(ratio) for ratio in ratios] for ratios in (first, second)]
    assert nearer(*both) is both[nearer_is]
