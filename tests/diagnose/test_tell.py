"""A curve that whole recordings speak against is dropped, and what was evaluated without it is delivered."""

from __future__ import annotations

from typing import Any

import pytest
from dashpot.diagnose.search.candidate import Candidate
from dashpot.diagnose.search.found import Found
from dashpot.diagnose.tell import _without_learnt

FIT: Any = object()  # whatever was fitted
NOT_ASKED: Any = None


def found(*laws: str, evaluated: tuple[tuple[str, ...], ...]) -> Found:
    known = {laws: Candidate(laws, FIT, stage="judged") for laws in evaluated}
    best = Candidate(laws, FIT, stage="judged")
    return Found(best, known | {laws: best}, NOT_ASKED)


def test_the_laws_stay_and_the_curve_goes():
    both = found("free/inertia/6", "softening-stiffness", evaluated=(("softening-stiffness",),))
    plainer = _without_learnt(both)
    assert plainer is not None
    assert plainer.selected.laws == ("softening-stiffness",)
    assert "whole recordings are explained worse" in plainer.candidates[both.selected.laws].why


@pytest.mark.parametrize(
    ("laws", "evaluated"),
    [
        (("softening-stiffness", "stribeck"), (("stribeck",),)),  # nothing was learnt
        (("free/inertia/6",), ((),)),  # nothing would stay
        (("free/inertia/6", "stribeck"), ()),  # it was never evaluated
    ],
)
def test_where_nothing_plainer_is_known_there_is_none(laws, evaluated):
    assert _without_learnt(found(*laws, evaluated=evaluated)) is None
