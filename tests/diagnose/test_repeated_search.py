"""A search that is begun again: whether what was found before stands."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest
from dashpot.diagnose import diagnosis
from dashpot.diagnose.time_allowed import TimeAllowed


@dataclass
class Found:
    name: str
    untried: tuple[str, ...] = field(default=())


@pytest.mark.parametrize(("untried", "stands"), [(("the score of every law",), "first"), ((), "second")])
def test_an_unfinished_repeated_search_replaces_nothing(monkeypatch, untried, stands):
    case = SimpleNamespace(noted=lambda *_: case)
    searches = iter([Found("first"), Found("second", untried)])
    blocks = iter([["a block"], []])
    monkeypatch.setattr(diagnosis, "prepare", lambda *_: case)
    monkeypatch.setattr(diagnosis, "find", lambda *_: next(searches))
    monkeypatch.setattr(diagnosis, "asked_again", lambda *_: None)
    monkeypatch.setattr(diagnosis, "odd_blocks", lambda _: [SimpleNamespace(sentence=b) for b in next(blocks)])
    monkeypatch.setattr(diagnosis, "without", lambda given, odd: [*given, *odd])
    _, found, left_out = diagnosis._searched(None, ([], []), lambda *_: None, TimeAllowed())
    assert found.name == stands
    assert bool(found.untried) is (stands == "first")
    assert bool(left_out) is (stands == "second")


def test_blocks_that_stand_out_ever_anew_are_no_exceptions(monkeypatch):
    """After two searches without some, what stands out of the rest then stays in."""
    case = SimpleNamespace(noted=lambda *_: case)
    searches: list[Found] = []
    monkeypatch.setattr(diagnosis, "prepare", lambda *_: case)
    monkeypatch.setattr(diagnosis, "find", lambda *_: searches.append(Found(f"search {len(searches)}")) or searches[-1])
    monkeypatch.setattr(diagnosis, "asked_again", lambda *_: None)
    monkeypatch.setattr(diagnosis, "odd_blocks", lambda f: [SimpleNamespace(sentence=f"a block beside {f.name}")])
    monkeypatch.setattr(diagnosis, "without", lambda given, odd: [*given, *odd])
    _, found, left_out = diagnosis._searched(None, ([], []), lambda *_: None, TimeAllowed())
    assert found.name == "search 2"
    assert [block.sentence for block in left_out] == ["a block beside search 0", "a block beside search 1"]
