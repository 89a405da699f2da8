"""Laws beside another whose strength is zero within its error."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose import insignificant_laws as needless
from dashpot.diagnose.insignificant_laws import certainty, of_unknown_size, without_needless
from dashpot.diagnose.search.candidate import Candidate
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.model import oscillator_with

BOTH = ("constant-force", "quadratic-drag")


def model(load_error=None, drag_error=None):
    """One with a load of 0.1 and a drag of 2, and the errors of these."""
    values = TRUTH | {"constant-force.load": 0.1, "quadratic-drag.coefficient": 2.0}
    made = oscillator_with(values, effects=BOTH)
    known = made.parameters()
    errors = {"constant-force.load": load_error, "quadratic-drag.coefficient": drag_error}
    return made.with_parameters({name: replace(known[name], std=error) for name, error in errors.items()})


def test_a_law_is_as_certain_as_the_surest_of_its_strengths():
    assert certainty(model(0.05, 0.01), BOTH) == pytest.approx({"constant-force": 2.0, "quadratic-drag": 200.0})
    assert certainty(model(0.05, None), BOTH)["quadratic-drag"] == math.inf
    assert set(certainty(model(0.05, 0.01), BOTH[:1])) == {"constant-force"}


class Search:
    """Weighs whatever it is given."""

    def __init__(self):
        self.candidates, self.parts = {}, ()

    def weigh(self, laws, fitted):
        return Candidate(laws, fitted, stage="judged")


@pytest.fixture
def selected(monkeypatch):
    """Two laws; without one of them nothing but noise is left as the test says."""
    left = SimpleNamespace(mismatch=set(), unfit=set())
    monkeypatch.setattr(
        needless, "_without", lambda chosen, name, search: None if name in left.unfit else SimpleNamespace(model=name)
    )
    monkeypatch.setattr(needless, "leaves_mismatch", lambda candidate, parts: candidate.fit.model in left.mismatch)
    return Candidate(BOTH, SimpleNamespace(model="both"), stage="judged"), left


@pytest.mark.parametrize(("error", "kept"), [(0.1 / 3.6, BOTH[1:]), (0.1 / 3.8, BOTH)])
def test_a_law_that_its_own_error_does_not_tell_from_none_is_not_named(selected, error, kept):
    """By odds of a thousand: 3.7 standard errors."""
    search = Search()
    chosen = without_needless(selected[0], search, lambda fitted: model(error, 1e-3))
    assert chosen.laws == kept
    assert kept == BOTH or "zero within its error" in search.candidates[BOTH].why


def test_it_stays_where_more_than_noise_is_left_without_it(selected):
    chosen, left = selected
    left.mismatch = {"constant-force"}
    assert without_needless(chosen, Search(), lambda fitted: model(1.0, 1e-3)).laws == BOTH
    left.mismatch, left.unfit = set(), {"constant-force"}
    assert without_needless(chosen, Search(), lambda fitted: model(1.0, 1e-3)).laws == BOTH


def test_of_two_weak_ones_the_weaker_goes_and_the_other_stays_as_the_only_one(selected):
    chosen = without_needless(selected[0], Search(), lambda fitted: model(0.05, 4.0))
    assert chosen.laws == ("constant-force",)


def test_where_none_simulates_finely_all_stay(selected):
    def never(_fitted):
        raise BadInput("nothing simulates")

    assert without_needless(selected[0], Search(), never).laws == BOTH


def test_one_law_alone_is_not_asked(selected):
    alone = replace(selected[0], laws=("quadratic-drag",))
    assert without_needless(alone, Search(), lambda fitted: model(np.inf, np.inf)) is alone


@pytest.mark.parametrize(("error", "told"), [(0.1 / 1.9, True), (0.1 / 2.0, False)])
def test_a_strength_that_its_own_error_leaves_open_is_said_to_be(error, told):
    said = of_unknown_size(model(error, 0.01), BOTH)
    assert [sentence.split(":")[0] for sentence in said] == (["constant-force"] if told else [])
