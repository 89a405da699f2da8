"""The search from structure to structure: what it adds, drops, exchanges, and that it ends."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.candidate import Candidate, key
from dashpot.diagnose.search.race import PATIENCE
from dashpot.diagnose.search.search import Search
from dashpot.diagnose.search.starts import Proposal
from dashpot.examples.truth import TRUTH
from dashpot.identify.data import Data, data_of
from dashpot.identify.segments import Segment
from dashpot.identify.structure import Fitted
from dashpot.model import Oscillator
from dashpot.model.law import Scales
from dashpot.model.laws import find


def searched(case, *laws: str) -> tuple[Search, tuple[str, ...]]:
    """The search over a few laws of the library, and what it ended with."""
    data, holdout = data_of(case.training, case.model), data_of(case.holdout, case.model)
    search = Search(data, holdout, [find(law) for law in laws])
    return search, search.from_family(search.best_of_family(case.model)).laws


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
    first = search.from_family(search.best_of_family(case.model))
    search.laws = [find("quintic-stiffness"), find("clearance")]
    assert first.laws == ("quintic-stiffness",)  # taken while nothing better was there
    again = search.from_family(search.best_of_family(case.model))
    assert again.laws == ("clearance",)


@pytest.mark.parametrize("without", [True, False])
def test_where_nothing_could_be_held_out_training_counts_once(rig, without):
    case = rig("single", "clearance")
    data, holdout = data_of(case.training, case.model), data_of(case.holdout, case.model)
    search = Search(data, None if without else holdout, [find("clearance")])
    selected = search.from_family(search.best_of_family(case.model))
    assert selected.laws == ("clearance",)
    assert (selected.predictive == 0.0) is without
    assert selected.value == selected.evidence + selected.predictive


# --- which neighbours are entered

SAMPLES, NOISE = 4000, 1e-5
OTHERS = (
    "cubic-damping",
    "quadratic-stiffness",
    "quintic-stiffness",
    "asymmetric-friction",
    "displacement-dependent-damping",
)


def leading(*laws: str, times: float = 10.0) -> tuple[Search, Candidate]:
    """A leader that leaves so many times the noise, in a search over the library."""
    values = {f"{law}.{p.name}": 1.0 for law in laws for p in find(law).parameters}
    model = Oscillator.from_values(TRUTH | values, effects=laws)
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

    def simulated(search, entries):
        nowhere = {"near": False, "value": -np.inf, "count": 0}
        return [SimpleNamespace(laws=entry.laws, patience=entry.patience, **nowhere) for entry in entries]

    def propose(gains: dict[str, float]) -> None:
        model = Oscillator.from_values(TRUTH)
        proposals = [Proposal(law, model, np.zeros((1, 2)), gain) for law, gain in gains.items()]
        for screen in ("by_score", "by_motion", "alike"):
            # the laws that are asked for come last in all of them
            given = lambda *asked: [p for p in proposals if p.law in {law.name for law in asked[-1]}]  # noqa: E731
            monkeypatch.setattr(f"{module}.{screen}", given)
        monkeypatch.setattr(f"{module}.in_the_best_valleys", list)
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


def test_what_was_judged_where_it_is_exchanged_is_not_entered_again(proposing):
    search, leader = leading("quadratic-drag")
    search.candidates[("cubic-damping",)] = Candidate(("cubic-damping",), leader.fit, stage="judged")
    search.candidates[("quintic-stiffness",)] = Candidate(("quintic-stiffness",), leader.fit, stage="left")
    proposing({"cubic-damping": 100.0, "quintic-stiffness": 90.0})
    assert added(search._exchanged(leader)) == ["quintic-stiffness"]
