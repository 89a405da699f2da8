"""A candidate: its name, what speaks for it, what it leaves, and what is decisive."""

from __future__ import annotations

import numpy as np
from dashpot.diagnose.search.candidate import STAGES, Candidate, key
from dashpot.identify.problem.structure import Fitted
from dashpot.model import Oscillator

MODEL = Oscillator.from_values({"mass": 1.0, "omega0": 1.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.1, "dry": 0.0})


def leaving(*residuals: list[float]) -> Fitted:
    return Fitted(MODEL, np.zeros((len(residuals), 2)), tuple(np.array(r) for r in residuals), 0.0, ())


def test_all_recordings_together_speak_for_it():
    assert Candidate((), evidence=30.0, predictive=-4.0).value == 26.0
    assert Candidate((), evidence=30.0, predictive=0.0, foretold=7.0).value == 30.0  # nothing was held out


def test_what_was_never_weighed_is_worth_nothing():
    unweighed = Candidate(("stribeck",), why="its score promises nothing")
    assert unweighed.value == -np.inf
    assert unweighed.stage == STAGES[0] == "not started"
    assert unweighed.residuals == ()


def test_what_it_leaves_is_told_of_training_and_then_of_what_was_held_out():
    fit, held_out = leaving([1.0, 2.0], [3.0]), leaving([4.0])
    both = Candidate((), fit, held_out).residuals
    assert [residual.tolist() for residual in both] == [[1.0, 2.0], [3.0], [4.0]]
    assert [residual.tolist() for residual in Candidate((), fit).residuals] == [[1.0, 2.0], [3.0]]


def test_the_order_in_which_laws_came_makes_no_other_structure():
    assert key(["stribeck", "clearance"]) == key(("clearance", "stribeck")) == ("clearance", "stribeck")
    assert key([]) == ()


def test_the_furthest_stage_is_the_last():
    assert STAGES.index("not started") < STAGES.index("simulated") < STAGES.index("left") < STAGES.index("judged")
