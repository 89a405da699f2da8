"""The way of a search from leader to leader, and that it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from dashpot.diagnose.search.candidate import Candidate
from dashpot.diagnose.search.found import Found
from dashpot.diagnose.search.search import Search


@pytest.fixture
def led(monkeypatch):
    """``led(table)``: two ways of asking, and who leads after each; gives the last leader and all that was asked.

    ``again``: what an earlier search ended with, who leads once its structures are entered again, and whether the
    recordings that are fitted to are the same.
    """

    def follow(
        table: dict[tuple[tuple[str, ...], str], Candidate], again: tuple[Candidate, Candidate, bool] | None = None
    ) -> tuple[Candidate, list]:
        asked = []

        def ways(_search, _leader):
            return [lambda best, way=way: asked.append((best.laws, way)) or [way] for way in ("first", "second")]

        def weigh(_search, laws, fitted):
            return Candidate(laws, fitted, None, 0.0, 0.0, 0.0, "judged")

        monkeypatch.setattr(Search, "_compare_by", lambda self, front: None)
        monkeypatch.setattr(Search, "_simulated", lambda self, leader: leader)
        monkeypatch.setattr(Search, "_ways", ways)
        monkeypatch.setattr(Search, "weigh", weigh)
        monkeypatch.setattr(Search, "_now", lambda self, candidate: candidate.value)
        monkeypatch.setattr(Search, "_best_of_neighbours", lambda self, best, way: table.get((best.laws, way[0]), best))
        family: Any = None  # nothing is fitted here, nor weighed
        search = Search(family, None)
        if again is not None:
            search.before = Found(again[0], {}, search.weighing)
            monkeypatch.setattr(Search, "_entered_again", lambda self, leader, before: again[1])
            monkeypatch.setattr(Search, "_same_data", again[2])
        return search.from_family(family), asked

    return follow


def worth(value: float, *laws: str) -> Candidate:
    return Candidate(laws, None, None, value, 0.0, 0.0, "judged")


def test_every_way_is_asked_of_the_last_leader(led):
    last, asked = led({((), "second"): worth(100.0, "drag")})
    assert last.laws == ("drag",)
    assert asked == [((), "first"), ((), "second"), (("drag",), "first"), (("drag",), "second")]


def test_another_leader_is_asked_from_the_first_way_on(led):
    _, asked = led({((), "first"): worth(100.0, "drag")})
    assert asked == [((), "first"), (("drag",), "first"), (("drag",), "second")]


@pytest.mark.parametrize(("again", "ends"), [(6.9 - 0.1, ()), (6.9 + 0.1, ("drag",))])
def test_a_structure_leads_again_only_where_it_came_decisively_farther(led, again, ends):
    """Odds of a thousand are 6.9."""
    last, asked = led({((), "first"): worth(100.0, "drag"), (("drag",), "first"): worth(again)})
    assert last.laws == ends
    assert asked == [((), "first"), (("drag",), "first"), ((), "first")][: 2 + bool(ends)]


@pytest.mark.parametrize(("foretold", "ends"), [(0.1, ("cubic-damping", "quadratic-drag")), (-0.1, ())])
def test_where_no_law_leads_the_search_goes_on_from_the_one_that_the_training_speaks_for(
    led, monkeypatch, foretold, ends
):
    """What it ends with has to tell what was held out better than the family does."""
    alone = replace(worth(50.0, "quadratic-drag"), foretold=-9.0)
    both = replace(worth(100.0, "cubic-damping", "quadratic-drag"), foretold=foretold)
    module = "dashpot.diagnose.search.search"
    monkeypatch.setattr(f"{module}.first_of_several", lambda given, known, parts: alone)
    monkeypatch.setattr(f"{module}.accepted", lambda candidate, leader, parts: candidate.foretold > leader.foretold)
    last, asked = led({(("quadratic-drag",), "second"): both})
    assert last.laws == ends
    assert [laws for laws, _ in asked] == [(), (), *[alone.laws] * 2, *[both.laws] * 2]


def test_where_a_law_leads_no_other_begins(led, monkeypatch):
    monkeypatch.setattr("dashpot.diagnose.search.search.first_of_several", lambda *_: pytest.fail("asked"))
    assert led({((), "second"): worth(100.0, "drag")})[0].laws == ("drag",)


@pytest.mark.parametrize(("leads", "same", "ways"), [("drag", True, 0), ("drag", False, 2), ("stop", True, 2)])
def test_a_search_that_is_asked_again_asks_the_neighbours_where_something_has_changed(led, leads, same, ways):
    last, asked = led({}, (worth(100.0, "drag"), worth(90.0, leads), same))
    assert last.laws == (leads,)
    assert asked == [((leads,), way) for way in ("first", "second")][:ways]
