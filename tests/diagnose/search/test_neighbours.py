"""Structures next to a fitted one."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search import neighbours
from dashpot.diagnose.search.candidate import Candidate
from dashpot.diagnose.search.neighbours import (
    asked_by_motion,
    each_learnt,
    entered_again,
    finer,
    kept,
    more_general,
    with_learnt,
    with_shapes,
)
from dashpot.diagnose.search.starts import Proposal
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.structure import Fitted
from dashpot.model import oscillator_with
from dashpot.model.law import Scales
from dashpot.model.library import find
from dashpot.model.terms import with_term

SCALES = Scales(length=2e-3, omega=TRUTH["omega0"], force=0.0, response=2e-3, duration=8.0)


def fitted(*laws: str) -> Fitted:
    values = {f"{law}.{p.name}": 1.0 for law in laws for p in find(law).parameters}
    model = oscillator_with(TRUTH | values, effects=laws)
    return Fitted(model, np.zeros((1, 2)), (np.zeros(8),), 0.0, tuple(model.parameters()))


def test_a_neighbour_keeps_what_was_kept_and_the_shape_of_a_new_law():
    fit = fitted("quadratic-drag")
    less = replace(fit, free=tuple(name for name in fit.free if name != "dry"))
    shapes = tuple(f"hysteresis.{p.name}" for p in find("hysteresis").parameters if p.shape)
    assert shapes
    grown = with_term(less.model, "hysteresis", {p.name: 1.0 for p in find("hysteresis").parameters})
    assert kept(less, grown) == ("dry", *shapes)
    # a shape that was free stays so
    assert kept(replace(less, model=grown, free=tuple(grown.parameters())), grown) == ()


def test_what_is_learnt_begins_at_nothing_and_is_measured_by_the_motion():
    entry = with_learnt(
        Candidate(("stribeck",), fitted("stribeck")), [find("free/damping/6")], SimpleNamespace(scales=SCALES), 7
    )
    assert (entry.laws, entry.patience, entry.adds) == (("free/damping/6", "stribeck"), 7, True)
    values = entry.model.values()
    assert {values[f"free/damping/6.at-{k + 1}"] for k in range(7)} == {0.0}
    assert values["free/damping/6.speed"] == SCALES.length * SCALES.omega


def test_a_learnt_curve_is_gone_on_from_with_knots_between():
    fit = fitted("free/damping/6", "quadratic-drag")
    kept_dry = replace(fit, free=tuple(n for n in fit.free if n not in ("dry", "free/damping/6.speed")))
    (entry,) = finer(Candidate(("free/damping/6", "quadratic-drag"), kept_dry))
    assert entry.laws == ("free/damping/12", "quadratic-drag")
    assert list(entry.fixed) == ["dry", "free/damping/12.speed"]
    values = entry.model.values()
    assert [values[f"free/damping/12.at-{k + 1}"] for k in range(13)] == [1.0] * 13
    assert finer(Candidate(entry.laws, replace(fit, model=entry.model))) == []


def test_shapes_are_freed_where_there_are_some():
    fit = fitted("hysteresis")
    shapes = {f"hysteresis.{p.name}" for p in find("hysteresis").parameters if p.shape}
    free = tuple(name for name in fit.model.parameters() if name not in shapes | {"dry"})
    start = SimpleNamespace(laws=("hysteresis",), model=fit.model, fitted=fit, structure=SimpleNamespace(free=free))
    entry = with_shapes(start)
    assert entry is not None
    assert list(entry.fixed) == ["dry"]
    start.structure.free = tuple(fit.model.parameters())
    assert with_shapes(start) is None


def test_a_law_is_exchanged_for_the_one_of_which_it_is_a_case_unless_the_model_has_that_already():
    (wider,) = more_general(Candidate(("clearance",), fitted("clearance")))
    assert wider.laws == ("two-sided-stop",)
    assert [term.effect for term in wider.model.terms] == ["two-sided-stop"]
    # found beside it, or with a given model whose stops they are
    for laws in [("clearance", "two-sided-stop"), ("clearance",)]:
        assert more_general(Candidate(laws, fitted("two-sided-stop", "clearance"))) == []


@pytest.mark.parametrize("more", [0, 1])
def test_what_is_entered_again_has_its_states_where_there_are_as_many_segments(plain, more):
    data, model = plain
    states = np.ones((len(data.segments) + more, 3))
    known = Candidate(("tonal-disturbance",), Fitted(model, states, (), 0.0, ()), stage="judged")
    (entry,) = entered_again([known, Candidate(("clearance",))], data)
    assert entry.laws == ("tonal-disturbance",)
    assert entry.model is model
    assert (entry.initial is states) is (more == 0)


@pytest.mark.parametrize(
    ("law", "beside"), [("actuator-saturation", False), ("actuator-lag", True), ("stribeck", True)]
)
def test_a_learnt_map_takes_the_place_of_what_is_on_its_path(monkeypatch, law, beside):
    """A map of the drive holds a static law of it within; a delay, or a law of another path, stands beside it."""
    leader, drive = Candidate((law,), fitted(law)), find("free/drive/6")
    asked: list[tuple[str, ...]] = []

    def by_motion(smaller, _data, laws):
        asked.append(tuple(term.effect for term in smaller.model.terms))
        values = {p.name: 1.0 for p in laws[0].parameters}
        return [Proposal(laws[0].name, with_term(smaller.model, laws[0].name, values), smaller.initial, 1.0)]

    monkeypatch.setattr(neighbours, "by_motion", by_motion)
    entries = each_learnt(leader, [drive], SimpleNamespace(scales=SCALES))
    assert asked_by_motion(leader, drive) is beside
    assert [entry.laws for entry in entries] == ([] if beside else [("free/drive/6",)])
    assert asked == ([] if beside else [()])
    assert not asked_by_motion(leader, find("free/spring/6"))
