"""What the best structure does without: laws of no certain strength, laws that are plainer ones, and one-run losses."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace

import dashpot
import numpy as np
import pytest
from dashpot.diagnose import simplify
from dashpot.diagnose.search.candidate import Candidate, key
from dashpot.diagnose.search.found import Found, Weighing
from dashpot.diagnose.simplify import (
    best_in_one_run,
    certainty,
    left_of,
    of_unknown_size,
    with_most_probable,
    with_plainer_laws,
    with_rivals_fitted,
    without_needless,
)
from dashpot.diagnose.time_allowed import TimeAllowed
from dashpot.errors import BadInput
from dashpot.examples.force import chirp
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator, Response, oscillator_with
from dashpot.model.laws import LIBRARY
from dashpot.model.library import KNOWN, find
from dashpot.model.terms import with_term
from dashpot.recording import Recording


def found_of(selected: Candidate, weighing=None, known=()) -> Found:
    """What a search ended with, beside other structures."""
    return Found(selected, {c.laws: c for c in (*known, selected)}, weighing)


# --- rivals that left the race


@pytest.mark.parametrize(("value", "first"), [(5.0, "quadratic-drag"), (15.0, "cubic-damping")])
def test_a_rival_that_left_the_race_is_fitted_to_its_end_and_may_lead(monkeypatch, value, first):
    """Once each: one that does not simulate to its end is asked no second time."""

    def fit(name):
        return SimpleNamespace(model=SimpleNamespace(parameters=dict, name=name), free=(), initial=None, offsets=None)

    asked = []
    monkeypatch.setattr(simplify, "standing", lambda *_: SimpleNamespace(rivals=("cubic-damping", "stribeck")))
    monkeypatch.setattr(simplify, "leading", lambda leader, weighed, _: max([leader, *weighed], key=lambda c: c.value))

    def at_rest(entry, _found):
        asked.append(entry.laws)
        return None if entry.laws == ("stribeck",) else entry.model

    monkeypatch.setattr(simplify, "_at_rest", at_rest)
    weighing = SimpleNamespace(
        parts=(), weigh=lambda laws, fitted: Candidate(laws, fitted, None, value, 0.0, 0.0, "judged")
    )
    best = Candidate(("quadratic-drag",), fit("drag"), None, 10.0, 0.0, 0.0, "judged")
    left = [Candidate((law,), fit(law), stage="left") for law in ("cubic-damping", "stribeck")]
    found = with_rivals_fitted(found_of(best, weighing, left))
    assert asked == [("cubic-damping",), ("stribeck",)]
    assert found.selected.laws == (first,)
    assert found.candidates[("cubic-damping",)].stage == "judged"
    assert found.candidates[("stribeck",)].stage == "left"


@pytest.mark.parametrize(
    ("stage", "foretold", "first"),
    [
        ("judged", 0.0, "cubic-damping"),
        ("judged", -1.0, "quadratic-drag"),
        ("left", 0.0, "quadratic-drag"),
    ],
)
def test_what_is_most_probable_in_its_place_leads(monkeypatch, stage, foretold, first):
    """Only where it was fitted to its end, and foretells as well; what is more probable absent stays, unnamed."""
    asked = {"quadratic-drag": "cubic-damping", "constant-force": ""}
    monkeypatch.setattr(simplify, "standing", lambda law, *_: SimpleNamespace(first=asked[law]))
    best = Candidate(key(("constant-force", "quadratic-drag")), None, None, 10.0, 0.0, 0.0, "judged")
    other = Candidate(key(("constant-force", "cubic-damping")), None, None, 9.0, 0.0, foretold, stage)
    found = with_most_probable(found_of(best, SimpleNamespace(parts=()), [other]))
    assert found.selected.laws == key(("constant-force", first))


# --- strengths that are zero within their error

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


WEIGHING = SimpleNamespace(parts=(), weigh=lambda laws, fitted: Candidate(laws, fitted, stage="judged"))


def kept_of(chosen: Candidate, delivered) -> Found:
    """What is left of a structure where whatever is weighed arrives."""
    return without_needless(found_of(chosen, WEIGHING), delivered)


@pytest.fixture
def selected(monkeypatch):
    """Two laws; without one of them nothing but noise is left as the test says."""
    left = SimpleNamespace(mismatch=set(), unfit=set())
    monkeypatch.setattr(
        simplify, "_without", lambda found, name: None if name in left.unfit else SimpleNamespace(model=name)
    )
    monkeypatch.setattr(simplify, "leaves_mismatch", lambda candidate, parts: candidate.fit.model in left.mismatch)
    return Candidate(BOTH, SimpleNamespace(model="both"), stage="judged"), left


@pytest.mark.parametrize(("error", "kept"), [(0.1 / 3.6, BOTH[1:]), (0.1 / 3.8, BOTH)])
def test_a_law_that_its_own_error_does_not_tell_from_none_is_not_named(selected, error, kept):
    """By odds of a thousand: 3.7 standard errors."""
    found = kept_of(selected[0], lambda fitted: model(error, 1e-3))
    assert found.selected.laws == kept
    assert kept == BOTH or "zero within its error" in found.candidates[BOTH].why


def test_it_stays_where_more_than_noise_is_left_without_it(selected):
    chosen, left = selected
    left.mismatch = {"constant-force"}
    assert kept_of(chosen, lambda fitted: model(1.0, 1e-3)).selected.laws == BOTH
    left.mismatch, left.unfit = set(), {"constant-force"}
    assert kept_of(chosen, lambda fitted: model(1.0, 1e-3)).selected.laws == BOTH


def test_of_two_weak_ones_the_weaker_goes_and_the_other_stays_as_the_only_one(selected):
    found = kept_of(selected[0], lambda fitted: model(0.05, 4.0))
    assert found.selected.laws == ("constant-force",)


def test_where_none_simulates_finely_all_stay(selected):
    def never(_fitted):
        raise BadInput("nothing simulates")

    assert kept_of(selected[0], never).selected.laws == BOTH


def test_one_law_alone_is_not_asked(selected):
    alone = replace(selected[0], laws=("quadratic-drag",))
    assert kept_of(alone, lambda fitted: model(np.inf, np.inf)).selected is alone


@pytest.mark.parametrize(("error", "told"), [(0.1 / 1.9, True), (0.1 / 2.0, False)])
def test_a_law_whose_strength_its_own_error_leaves_open_is_not_named(error, told):
    said = of_unknown_size(model(error, 0.01), BOTH)
    assert list(said) == (["constant-force"] if told else [])
    assert all(sentence.startswith(f"{law} is in the model and not named") for law, sentence in said.items())


# --- plainer laws

FS, SECONDS, NOISE = 500.0, 4.0, 2e-6
STIFFNESS, DAMPING = 4.0 * TRUTH["omega0"] ** 2, 20.0
PAIR, SINE = ("two-sided-stop",), ("softening-stiffness/sine",)


def stopped(beside: dict[str, dict[str, float]] | None = None, /, **stops: float) -> tuple[Fitted, Data]:
    """A sweep between stops, and the pair fitted to it from where they are, beside other laws."""
    model = Oscillator.from_values({name: value for name, value in TRUTH.items() if name != "cubic"} | {"cubic": 0.0})
    pair = with_term(model, PAIR[0], {"stiffness": STIFFNESS, "damping": DAMPING} | stops)
    for name, values in (beside or {}).items():
        pair = with_term(pair, name, values)
    force = chirp(1.0, 8.0, 18.0, np.arange(round(FS * SECONDS)) / FS, 1 / FS)[:, 0]
    response = dashpot.simulate(pair, force=force, fs=FS, hold="linear").response
    response = response + NOISE * np.random.default_rng(0).standard_normal(force.size)
    data = data_of([Recording("sweep", FS, response, force, hold="linear")], pair)
    return Structure(pair, data).fit(most=3), data


def searched(fitted: Fitted, data: Data, laws: tuple[str, ...] = PAIR) -> Found:
    weighing = Weighing(data, None, tuple(KNOWN.values()))
    return found_of(weighing.weigh(laws, fitted), weighing)


@pytest.mark.parametrize("side", [1, -1])
def test_of_two_stops_the_one_that_is_touched_is_named(side):
    place = side * 1.2e-3
    fitted, data = stopped(position=4e-3, offset=place - side * 4e-3)
    after = with_plainer_laws(searched(fitted, data))
    plainer = after.selected
    assert plainer.laws == ("one-sided-stop",)
    assert plainer.fit is not None
    found = plainer.fit.model.values()
    assert found["one-sided-stop.position"] == pytest.approx(place, rel=0.01)
    assert found["one-sided-stop.stiffness"] == pytest.approx(STIFFNESS, rel=0.02)
    assert after.candidates[plainer.laws] is plainer
    assert "as one-sided-stop does" in after.candidates[PAIR].why


@pytest.mark.parametrize("offset", [0.0, 2e-4])
def test_stops_that_are_both_touched_stay_a_pair(offset):
    found = searched(*stopped(position=1.2e-3, offset=offset))
    assert with_plainer_laws(found) is found


@pytest.mark.parametrize("laws", [("one-sided-stop", *PAIR), PAIR])
def test_of_two_stops_beside_a_third_neither_takes_its_name(laws):
    """Whether that was found with them or is the given family's: a model has no law twice."""
    third = {"one-sided-stop": {"stiffness": STIFFNESS, "damping": DAMPING, "position": 1.8e-3}}
    found = searched(*stopped(third, position=4e-3, offset=-2.8e-3), laws)
    assert with_plainer_laws(found).selected.laws == laws


def test_a_law_without_cases_stays():
    assert [law.name for law in LIBRARY.values() if law.cases is not None] == list(PAIR)
    found = found_of(Candidate(("quadratic-drag",), stage="judged"), SimpleNamespace(data=None))
    assert with_plainer_laws(found) is found


@pytest.mark.parametrize(
    ("position", "offset", "cases"),
    [(2.0, 0.5, [2.5, -1.5]), (2.0, 3.0, [5.0]), (2.0, -3.0, [-5.0])],
)
def test_each_case_has_the_stop_on_its_own_side(position, offset, cases):
    """Two stops on one side of the middle: the nearer one pushes away from it, which no single stop does."""
    made = find(PAIR[0]).cases
    assert made is not None
    given = {"stiffness": 7.0, "damping": 3.0, "position": position, "offset": offset}
    single = [("one-sided-stop", {"stiffness": 7.0, "damping": 3.0, "position": place}) for place in cases]
    assert made(given) == [*single, ("clearance", {"stiffness": 7.0, "gap": position})]


@pytest.mark.parametrize(("damping", "laws"), [(2e-4, ("clearance",)), (2.0, PAIR)])
def test_stops_about_the_middle_that_damp_nothing_are_a_gap(damping, laws):
    found = searched(*stopped(stiffness=0.3 * STIFFNESS, damping=damping, position=1.2e-3, offset=0.0))
    plainer = with_plainer_laws(found).selected
    assert plainer.laws == laws
    if laws != PAIR:
        assert plainer.fit is not None
        assert plainer.fit.model.values()["clearance.gap"] == pytest.approx(1.2e-3, rel=0.01)


def swinging(width: float, unit: str = "rad") -> Found:
    """A pendulum's decay, or that of a detent's other sine, fitted with a width of its own from 2 % beside it."""
    response = Response("displacement", unit)
    values = {"omega0": 0.3, "cubic": 0.0, "preload": 0.0, "viscous": 0.02, "dry": 0.05}
    truth = with_term(Oscillator.from_values(values, response=response), SINE[0], {"stiffness": 32.0, "width": width})
    decay = dashpot.simulate(truth, initial=(2.0 * width, 0.0), seconds=20.0, fs=60.0).response
    decay = decay + 1e-3 * np.random.default_rng(3).standard_normal(decay.size)
    data = data_of([Recording("decay", 60.0, decay, unit=unit, free=True)], truth)
    near = with_term(
        Oscillator.from_values(values | {"omega0": 1.6, "cubic": -0.2 / width**2}, response=response),
        SINE[0],
        {"stiffness": 29.5, "width": 0.98 * width},
    )
    return searched(Structure(near, data).fit(most=8), data, SINE)


@pytest.mark.parametrize(("width", "unit", "told"), [(1.0, "rad", True), (0.5, "rad", False), (1.0, "m", False)])
def test_the_sine_of_a_pendulums_own_angle_has_no_width_to_be_fitted(width, unit, told):
    found = swinging(width, unit)
    assert f"{SINE[0]}.width" in found.fitted.free
    after = with_plainer_laws(found)
    plainer = after.selected
    assert plainer.fit is not None
    assert (f"{SINE[0]}.width" not in plainer.fit.free) is told
    if told:
        found = plainer.fit.model.values()
        assert found[f"{SINE[0]}.width"] == 1.0
        assert found[f"{SINE[0]}.stiffness"] + found["omega0"] ** 2 == pytest.approx(32.09, rel=5e-3)
        assert found[f"{SINE[0]}.stiffness"] == pytest.approx(32.0, rel=0.02)
        assert after.candidates[SINE] is plainer


# --- whole recordings in one run

MOTION = np.sin(0.1 * np.arange(400))
THREE, TWO = ("a", "b", "c"), ("a", "b")


def candidate(laws, stage="judged"):
    return Candidate(laws, SimpleNamespace(model=laws), stage=stage)


@dataclass
class Whole:
    """Recordings uncut, as far as they are asked for."""

    segments: list
    memory: float = 1.0


@pytest.fixture
def leaving(monkeypatch):
    """``leaving(parts)``: what each structure leaves of the motion of two recordings, of one size or of two."""

    def set_up(parts):
        def judged(model, _data):
            sizes = np.broadcast_to(parts[model], 2)
            return SimpleNamespace(residuals=[size * MOTION for size in sizes])

        monkeypatch.setattr(simplify, "judged", judged)
        return SimpleNamespace(segments=[SimpleNamespace(response=scale * MOTION) for scale in (1.0, 5.0)])

    return set_up


def test_each_recording_counts_by_the_part_of_its_own_motion(leaving):
    whole = leaving({TWO: (0.1, 0.5)})
    about = np.log(np.mean(MOTION**2) / np.var(MOTION))
    assert left_of(candidate(TWO), whole) == pytest.approx(2 * math.log(0.1) + about)


@pytest.mark.parametrize(("with_it", "kept"), [(0.0501, THREE), (0.0499 * 1.005, THREE), (0.0506, TWO), (0.5, TWO)])
def test_a_law_goes_with_which_the_whole_is_told_worse_by_what_matters(leaving, with_it, kept):
    whole = leaving({THREE: with_it, TWO: 0.05, ("b", "c"): 0.2, ("a",): 0.3, ("b",): 0.4})
    known = [candidate(TWO), candidate(("b", "c")), candidate(("a",)), candidate(("b",))]
    after = best_in_one_run(found_of(candidate(THREE), None, known), whole)
    assert after.selected.laws == kept
    assert bool(after.candidates[THREE].why) is (kept == TWO)


def test_one_after_another_goes_and_one_stays(leaving):
    whole = leaving({THREE: 0.4, TWO: 0.3, ("a",): 0.2})
    found = found_of(candidate(THREE), None, [candidate(laws) for laws in (TWO, ("a",), ())])
    assert best_in_one_run(found, whole).selected.laws == ("a",)


@pytest.mark.parametrize("in_pieces", [True, False])
def test_nothing_ends_with_more_left_than_what_it_contains(leaving, monkeypatch, in_pieces):
    """Whichever recordings were held out: a race far from the noise may have weighed frequencies by the mismatch."""
    whole = leaving({THREE: 0.06, TWO: 0.05, ("a",): 0.2})
    for step in ("with_rivals_fitted", "with_most_probable", "with_plainer_laws"):
        monkeypatch.setattr(simplify, step, lambda found, *_: found)
    monkeypatch.setattr(simplify, "leaves_mismatch", lambda *_: True)
    monkeypatch.setattr(simplify, "cut_for", lambda *_: Whole(whole.segments))
    case = SimpleNamespace(in_pieces=in_pieces, family=None, uncut=(), model=None)
    weighing = SimpleNamespace(parts=(), data=SimpleNamespace(memory=np.inf))
    found = found_of(candidate(THREE), weighing, [candidate(TWO), candidate(("a",))])
    assert simplify.simplify(case, found, lambda *_: None, TimeAllowed()).selected.laws == TWO


@pytest.mark.parametrize("stage", ["left", "simulated"])
def test_what_was_never_weighed_replaces_nothing(leaving, stage):
    whole = leaving({THREE: 0.4, TWO: 0.1})
    found = found_of(candidate(THREE), None, [candidate(TWO, stage)])
    assert best_in_one_run(found, whole).selected.laws == THREE
