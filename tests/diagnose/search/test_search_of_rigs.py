"""The search from structure to structure on virtual rigs: what it names in the end, by simulation and in minutes."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.search.search import Search, best_of_family
from dashpot.identify.problem.data import data_of
from dashpot.model.library import find

pytestmark = pytest.mark.long


def searched(case, *laws: str) -> tuple[Search, tuple[str, ...]]:
    """The search over a few laws of the library, and what it ended with."""
    data, holdout = data_of(case.training, case.model), data_of(case.holdout, case.model)
    search = Search(data, holdout, [find(law) for law in laws])
    return search, search.from_family(best_of_family(case.model, data)).laws


def test_nothing_is_added_where_nothing_is_missing(rig):
    search, laws = searched(rig("none"), "quadratic-drag", "constant-force", "clearance", "stribeck")
    assert laws == ()
    others = [candidate for laws, candidate in search.candidates.items() if laws]
    assert {law for candidate in others for law in candidate.laws} == {
        "quadratic-drag",
        "constant-force",
        "clearance",
        "stribeck",
    }
    assert all(candidate.why or candidate.stage == "judged" for candidate in others)


def test_the_law_that_is_missing_leads_and_the_family_is_tried_again(rig):
    search, laws = searched(rig("single", "clearance"), "clearance", "quintic-stiffness", "softening-stiffness")
    assert laws == ("clearance",)
    best, family = search.candidates[laws], search.candidates[()]
    assert best.value > family.value + 100.0
    assert best.predictive > family.predictive
    assert best.fit is not None
    assert max(np.sqrt(np.mean(r**2)) for r in best.fit.residuals) < 0.5 * max(
        np.sqrt(np.mean(r**2)) for r in (family.fit.residuals if family.fit else ())
    )


def test_a_relative_leads_only_while_nothing_better_is_there(rig):
    case = rig("single", "clearance")
    data, holdout = data_of(case.training, case.model), data_of(case.holdout, case.model)
    search = Search(data, holdout, [find("quintic-stiffness")])
    first = search.from_family(best_of_family(case.model, data))
    search.laws = [find("quintic-stiffness"), find("clearance")]
    assert first.laws == ("quintic-stiffness",)  # taken while nothing better was there
    again = search.from_family(best_of_family(case.model, data))
    assert again.laws == ("clearance",)


@pytest.mark.parametrize("without", [True, False])
def test_where_nothing_could_be_held_out_training_counts_once(rig, without):
    case = rig("single", "clearance")
    data, holdout = data_of(case.training, case.model), data_of(case.holdout, case.model)
    search = Search(data, None if without else holdout, [find("clearance")])
    selected = search.from_family(best_of_family(case.model, data))
    assert selected.laws == ("clearance",)
    assert (selected.predictive == 0.0) is without
    assert selected.value == selected.evidence + selected.predictive
