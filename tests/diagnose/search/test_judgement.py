"""Odds of structures, what is accepted, what cannot be told apart, and which name a term gets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.limits import LISTED
from dashpot.diagnose.search import judgement as module
from dashpot.diagnose.search.candidate import Candidate, key
from dashpot.diagnose.search.judgement import (
    accepted,
    first_of_several,
    leading,
    leaves_mismatch,
    log_odds,
    matters,
    mismatch_share,
    names_of,
    needed_in_samples,
    odds_in_bags,
    standing,
    why_not,
)
from dashpot.identify.fit.mismatch import gain_of_mismatch
from dashpot.identify.problem.data import Data
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Fitted
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.law import Scales
from dashpot.model.library import KNOWN

BASE = {"mass": 0.3, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 5.0, "dry": 0.1}
MODEL = Oscillator.from_values(BASE)
CYCLES = 20


#: What a law's place in the library costs.
PRICE = np.log(sum(not law.learnt for law in KNOWN.values()))


@pytest.fixture
def luck(monkeypatch):
    """Set the part of the power that chance takes away; none at first."""

    def put(part: float) -> None:
        monkeypatch.setattr(module, "by_chance", lambda *_: part)

    put(0.0)
    return put


def data(noise: float) -> Data:
    """One free stretch of twenty cycles at 1 rad a sample-second, whose sensor has some noise."""
    n = CYCLES * 100
    time = np.arange(n) * 2 * np.pi / 100
    segment = Segment(0, 0, n, np.sin(time), None, 2 * np.pi / 100, 0.0, 1.0)
    scales = Scales(length=1.0, omega=1.0, force=0.0, response=1.0, duration=float(time[-1]))
    return Data((), (segment,), (noise,), (0.0,), scales)


def candidate(*laws: str, evidence: float = 0.0, predictive: float = 0.0, left: float = 1.0) -> Candidate:
    fit = Fitted(MODEL, np.zeros((1, 2)), (np.full(CYCLES * 100, left),), 0.0, laws)
    return Candidate(key(laws), fit, fit, evidence, predictive, predictive, "judged")


def parts(noise: float) -> tuple[Data, Data]:
    return data(noise), data(noise)


def test_where_only_noise_is_left_the_odds_are_those_of_the_evidence():
    better, worse = candidate("quadratic-drag", evidence=30.0, left=1.0), candidate(left=1.05)
    assert log_odds(better, worse, parts(1.0)) == 30.0
    assert log_odds(worse, better, parts(1.0)) == -30.0


def test_where_a_mismatch_is_left_its_cycles_say_the_same_again(luck):
    """Thousands of samples a mismatch repeats itself in are few witnesses, and the law pays for its place."""
    better, worse = candidate("quadratic-drag", evidence=3000.0, left=1.0), candidate(left=1.05)
    told = log_odds(better, worse, parts(0.1))
    both = [s for d in parts(0.1) for s in d.segments]
    gain, _ = gain_of_mismatch([*worse.residuals], [*better.residuals], both)
    assert 0.0 < gain < 10.0
    assert told == pytest.approx(gain - PRICE, abs=0.3)
    assert log_odds(worse, better, parts(0.1)) == pytest.approx(-told)
    # but what takes nearly everything away is decided all the same
    sure = candidate("quadratic-drag", evidence=3000.0, left=0.2)
    assert log_odds(sure, worse, parts(0.1)) > DECISIVE


def test_what_a_law_must_gain_is_what_its_odds_ask_for(luck):
    worse, apart = candidate(), data(0.01)
    assert worse.fit is not None
    needed = needed_in_samples(worse.fit, apart)
    left = float(np.exp(-needed / sum(segment.n for segment in apart.segments)))
    better = candidate("quadratic-drag", evidence=1e6, left=left)
    alone = [replace(one, held_out=None) for one in (better, worse)]
    assert log_odds(*alone, (apart,)) == pytest.approx(DECISIVE, rel=0.1)


def test_at_the_noise_a_law_needs_no_more_than_it_pays():
    fit = candidate().fit
    assert fit is not None
    assert needed_in_samples(fit, data(1.0)) == 0.0


def test_what_chance_takes_away_too_speaks_for_no_law(luck):
    better, worse = candidate("quadratic-drag", evidence=3000.0, left=0.5), candidate(left=1.0)
    told = log_odds(better, worse, parts(0.01))
    luck(0.75)  # of the power: half the size
    assert log_odds(better, worse, parts(0.01)) == pytest.approx(-PRICE, abs=0.1)
    assert told > 10.0


def test_a_state_of_its_own_is_an_unknown_of_each_segment_that_begins_in_motion(monkeypatch):
    asked = []
    monkeypatch.setattr(module, "by_chance", lambda _fit, _data, count: asked.append(count) or 0.0)
    better, worse = candidate("viscoelastic", evidence=3000.0, left=0.5), candidate(left=1.0)
    assert better.fit is not None
    for begun in (0.0, 0.3):  # at rest, and not
        states = np.array([[0.0, 0.0, begun]])
        odds_in_bags(replace(better, fit=replace(better.fit, initial=states)), worse, parts(0.01))
        log_odds(replace(better, fit=replace(better.fit, initial=states)), worse, parts(0.01))
    assert asked == [1, 1, 2, 1]


@pytest.mark.parametrize("noise", [1.0, 1.0 / 1.1])
def test_the_odds_of_witnesses_go_over_into_those_of_samples(noise):
    """The noise is known to a tenth."""
    better, worse = candidate("quadratic-drag", evidence=30.0, left=1.0), candidate(left=1.05)
    assert mismatch_share(better, parts(noise)) == pytest.approx(0.0, abs=1e-9)
    assert log_odds(better, worse, parts(noise)) == pytest.approx(30.0)


def test_the_odds_do_not_jump_where_a_mismatch_begins(luck):
    better, worse = candidate("quadratic-drag", evidence=30.0, left=1.0), candidate(left=1.05)
    assert log_odds(better, worse, parts(1.0 / 1.10001)) == pytest.approx(30.0, rel=0.01)


@pytest.mark.parametrize(("behind", "leads"), [(DECISIVE - 0.1, ()), (DECISIVE + 0.1, ("quadratic-drag",))])
def test_a_shorter_structure_leads_where_it_comes_as_near(behind, leads):
    leader = candidate("quadratic-drag", evidence=100.0, left=0.9)
    family = candidate(evidence=100.0 - behind)
    assert leading(leader, [family], parts(1.0)).laws == leads


@pytest.mark.parametrize(("left", "leads"), [(1.2, ()), (1.7, ("quadratic-drag",))])
def test_far_from_the_noise_a_shorter_structure_leads_by_the_odds_that_the_longer_must_have(left, leads, luck):
    """There thousands of samples repeat themselves, and are few witnesses for a law more."""
    leader = candidate("quadratic-drag", evidence=1000.0, left=1.0)
    assert leading(leader, [candidate(left=left)], parts(0.1)).laws == leads


@pytest.mark.parametrize(
    ("evidence", "left", "first"), [(DECISIVE + 0.1, 0.9, True), (DECISIVE - 0.1, 0.9, False), (100.0, 0.999, False)]
)
def test_the_first_of_several_is_one_that_the_training_is_decisive_for(evidence, left, first):
    """Whatever it says of the rest; by something that matters."""
    family, drag = candidate(), candidate("quadratic-drag", evidence=evidence, predictive=0.0, left=left)
    drag = replace(drag, foretold=-50.0)
    friction = candidate("stribeck", evidence=evidence - 0.05, left=left)
    found = first_of_several(family, [friction, drag, family, replace(drag, stage="left")], parts(1.0))
    assert found is (drag if first else None)


def test_of_the_shorter_the_most_probable_leads():
    leader = candidate("quadratic-drag", "stribeck", evidence=100.0, left=0.9)
    drag, friction = candidate("quadratic-drag", evidence=96.0), candidate("stribeck", evidence=97.0)
    assert leading(leader, [drag, friction], parts(1.0)) is friction
    # however probable one as long is
    other = candidate("quadratic-drag", "clearance", evidence=120.0)
    assert leading(leader, [other, drag], parts(1.0)) is drag


@pytest.mark.parametrize(("gain", "leads"), [(0.1, "stribeck"), (-0.1, "quadratic-drag")])
def test_one_as_long_leads_where_it_is_more_probable_at_all(gain, leads):
    leader = candidate("quadratic-drag", evidence=100.0, left=0.9)
    other = candidate("stribeck", evidence=100.0 + gain, left=0.9)
    assert leading(leader, [other], parts(1.0)).laws == (leads,)


@pytest.mark.parametrize(("gain", "leads"), [(0.1, ("hysteresis",)), (-0.1, ("quadratic-drag", "stribeck"))])
def test_one_that_stands_for_two_leads_where_it_is_more_probable_at_all(gain, leads):
    leader = candidate("quadratic-drag", "stribeck", evidence=100.0, left=0.9)
    one = candidate("hysteresis", evidence=100.0 + gain, left=0.9)
    assert leading(leader, [one], parts(1.0)).laws == leads


@pytest.mark.parametrize(("worse", "leads"), [(DECISIVE - 0.1, "stribeck"), (DECISIVE + 0.1, "quadratic-drag")])
def test_one_as_long_must_not_tell_decisively_worse_what_was_held_out(worse, leads):
    """However much better it suits the recordings that it was fitted to."""
    leader = candidate("quadratic-drag", evidence=100.0, predictive=50.0, left=0.9)
    other = candidate("stribeck", evidence=700.0, predictive=50.0 - worse, left=0.9)
    assert leading(leader, [other], parts(1.0)).laws == (leads,)


@pytest.mark.parametrize(("foretold", "leads"), [(50.0, "stribeck"), (49.9, "quadratic-drag")])
def test_where_nothing_is_held_out_one_as_long_foretells_stretches_as_well(foretold, leads):
    """What it foretells is no part of its value there: a better fit alone may have lost the way."""
    leader = replace(candidate("quadratic-drag", evidence=100.0, left=0.9), foretold=50.0, held_out=None)
    other = replace(candidate("stribeck", evidence=700.0, left=0.8), foretold=foretold, held_out=None)
    assert leading(leader, [other], parts(1.0)[:1]).laws == (leads,)


@pytest.mark.parametrize(("gain", "laws"), [(DECISIVE - 0.1, 1), (DECISIVE + 0.1, 2)])
def test_a_further_law_leads_where_it_is_decisive(gain, laws):
    leader = candidate("quadratic-drag", evidence=100.0)
    longer = candidate("quadratic-drag", "stribeck", evidence=99.0 + gain, predictive=1.0, left=0.9)
    assert len(leading(leader, [longer], parts(1.0)).laws) == laws


@pytest.mark.parametrize(("gain", "taken"), [(DECISIVE - 0.1, False), (DECISIVE + 0.1, True)])
def test_what_is_accepted_is_decisive(gain, taken):
    better = candidate("quadratic-drag", evidence=gain - 1.0, predictive=1.0, left=0.9)
    assert accepted(better, candidate(), parts(1.0)) is taken


def test_what_was_held_out_must_not_speak_against_it():
    better = candidate("quadratic-drag", evidence=100.0, predictive=-1.0, left=0.9)
    assert not accepted(better, candidate(), parts(1.0))
    assert "held-out" in why_not(better, candidate(), candidate(), parts(1.0))
    assert accepted(
        replace(better, held_out=None, predictive=0.0, foretold=1.0),
        replace(candidate(), held_out=None),
        parts(1.0)[:1],
    )


@pytest.mark.parametrize(("left", "enough"), [(1.0 / np.sqrt(1.009), False), (1.0 / np.sqrt(1.011), True)])
def test_a_law_that_takes_less_than_a_hundredth_of_the_power_does_not_matter(left, enough):
    better = candidate("quadratic-drag", evidence=100.0, predictive=100.0, left=left)
    assert matters(better, candidate()) is enough
    assert accepted(better, candidate(), parts(1.0)) is enough


def test_power_is_what_matters():
    """A law that takes one part in two hundred of a mismatch's size takes a hundredth of its power."""
    before = candidate(left=2.0)
    assert not matters(candidate("quadratic-drag", left=2.0 / np.sqrt(1.009)), before)
    assert matters(candidate("quadratic-drag", left=2.0 / np.sqrt(1.011)), before)


def test_why_a_law_was_not_taken_is_said():
    family, best = candidate(), candidate("stribeck", evidence=200.0, left=0.5)
    behind = candidate("quadratic-drag", evidence=100.0, predictive=1.0, left=0.9)
    assert "stribeck is more probable: by 99 " in why_not(behind, family, best, parts(1.0))
    little = candidate("quadratic-drag", evidence=3.0, predictive=1.0, left=0.9)
    assert "not decisive" in why_not(little, family, best, parts(1.0))
    needless = candidate("quadratic-drag", evidence=3.0, predictive=1.0, left=1.0)
    assert "less than a tenth of the noise" in why_not(needless, family, family, parts(1.0))


@pytest.mark.parametrize(("noise", "rivals"), [(1.0, ()), (0.1, ("cubic-damping",))])
def test_what_left_the_race_is_a_rival_far_from_the_noise_alone(noise, rivals, luck):
    """It left by the count of samples, of which each is a witness at the noise alone."""
    best = candidate("quadratic-drag", evidence=2000.0, left=0.9)
    left = replace(candidate("cubic-damping", evidence=-np.inf, left=0.92), stage="left", held_out=None)
    never = Candidate(("stribeck",))
    assert standing("quadratic-drag", best, [best, left, never, candidate(left=9.0)], parts(noise)).rivals == rivals


def test_a_mismatch_anywhere_is_one():
    single = data(1.0)
    both = replace(single, segments=single.segments * 2, sensor=(1.0, 1.0), force=(0.0, 0.0))
    n = CYCLES * 100
    quiet = replace(candidate(), held_out=None)
    assert quiet.fit is not None
    loud = replace(quiet, fit=replace(quiet.fit, residuals=(np.full(n, 1.0), np.full(n, 3.0))))
    assert leaves_mismatch(loud, (both,))
    assert not leaves_mismatch(replace(quiet, fit=replace(quiet.fit, residuals=(np.full(n, 1.0),) * 2)), (both,))


@pytest.mark.parametrize(("behind", "rivals"), [(2.9, ("cubic-damping",)), (3.0, ())])
def test_a_group_holds_what_together_has_nineteen_of_twenty_parts(behind, rivals):
    """Nineteen to one is a distance of 2.94."""
    best = candidate("quadratic-drag", evidence=100.0, left=0.9)
    near = candidate("cubic-damping", evidence=100.0 - behind, left=0.9)
    far = candidate("stribeck", evidence=85.0, left=0.9)
    stands = standing("quadratic-drag", best, [best, near, far, candidate()], parts(1.0))
    assert stands.rivals == rivals
    # its odds are those of its group
    others = np.exp([-behind, -15.0, -100.0])
    outside = others[1:] if rivals else others
    assert stands.odds == pytest.approx((1.0 + np.sum(others)) / np.sum(outside) - 1.0, rel=1e-6)


def test_odds_of_a_law_are_against_its_absence_too():
    best = candidate("quadratic-drag", evidence=5.0, left=0.9)
    stands = standing("quadratic-drag", best, [best, candidate()], parts(1.0))
    assert stands.odds == pytest.approx(np.exp(5.0), rel=1e-6)


def test_only_what_could_stand_in_its_place_is_a_rival():
    best = candidate("quadratic-drag", "stribeck", evidence=100.0, left=0.9)
    instead = candidate("cubic-damping", "stribeck", evidence=99.5, left=0.9)
    elsewhere = candidate("cubic-damping", "hysteresis", evidence=99.9, left=0.9)
    stands = standing("quadratic-drag", best, [best, instead, elsewhere], parts(1.0))
    assert stands.rivals == ("cubic-damping",)
    assert standing("stribeck", best, [best, instead, elsewhere], parts(1.0)).rivals == ()


def test_far_from_the_noise_a_cause_of_no_list_competes():
    """It stands beside all that was weighed by the part of what is left that is no noise, and nowhere at the noise."""
    best = candidate("quadratic-drag", evidence=1e4, left=1.0)
    given = [best, candidate(left=1e3)]
    part = mismatch_share(best, parts(0.1))
    assert standing("quadratic-drag", best, given, parts(0.1)).odds == pytest.approx(LISTED / part, rel=1e-3)
    assert standing("quadratic-drag", best, given, parts(1.0)).odds > 1e9


def test_what_is_most_probable_in_its_place_may_be_another():
    best = candidate("quadratic-drag", evidence=100.0, left=0.9)
    likelier = candidate("cubic-damping", evidence=101.0, left=0.9)
    assert standing("quadratic-drag", best, [best, likelier, candidate()], parts(1.0)).first == "cubic-damping"
    assert standing("quadratic-drag", best, [best, candidate()], parts(1.0)).first == "quadratic-drag"
    assert standing("quadratic-drag", best, [best, candidate(evidence=101.0)], parts(1.0)).first == ""


def named(effect: str, **values: float) -> tuple[str, ...]:
    model = oscillator_with(BASE | {f"{effect}.{n}": v for n, v in values.items()}, effects=(effect,))
    return names_of(model.terms[0], model)


def test_a_load_larger_than_the_friction_is_no_friction():
    assert named("constant-force", load=2.0) == ("constant-force",)
    assert named("constant-force", load=0.05) == ("constant-force", "asymmetric-friction/dry")


def test_a_clearance_stiffer_than_the_spring_is_a_stop():
    assert named("clearance", stiffness=0.5 * 6400.0, gap=1e-3) == ("clearance",)
    assert named("clearance", stiffness=4.0 * 6400.0, gap=1e-3) == ("two-sided-stop",)
    soft = {"stiffness": 0.5 * 6400.0, "position": 1e-3, "damping": 0.0, "offset": 0.0}
    assert named("two-sided-stop", **soft) == ("clearance",)
    assert named("two-sided-stop", **soft | {"stiffness": 4.0 * 6400.0}) == ("two-sided-stop",)


def test_the_name_of_another_law_of_the_structure_is_taken():
    stop = {"stiffness": 0.5 * 6400.0, "position": 1e-3, "damping": 0.0, "offset": 0.0}
    values = BASE | {f"two-sided-stop.{name}": value for name, value in stop.items()}
    values |= {"clearance.stiffness": 4.0 * 6400.0, "clearance.gap": 2e-3}
    model = oscillator_with(values, effects=("clearance", "two-sided-stop"))
    assert [names_of(term, model)[0] for term in model.terms] == ["clearance", "two-sided-stop"]
