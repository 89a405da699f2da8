"""The race: promises, patience, what leaves and what arrives."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import NEAR, Measure
from dashpot.diagnose.search.race import PATIENCE, Entry, Start, race, started
from dashpot.diagnose.search.residual_test import times_of_each
from dashpot.identify.problem.structure import shapes_of
from dashpot.identify.signals.odds import DECISIVE
from dashpot.identify.start.measured_motion import probes
from dashpot.model.library import find
from dashpot.model.terms import with_term


def times(start):
    return max(times_of_each(start.fitted.residuals, start.model, start.data))


@pytest.fixture(scope="module")
def there(plain):
    """The maximum, and the measure that it gives."""
    data, model = plain
    start = started(Entry((), model), data, Measure())
    assert start is not None
    measure = race([start], Measure(), None, data.points)
    return start.fitted, measure


def test_a_start_that_is_off_arrives_at_the_noise(plain, bent):
    data, model = plain
    start = started(Entry((), bent(model, viscous=1.3, omega0=1.003)), data, Measure())
    assert start is not None
    assert not start.near
    measure = race([start], Measure(), None, data.points)
    assert start.resting
    assert start.near
    assert measure.noise is not None
    assert times(start) < 1.05
    assert start.model.values()["viscous"] == pytest.approx(model.viscous.value, rel=0.05)


def test_a_start_takes_nothing_back_of_what_its_proposer_found(plain, there, bent):
    """The first cycles say less of an initial state than the whole stretch, of which it is one more unknown."""
    data, (fitted, measure) = plain[0], there
    best = measure.value(fitted.residuals)
    assert Start(Entry((), fitted.model), data, measure).value < best - 0.1
    assert Start(Entry((), fitted.model, fitted.initial), data, measure).value == pytest.approx(best, abs=1e-6)
    off = Start(Entry((), fitted.model, 1.1 * fitted.initial), data, measure)
    assert off.value < best - 1e3
    for _ in range(3):
        off.step()
    assert off.value == pytest.approx(best, abs=1.0)


def test_what_cannot_reach_the_best_leaves_without_a_step(plain, there, bent):
    (data, model), (fitted, measure) = plain, there
    best = measure.value(fitted.residuals)
    off = bent(model, viscous=1.2)
    hopeless = started(Entry((), off, hoped=best - 20.0), data, measure)
    hopeful = started(Entry((), off, hoped=best + 20.0), data, measure)
    assert hopeless is not None
    assert hopeful is not None
    race([hopeless, hopeful], measure, fitted, data.points)
    assert hopeless.steps == 0
    assert not hopeless.looked
    assert hopeful.looked


def test_where_no_time_is_left_no_step_is_taken(plain, there, bent):
    (data, model), (fitted, measure) = plain, there
    start = started(Entry((), bent(model, viscous=1.2), patience=3), data, measure)
    assert start is not None
    race([start], measure, fitted, data.points, over=lambda: True)
    assert start.steps == 0
    race([start], measure, fitted, data.points)
    assert start.steps > 0


def test_a_promise_is_looked_for_before_a_start_leaves(plain, there, bent):
    """One that is told better than was hoped of it has no bound yet."""
    (data, model), (fitted, measure) = plain, there
    start = started(Entry((), bent(model, viscous=1.0001), hoped=-1e12, fixed=("viscous",)), data, measure)
    assert start is not None
    assert start.ceiling == np.inf
    race([start], measure, doubled(fitted, 1e-3), data.points)
    assert start.looked
    assert start.steps == 0
    assert start.ceiling < start.value + 1e6


def doubled(fitted, factor):
    """A structure that leaves so much of what one leaves."""
    return replace(fitted, residuals=tuple(factor * residual for residual in fitted.residuals))


@pytest.mark.parametrize("patience", [0, PATIENCE])
def test_far_from_the_truth_a_start_is_given_its_steps(plain, there, patience, bent):
    data, model = plain
    start = Start(Entry((), bent(model, viscous=2.0, omega0=1.02), patience=patience), data, Measure())
    assert times(start) > NEAR
    race([start], Measure(), doubled(there[0], 1e-9), data.points)
    assert start.steps == patience


def test_the_first_that_comes_to_the_noise_gives_the_measure_of_all(plain, bent):
    data, model = plain
    good = started(Entry((), bent(model, viscous=1.001)), data, Measure())
    bad = started(Entry((), bent(model, omega0=1.2), fixed=("omega0",)), data, Measure())
    assert good is not None
    assert bad is not None
    measure = race([good, bad], Measure(), None, data.points)
    assert measure.noise is not None
    assert good.measure is bad.measure is measure
    assert good.value > bad.value
    assert not bad.near


def test_what_a_linear_rig_promises_it_keeps(plain, bent):
    """Near the maximum the response is linear in the unknowns: one step comes to what it promised."""
    data, model = plain
    start = started(Entry((), bent(model, viscous=1.01)), data, Measure())
    assert start is not None
    start.look()
    promised, before = start.ceiling - start.value, start.value
    start.step()
    assert promised > 10.0
    assert start.value - before == pytest.approx(promised, rel=0.1)


def test_shapes_are_freed_before_a_law_leaves_far_from_the_noise(plain, there, bent):
    data, model = plain
    grown = with_term(bent(model, omega0=1.05), "hysteresis", hysteresis_values(data))
    start = Start(Entry(("hysteresis",), grown, fixed=shapes_of(grown), patience=1), data, Measure())
    assert start.locked
    race([start], Measure(), doubled(there[0], 1e-9), data.points)
    assert not start.locked
    assert start.steps <= 1 + PATIENCE


def hysteresis_values(data) -> dict[str, float]:
    """A weak slider in parallel, its shape as the library has it."""
    law = find("hysteresis")
    values = probes(law, data.scales)[0]
    return values | {p.name: 0.1 * p.natural(data.scales) for p in law.parameters if p.strength}


# --- one start, its steps told beforehand


def scripted(plain, *steps: float, promise: float = 100.0, **entry):
    """A start at 0 whose next steps come to these values and then nowhere, each of which promises so much more."""
    data, model = plain
    start = started(Entry((), model, **entry), data, Measure())
    assert start is not None
    place = start.descent.state

    class Scripted:
        state, residuals, left = place, np.zeros(1), list(steps)
        problem = start.descent.problem

        @property
        def expected(self):
            return self.residuals + promise

        def step(self, _tolerance):
            if self.left:
                self.residuals = np.array([self.left.pop(0)])
                return True
            return False

        def weigh_by(self, _spectra):
            pass

    start.descent, start._settled_anew = Scripted(), lambda: False
    start.measure = SimpleNamespace(noise=None, value=lambda r: float(r[0]), near=lambda *_: False, spectra=lambda r: r)
    start.value, start.near, start.resting, start._white = 0.0, False, False, True
    return start


@pytest.mark.parametrize(
    ("gained", "believed"),
    [
        (100.0, 1.0),
        (26.0, 1.0),  # a quarter of the promise is kept in a straight valley
        (24.0, 0.24),
        (11.0, 0.11),
        (1.0, 0.1),  # a tenth is believed at any rate
        (-5.0, 0.1),
    ],
)
def test_a_promise_is_believed_as_far_as_the_last_one_was_kept(plain, gained, believed):
    start = scripted(plain, gained)
    start.step()
    assert (start.value, start.steps, start.resting) == (gained, 1, False)
    start.look()
    assert start.ceiling == pytest.approx(gained + 100.0 * believed)


def test_a_step_may_bring_what_the_one_before_it_brought(plain):
    """Behind a bend the linearised response sees little of the valley; at its end no step brings anything."""
    start = scripted(plain, 500.0, 560.0, promise=10.0)
    start.step()
    start.look()
    assert start.ceiling == 500.0 + 500.0
    start.step()
    start.look()
    assert start.ceiling == 560.0 + 60.0
    start.measured_by(SimpleNamespace(**vars(start.measure)))
    start.look()
    assert start.ceiling == 560.0 + 10.0  # in another measure it brought something else
    start = scripted(plain, 500.0, promise=10.0)
    start.step()
    start.step()
    assert start.ceiling == start.value == 500.0


def test_what_promises_less_than_it_has_stays_where_it_is(plain):
    """No promise is below what is there already, and none is kept badly that promised nothing."""
    start = scripted(plain, 3.0, promise=-7.0)
    start.look()
    assert start.ceiling == 0.0
    start.step()
    assert (start.value, start.credit) == (3.0, 1.0)


def test_no_start_takes_more_than_a_hundred_steps(plain):
    start = scripted(plain, *range(1, 200))
    for _ in range(99):
        start.step()
    assert not start.resting
    start.step()
    assert start.resting
    assert start.ceiling == start.value == 100.0


def test_far_from_the_noise_a_start_rests_where_no_step_leads_anywhere(plain):
    start = scripted(plain)
    start.step()
    assert (start.resting, start.value, start.steps) == (True, 0.0, 1)


@pytest.mark.parametrize(("reached", "kept"), [(5.0, 5.0), (-5.0, 0.0)])
def test_near_the_noise_a_step_that_loses_by_the_common_measure_is_taken_back(plain, reached, kept):
    start = scripted(plain, reached)
    start._white = False
    before = start.descent.residuals
    start.step()
    assert start.value == kept
    assert start.resting is (reached < 0)
    assert (start.descent.residuals is before) is (reached < 0)


def test_what_rests_is_not_asked_for_a_promise(plain):
    start = scripted(plain)
    start.resting = True
    start.look()
    assert not start.looked


def test_freed_shapes_leave_fixed_what_is_no_shape(plain):
    data, model = plain
    grown = with_term(model, "hysteresis", hysteresis_values(data))
    shapes = shapes_of(grown)
    start = started(Entry(("hysteresis",), grown, fixed=(*shapes, "omega0")), data, Measure())
    assert start is not None
    assert start.locked == shapes
    assert start.count == len(start.structure.free)
    start.credit, start.steps = 0.2, 4
    start.unlock(3)
    assert start.locked == ()
    # free motion says nothing of the mass
    assert set(start.structure.free) == set(grown.parameters()) - {"omega0", "mass"}
    assert (start.credit, start.patience, start.resting) == (1.0, 7, False)


def test_what_begins_anew_keeps_what_was_fixed(plain):
    data, model = plain
    start = started(Entry((), model, fixed=("omega0",)), data, Measure())
    assert start is not None
    free = start.structure.free
    start.resting = True
    start.begin_anew()
    assert start.structure.free == free
    assert not start.resting
    assert not start.gains_anew(start.measure)  # it stands where it began anew


def test_three_steps_of_patience_are_the_first_turn():
    assert PATIENCE == 3


# --- the race itself, between starts that only count


class Runner:
    """A start that gains so much with every step, until it is where it rests."""

    def __init__(self, name: str, *values: float, ceiling: float, patience: int = 0, near_at: int = 99, adds=False):
        self.laws, self.values, self.ceiling, self.patience, self.adds = (
            (name,) * bool(name),
            values,
            ceiling,
            patience,
            adds,
        )
        self.near_at, self.steps, self.looked, self.count, self.locked = near_at, 0, True, 0, ()
        self.data = self.fitted = self.measure = None

    value = property(lambda self: self.values[self.steps])
    near = property(lambda self: self.steps >= self.near_at)
    resting = property(lambda self: self.steps == len(self.values) - 1)

    def step(self) -> None:
        self.steps += 1

    def gains_anew(self, _measure) -> bool:
        return False


#: Frequencies are weighed by a noise already.
KNOWN = SimpleNamespace(noise=(), near=lambda *_: False)


def told(*runners: Runner) -> list[tuple[str, float]]:
    """What a race says that it does, and which part is done."""
    said: list[tuple[str, float]] = []
    race(runners, KNOWN, None, 1000, lambda what, part: said.append((what, part)))
    return said


def test_what_promises_most_goes_first_and_by_its_name():
    low, high = Runner("low", 0.0, 5.0, ceiling=6.0), Runner("", 0.0, 5.0, ceiling=7.0)
    assert told(low, high) == [("the given family", 0.0), ("low", 0.5)]


def test_what_cannot_come_within_decisive_odds_of_the_best_leaves():
    best = Runner("best", 100.0, ceiling=100.0)
    near = Runner("near", 0.0, 1.0, ceiling=100.0 - DECISIVE + 0.1)
    far = Runner("far", 0.0, 1.0, ceiling=100.0 - DECISIVE - 0.1)
    assert [what for what, _ in told(best, near, far)] == ["near"]
    assert (near.steps, far.steps) == (1, 0)


def test_what_adds_a_law_must_promise_more_than_the_best_outside():
    standing = SimpleNamespace(residuals=50.0, model=None, free=())
    measure = SimpleNamespace(noise=(), near=lambda *_: False, value=lambda residuals: residuals)
    more = [Runner("more", 0.0, 1.0, ceiling=50.0 + past, adds=True) for past in (-0.1, 0.1)]
    as_long = Runner("as long", 0.0, 1.0, ceiling=49.9)
    race([*more, as_long], measure, standing, 1000)
    assert [runner.steps for runner in (*more, as_long)] == [0, 1, 1]


@pytest.mark.parametrize(("hopes", "steps"), [(54.9, 0), (55.1, 1), (np.inf, 1)])
def test_patience_ends_where_ten_times_the_promise_would_not_be_what_is_needed(hopes, steps):
    standing = SimpleNamespace(residuals=50.0, model=None, free=())
    measure = SimpleNamespace(noise=(), near=lambda *_: False, value=lambda residuals: residuals)
    patient = Runner("patient", 0.0, 1.0, ceiling=0.0, patience=3, adds=True)
    patient.hopes = hopes
    race([patient], measure, standing, 1000, needed=5.0)
    assert patient.steps == steps


def test_every_parameter_costs_half_the_logarithm_of_the_samples():
    best, dear = Runner("best", 100.0, ceiling=100.0), Runner("dear", 0.0, 1.0, ceiling=101.0)
    dear.count = 4  # pays 13.8
    assert told(best, dear) == []
    dear.count = 2
    assert told(best, dear) == [("dear", 0.5)]


def test_the_patient_catch_up_first():
    ahead = Runner("ahead", 0.0, 1.0, ceiling=90.0)
    patient = Runner("patient", 0.0, 1.0, 2.0, 3.0, ceiling=80.0, patience=2)
    assert [what for what, _ in told(ahead, patient)] == ["patient", "patient", "ahead", "patient"]


def test_once_one_comes_to_the_noise_patience_ends():
    best = Runner("best", 0.0, 100.0, ceiling=200.0, patience=2, near_at=1)
    other = Runner("other", 0.0, 1.0, 2.0, ceiling=10.0, patience=2)
    assert [what for what, _ in told(best, other)] == ["best"]
    assert other.patience == 0


@pytest.mark.parametrize(("lost", "kept"), [(0, 1), (1, 0)])
def test_a_segment_whose_motion_the_leader_lost_begins_where_the_motion_shows_it(plain, lost, kept):
    """Beyond the top of its hill a softening spring pushes away, and no step leads back from there."""
    data, model = plain
    softens = replace(model, cubic=replace(model.cubic, value=-((model.omega0.value / 0.1) ** 2)))
    own = started(Entry((), softens), data, Measure())
    assert own is not None
    initial = own.fitted.initial.copy()
    initial[lost] = [0.2, 0.0]
    start = started(Entry((), softens, initial), data, Measure())
    assert start is not None
    assert np.std(start.fitted.residuals[lost]) < 1.01 * np.std(own.fitted.residuals[lost])
    assert start.fitted.initial[lost] == pytest.approx(own.fitted.initial[lost], rel=1e-3, abs=1e-5)
    assert start.fitted.initial[kept] == pytest.approx(initial[kept], rel=1e-3, abs=1e-5)
