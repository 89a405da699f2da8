"""The search from structure to structure: what it adds, drops, exchanges, and that it ends."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.candidate import Candidate, key
from dashpot.diagnose.search.found import Found
from dashpot.diagnose.search.race import PATIENCE
from dashpot.diagnose.search.search import Search
from dashpot.diagnose.search.starts import Proposal
from dashpot.diagnose.tell import _effects
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Fitted
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.law import Scales
from dashpot.model.laws import LIBRARY
from dashpot.model.library import find

SAMPLES, NOISE = 4000, 1e-5
OTHERS = ("cubic-damping", "quadratic-stiffness", "quintic-stiffness", "asymmetric-friction")
OTHERS += ("displacement-dependent-damping",)
RUGGED = next(law.name for law in LIBRARY.values() if law.rugged)


def leading(*laws: str, times: float = 10.0) -> tuple[Search, Candidate]:
    """A leader that leaves so many times the noise, in a search over the library."""
    values = {f"{law}.{p.name}": 1.0 for law in laws for p in find(law).parameters}
    model = oscillator_with(TRUTH | values, effects=laws)
    left = times * NOISE * np.sign(np.random.default_rng(0).standard_normal(SAMPLES))
    motion = 1e-3 * np.cos(0.16 * np.arange(SAMPLES))
    segment = Segment(0, 0, SAMPLES, motion + left, None, 2e-3, 0.0, TRUTH["omega0"])
    scales = Scales(length=1e-3, omega=TRUTH["omega0"], force=0.0, response=1e-3, duration=8.0)
    data = Data((), (segment,), (NOISE,), (0.0,), scales)
    fit = Fitted(model, np.zeros((1, 2)), (left,), 0.0, tuple(model.parameters()))
    return Search(data, None), Candidate(key(laws), fit, stage="judged")


@pytest.fixture
def proposing(monkeypatch):
    """``proposing(gains)``: what every screen proposes from then on; what is entered is not simulated."""
    module = "dashpot.diagnose.search.search"

    def simulated(search, entries, *, noise=False):
        nowhere = {"near": False, "value": -np.inf, "count": 0}
        return [SimpleNamespace(laws=entry.laws, patience=entry.patience, **nowhere) for entry in entries]

    def propose(gains: dict[str, float]) -> None:
        model = Oscillator.from_values(TRUTH)
        proposals = [Proposal(law, model, np.zeros((1, 2)), gain) for law, gain in gains.items()]
        for screen in ("by_score", "by_motion", "alike"):
            # the laws that are asked for are the last list in all of them
            given = lambda *asked: [  # noqa: E731
                p for p in proposals if p.law in {law.name for law in [x for x in asked if isinstance(x, list)][-1]}
            ]
            monkeypatch.setattr(f"{module}.{screen}", given)
        monkeypatch.setattr(Search, "_started", simulated)
        monkeypatch.setattr(Search, "_race", lambda self, starts, standing: None)

    return propose


def added(starts, *laws: str) -> list[str]:
    """The one law of each that the leader with these does not have."""
    return [law for start in starts for law in start.laws if law not in laws]


@pytest.mark.parametrize(
    ("gains", "entered"),
    [
        ((100.0, 1.0), 2),  # two at any rate
        ((100.0, 90.0, 49.0), 2),
        ((100.0, 90.0, 51.0), 3),
        ((100.0, 90.0, 80.0, 49.0), 3),
        ((100.0, 90.0, 80.0, 70.0, 60.0), 4),  # and never more than four
    ],
)
def test_a_law_is_exchanged_for_the_two_to_four_that_act_most_like_it(proposing, gains, entered):
    search, leader = leading("quadratic-drag")
    proposing(dict(zip(OTHERS, gains, strict=False)))
    assert added(search._exchanged(leader)) == list(OTHERS[:entered])


def test_several_laws_are_exchanged_for_one_too(proposing):
    """Each by itself, and both: what acts like them together may act like neither."""
    search, leader = leading("quadratic-drag", "stribeck")
    proposing({"cubic-damping": 100.0})
    entered = {start.laws for start in search._exchanged(leader)}
    assert entered == {("cubic-damping", "quadratic-drag"), ("cubic-damping", "stribeck"), ("cubic-damping",)}


def test_a_law_is_exchanged_once_from_one_place(proposing):
    search, leader = leading("quadratic-drag")
    proposing({"cubic-damping": 100.0})
    assert added(search._exchanged(leader)) == ["cubic-damping"]
    assert search._exchanged(leader) == []


@pytest.mark.parametrize(("times", "steps"), [(1.0, PATIENCE), (10.0, 10)])
def test_far_from_the_noise_an_exchanged_law_has_the_steps_that_it_takes_to_converge(proposing, times, steps):
    search, leader = leading("quadratic-drag", times=times)
    proposing({"cubic-damping": 100.0})
    assert [start.patience for start in search._exchanged(leader)] == [steps]


@pytest.mark.parametrize(("gain", "at_once"), [(49.0, False), (51.0, True)])
def test_far_from_the_noise_what_scores_half_of_the_best_goes_first(proposing, gain, at_once):
    search, leader = leading()
    proposing({"cubic-damping": 100.0, "stribeck": gain})
    assert added(search._scored(leader)) == ["cubic-damping", "stribeck"][: 1 + at_once]
    assert added(search._less_scored(leader)) == ([] if at_once else ["stribeck"])


def test_near_the_noise_all_are_asked_for_at_once(proposing):
    search, leader = leading(times=1.0)
    proposing({"cubic-damping": 100.0, "stribeck": 20.0})
    assert added(search._scored(leader)) == ["cubic-damping", "stribeck"]


@pytest.mark.parametrize(("gain", "simulated"), [(49.0, False), (51.0, True)])
def test_what_gains_half_of_the_best_on_the_measured_motion_is_simulated(proposing, gain, simulated):
    search, leader = leading()
    proposing({"cubic-damping": 100.0, "stribeck": gain})
    assert added(search._moved(leader)) == ["cubic-damping", "stribeck"][: 1 + simulated]


def test_what_only_its_score_speaks_for_waits_until_it_comes_to_the_noise(proposing):
    """A constant force shows nowhere in the measured motion."""
    search, leader = leading()
    proposing({"constant-force": 1000.0, "cubic-damping": 100.0})
    assert added(search._moved(leader)) == ["cubic-damping"]


def test_what_promises_less_than_its_parameters_cost_is_not_simulated(proposing):
    """Half the logarithm of the number of samples each; it is kept with the reason."""
    search, leader = leading(times=1.0)
    cost = 0.5 * np.log(SAMPLES)
    proposing({"cubic-damping": 0.99 * cost, "quadratic-drag": 1.01 * cost, "clearance": 1.99 * cost})
    assert added(search._scored(leader)) == ["quadratic-drag"]
    assert set(search.candidates) == {("clearance",), ("cubic-damping",)}
    assert all("less than its parameters cost" in candidate.why for candidate in search.candidates.values())


def test_three_laws_are_the_most(proposing):
    laws = ("cubic-damping", "quadratic-drag", "quadratic-stiffness")
    proposing({"stribeck": 1000.0})
    search, leader = leading(*laws[:2])
    assert added(search._scored(leader), *laws[:2]) == ["stribeck"]
    search, leader = leading(*laws)
    assert search._scored(leader) == []


@pytest.mark.parametrize(("behind", "entered"), [(0.99, []), (1.01, ["cubic-damping"])])
def test_what_was_judged_is_entered_again_where_the_leader_is_decisively_better(proposing, behind, entered):
    """From where that stands, however little it acts like what it is exchanged for: it may rest on a side summit."""
    search, leader = leading("quadratic-drag")
    leader = replace(leader, evidence=1e4, predictive=0.0)
    judged = replace(leader, laws=("cubic-damping",), evidence=leader.value - behind * DECISIVE)
    search.candidates[("cubic-damping",)] = judged
    search.candidates[("quintic-stiffness",)] = Candidate(("quintic-stiffness",), leader.fit, stage="left")
    proposing({"quintic-stiffness": 90.0, "asymmetric-friction": 80.0, "cubic-damping": 1.0})
    assert added(search._exchanged(leader)) == ["quintic-stiffness", "asymmetric-friction", *entered]


# --- what is asked of a leader


def test_of_neighbours_that_arrive_the_one_that_does_without_a_law_leads(monkeypatch):
    search, leader = leading("quadratic-drag", times=1.0)
    search.candidates[leader.laws] = replace(leader, evidence=10.0, predictive=0.0)
    family = replace(leader, laws=(), evidence=9.0, predictive=0.0)
    monkeypatch.setattr(Search, "_arrived", lambda self, leader, starts: list(starts))
    assert search._best_of_neighbours(leader, [family]) is family
    assert search._best_of_neighbours(leader, []) is search.candidates[leader.laws]


def test_near_the_noise_the_measured_motion_is_not_asked():
    """Far from it a smooth spring and damping go before any second cause, and after all first ones."""
    search, near = leading(times=1.0)
    assert search._ways(near) == [search._as_long_or_shorter, search._scored]
    moved, instead, *scored = causes = ["_moved", "_as_long_or_shorter", "_scored", "_less_scored"]
    asked = {(): [*causes, "_learnt"], ("stribeck",): ["_learnt", *causes]}
    asked[("free/damping/6",)] = [instead, "_learnt", moved, *scored]
    for laws, ways in asked.items():
        given = search._ways(leading(*laws, times=10.0)[1])
        assert [way.__name__ for way in given if way != search._rugged] == ways


def test_what_is_learnt_goes_beside_the_leader_and_all_together_beside_the_family(proposing):
    proposing({})
    search, leader = leading("stribeck")
    family = leading()[1]
    assert [start.laws for start in search._learnt(leader)] == [
        ("free/spring/6", "stribeck"),
        ("free/damping/6", "stribeck"),
        ("free/surface/6", "stribeck"),
    ]
    alone = [("free/spring/6",), ("free/damping/6",), ("free/surface/6",), ("free/damping/6", "free/spring/6")]
    assert [start.laws for start in search._learnt(family)] == alone
    search.candidates[alone[0]] = Candidate(alone[0], stage="left")
    assert [start.laws for start in search._learnt(family)] == alone[1:]


def test_a_mass_a_drive_or_a_sensor_is_learnt_only_where_the_motion_speaks_for_it(proposing):
    """Half as much as for the curve that it speaks for most."""
    search, family = leading()
    proposing({})
    smooth = [start.laws for start in search._learnt(family)]
    proposing({"free/spring/6": 2000.0, "free/drive/6": 1500.0, "free/sensor/6": 900.0})
    assert [start.laws for start in search._learnt(family)] == [*smooth, ("free/drive/6",)]
    search.candidates[("free/drive/6",)] = Candidate(("free/drive/6",), stage="left")
    assert [start.laws for start in search._learnt(family)] == smooth
    proposing({"free/inertia/6": 2000.0, "quadratic-drag": 1e4})
    assert ("free/inertia/6",) in [start.laws for start in search._learnt(family)]
    # a leader may stand for it: then it is asked for without that too
    search, leader = leading("stribeck")
    search.candidates[()] = family
    asked = [start.laws for start in search._learnt(leader)]
    assert asked[-2:] == [("free/inertia/6", "stribeck"), ("free/inertia/6",)]


def test_each_law_is_dropped_and_exchanged(proposing, monkeypatch):
    search, leader = leading("quadratic-drag", "stribeck")
    proposing({"cubic-damping": 100.0})
    assert leader.fit is not None
    place = leader.fit.model, leader.fit.initial
    monkeypatch.setattr("dashpot.diagnose.search.neighbours.without", lambda *_, **__: [place])
    starts = search._as_long_or_shorter(leader)
    assert [start.laws for start in starts] == [
        ("stribeck",),
        ("quadratic-drag",),
        ("cubic-damping", "stribeck"),
        ("cubic-damping", "quadratic-drag"),
        ("cubic-damping",),
    ]


@pytest.mark.parametrize(
    ("laws", "times", "foreseen", "asked"),
    [
        (("quadratic-drag", "stribeck"), 1.0, 0.0, True),
        (("quadratic-drag", "stribeck"), 1.0, np.inf, False),  # it loses what was to be foreseen
        (("quadratic-drag", "stribeck"), 10.0, 0.0, False),  # far from the noise there is no summit yet
        (("quadratic-drag",), 1.0, 0.0, False),  # the given family was fitted afresh when all began
    ],
)
def test_what_loses_more_without_one_of_several_laws_is_also_fitted_afresh(
    proposing, monkeypatch, laws, times, foreseen, asked
):
    search, leader = leading(*laws, times=times)
    proposing({})
    said = []
    monkeypatch.setattr("dashpot.diagnose.search.neighbours.without", lambda *_: [])
    monkeypatch.setattr("dashpot.diagnose.search.neighbours.without_anew", lambda *asked: said.append(asked[-1]) or [])
    monkeypatch.setattr("dashpot.diagnose.search.search.foreseen_loss", lambda *_: foreseen)
    search._as_long_or_shorter(leader)
    assert said == (list(laws) if asked else [])


def test_a_law_becomes_the_more_general_one_where_that_is_not_there(proposing):
    proposing({})
    search, leader = leading("clearance")
    assert [start.laws for start in search._exchanged(leader)] == [("two-sided-stop",)]
    search, leader = leading("clearance", "two-sided-stop")
    assert search._exchanged(leader) == []


@pytest.mark.parametrize(
    ("laws", "times", "place"),
    [((), 10.0, (4,)), ((), 1.0, ()), (("quadratic-drag",), 10.0, (2,)), (("quadratic-drag",), 1.0, ())],
)
def test_laws_of_many_side_valleys_are_asked_for_where_all_others_fail(proposing, monkeypatch, laws, times, place):
    """They are slow: after all others, or what the motion shows of a second law; beside the family; once."""
    proposing({})
    search, leader = leading(*laws, times=times)
    search.candidates[()] = leading(times=times)[1]
    probed = []

    def by_probing(fitted, standing, data, asked):
        assert standing is leader.fit
        probed.append([law.name for law in asked])
        return [Proposal(RUGGED, fitted.model, None, 100.0)]

    monkeypatch.setattr("dashpot.diagnose.search.search.by_probing", by_probing)
    ways = search._ways(leader)
    assert tuple(i for i, way in enumerate(ways) if way == search._rugged) == place
    assert [start.laws for start in search._rugged(leader)] == [(RUGGED,)]
    assert probed == [[RUGGED]]
    assert search._rugged not in search._ways(leader)


@pytest.mark.parametrize(("times", "asked"), [(10.0, False), (1.0, True)])
def test_beside_a_law_in_a_side_valley_no_second_law_is_asked_for(proposing, times, asked):
    """What it leaves far from the noise may be the valley's."""
    search, leader = leading(RUGGED, times=times)
    assert bool(search._ways(leader)) is asked


def arriving(search: Search, leader: Candidate, law: str, ahead: float, **more):
    """A start that came so much farther than the leader, its parameters paid for."""
    assert leader.fit is not None
    less = np.exp(-ahead / SAMPLES)  # log-likelihood is that many samples times the logarithm of what is left
    fit = replace(leader.fit, residuals=(less * leader.fit.residuals[0],))
    value = search._measures[0].value(fit.residuals)
    start = {
        "laws": (law,),
        "model": fit.model,
        "fitted": fit,
        "value": value,
        "ceiling": value,
        "count": len(fit.free),
    }
    start |= {"adds": False, "resting": True, "steps": 5, "near": False, "measured_by": lambda measure: None}
    return SimpleNamespace(**(start | more))


@pytest.fixture
def weighing(proposing, monkeypatch):
    """Nothing is simulated or weighed; what arrives is worth nothing."""
    proposing({})
    monkeypatch.setattr(Search, "_compare_by", lambda self, front: None)
    monkeypatch.setattr(
        Search, "weigh", lambda self, laws, fitted: Candidate(laws, fitted, None, 0.0, 0.0, 0.0, "judged")
    )


def test_what_stays_decisively_behind_the_best_is_left_with_the_reason(weighing, caplog):
    caplog.set_level("INFO", logger="dashpot")
    search, leader = leading()
    starts = [arriving(search, leader, name, ahead) for name, ahead in (("best", 50.0), ("near", 43.2), ("far", 43.0))]
    starts += [arriving(search, leader, "promising", 40.0, resting=False)]
    assert [candidate.laws for candidate in search._arrived(leader, starts)] == [("best",), ("near",)]
    assert search.candidates[("far",)].why.startswith("fitted, it stays 7 below the best")
    assert search.candidates[("promising",)].why == "left after 5 steps: what it promised stayed 10 below the best"
    assert "promising: left after 5 steps: what it promised stayed 10 below the best" in caplog.messages
    assert "near: weighed, log-evidence 0" in caplog.messages
    # what is known already and is no better does not arrive again
    assert search._arrived(leader, starts[:2]) == []


def test_a_further_law_arrives_only_where_it_pays_for_itself(weighing):
    search, leader = leading()
    starts = [arriving(search, leader, name, -1.0, adds=name == "more") for name in ("more", "instead")]
    assert [candidate.laws for candidate in search._arrived(leader, starts)] == [("instead",)]


def test_of_one_structure_the_best_place_arrives(weighing):
    search, leader = leading()
    places = [arriving(search, leader, "drag", ahead) for ahead in (1.0, 3.0, 2.0)]
    (arrived,) = search._arrived(leader, places)
    assert arrived.fit is places[1].fitted


def test_a_race_is_told_from_three_tenths_on(monkeypatch):
    search, leader = leading()
    said: list[tuple[str, float]] = []
    search.progress = lambda what, part: said.append((what, part))

    def race(starts, measure, standing, points, progress, over, needed):
        progress("drag", 0.0)
        progress("drag", 1.0)
        return measure

    monkeypatch.setattr("dashpot.diagnose.search.search.race", race)
    assert leader.fit is not None
    search._race([], leader.fit)
    assert [part for _, part in said] == pytest.approx([0.3, 0.95])


def test_where_no_time_is_left_the_best_so_far_is_returned_and_what_was_not_asked_is_said(proposing, monkeypatch):
    search, leader = leading("quadratic-drag")
    leader = replace(leader, evidence=0.0, predictive=0.0)
    asked: list[Candidate] = []
    for way in ("_moved", "_as_long_or_shorter", "_scored", "_less_scored", "_predicted", "_rugged", "_learnt"):
        monkeypatch.setattr(Search, way, lambda _self, beside: asked.append(beside) or [])
    search.until = -np.inf
    assert search._climbed(leader) is leader
    assert asked == []
    assert len(search.untried) > 1
    assert all(sentence.startswith("beside quadratic-drag: ") for sentence in search.untried)


@pytest.mark.parametrize(("memory", "in_step"), [(np.inf, True), (8.0, False), (8.0, True)])
def test_a_leader_that_keeps_step_is_simulated_from_there_on(weighing, monkeypatch, memory, in_step):
    search, leader = leading("quadratic-drag")
    search.data = replace(search.data, memory=memory)
    family = leading()[1]
    search.candidates = {(): family, ("old",): replace(family, laws=("old",)), ("left",): Candidate(("left",))}
    assert leader.fit is not None
    fitted, anew = replace(leader.fit), replace(leader.fit)
    module = "dashpot.diagnose.search.search"
    monkeypatch.setattr(f"{module}.started", lambda *_: SimpleNamespace(fitted=fitted))
    monkeypatch.setattr(f"{module}.race", lambda *_: None)
    monkeypatch.setattr(f"{module}.keeps_step", lambda *_: in_step)
    monkeypatch.setattr(f"{module}.judged", lambda *_: anew)
    again = search._simulated(leader)
    if memory == np.inf or not in_step:
        assert again is leader
        assert search.data.memory == memory
        return
    assert (again.laws, again.fit, search.data.memory) == (leader.laws, fitted, np.inf)
    # what was told in prediction no longer counts, but that it was tried
    assert set(search.candidates) == {(), leader.laws, ("left",)}
    assert search.candidates[()].fit is anew


def test_of_laws_that_are_sure_the_one_that_takes_most_away_comes_first():
    search, best = leading("quadratic-drag", "stribeck", times=1.0)
    best = replace(best, evidence=0.0, predictive=0.0)
    assert best.fit is not None
    model = best.fit.model
    for law, times in (("quadratic-drag", 1.5), ("stribeck", 3.0)):
        search.candidates[(law,)] = replace(leading(law, times=times)[1], stage="left")
    found = Found(best, search.candidates, search.weighing)
    assert found.share_of("quadratic-drag") == pytest.approx(1.0 - 1.0 / 3.0**2)
    assert found.share_of("stribeck") == pytest.approx(1.0 - 1.0 / 1.5**2)
    search.candidates[("stribeck",)] = Candidate(("stribeck",))
    assert found.share_of("quadratic-drag") is None
    effects, _ = _effects(found, model)
    assert [effect.effect for effect in effects] == ["quadratic-drag", "stribeck"]
    search.candidates[("stribeck",)] = replace(leading("stribeck", times=1.2)[1], stage="left")
    effects, _ = _effects(found, model)
    assert [effect.effect for effect in effects] == ["stribeck", "quadratic-drag"]


@pytest.mark.parametrize(("behind", "named"), [(-0.1, False), (0.1, True)])
def test_what_is_there_less_probably_than_not_is_not_named(behind, named):
    search, best = leading("quadratic-drag", times=1.0)
    best = replace(best, evidence=0.0, predictive=0.0)
    without = replace(leading(times=1.0)[1], evidence=-behind, predictive=0.0)
    found = Found(best, {(): without}, search.weighing)
    assert best.fit is not None
    effects, unnamed = _effects(found, best.fit.model)
    assert [effect.effect for effect in effects] == ["quadratic-drag"] * named
    assert list(unnamed) == ["quadratic-drag"] * (not named)
