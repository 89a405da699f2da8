"""The experiment that tells models apart, held against fits to recordings of it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.experiment.excitations import BEYOND, Limits
from dashpot.diagnose.experiment.next_experiment import _pace, _separating, _sharpening, next_experiment
from dashpot.errors import BadInput
from dashpot.foresight.excitation import Excitation
from dashpot.foresight.rehearsal import rehearse
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force

VALUES = {"mass": 0.5, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.5, "dry": 0.06}
FS, NOISE = 600.0, 2e-6


def played(model: Oscillator, force: np.ndarray, seed: int = 0) -> Recording:
    """A recording of a force of 600 samples a second."""
    step = internal_step(model, model.values(), 2e-3)
    values = np.array(list(model.values().values()))
    begin = np.zeros(core_of(model).states)
    x = core_of(model).record(values, begin, smooth_force(force, 1 / FS, 30.0), force.size, 1 / FS, step)
    x = x + NOISE * np.random.default_rng(seed).standard_normal(force.size)
    return Recording(name=f"record-{seed}", fs=FS, response=x, force=force)


@pytest.fixture(scope="module")
def rivals():
    """A drag, the damping of third order that one sweep takes for it, and the data."""
    t = np.arange(int(5 * FS)) / FS
    force = 0.06 * np.sin(2 * np.pi * (7 * t + 0.6 * t**2)) * np.clip(t, 0, 1)
    drag = with_term(Oscillator.from_values(VALUES), "quadratic-drag", {"coefficient": 100.0})
    data = data_of([played(drag, force)], drag)
    start = with_term(Oscillator.from_values(VALUES), "cubic-damping", {"coefficient": 1000.0})
    cubic = Structure(start, data).fit(most=30).model
    return {"quadratic-drag": drag, "cubic-damping": cubic}, data


def test_a_fit_to_the_chosen_recording_differs_by_what_was_promised(rivals):
    models, data = rivals
    plan = next_experiment(models, data)
    assert plan.kind in ("sweep", "multisine", "sine")
    assert plan.signal is not None
    ((name, other, promised),) = plan.separates
    assert (name, other) == ("quadratic-drag", "cubic-damping")
    new = data_of([played(models[name], plan.signal, seed=5)], models[name])
    right = Structure(models[name], new).fit(most=30, tolerance=0.1).residuals[0]
    wrong = Structure(models[other], new).fit(most=30, tolerance=0.1).residuals[0]
    really = np.sqrt(max(float(wrong @ wrong - right @ right), 0.0)) / NOISE
    assert promised > 5
    assert really == pytest.approx(promised, rel=0.35)
    assert "quadratic-drag" in plan.sentence
    assert "cubic-damping" in plan.sentence


def test_it_stays_within_reach_of_what_was_recorded(rivals):
    models, data = rivals
    plan = next_experiment(models, data)
    assert plan.level <= BEYOND * data.scales.force * (1 + 1e-9)
    assert plan.signal.size == round(plan.seconds * plan.fs)
    assert np.max(np.abs(plan.signal)) <= plan.level * (1 + 1e-9)
    moved = played(models["quadratic-drag"], plan.signal).response
    assert np.max(np.abs(moved)) < 1.1 * BEYOND * data.scales.length


def test_the_same_model_twice_is_not_told_apart(rivals):
    models, data = rivals
    drag = models["quadratic-drag"]
    plan = next_experiment({"this": drag, "that": drag}, data)
    assert plan.kind == "none"
    assert plan.separates[0][2] < 1
    assert "No recording" in plan.sentence


def test_one_model_alone_is_sharpened_where_it_is_poor(rivals):
    models, data = rivals
    drag = models["quadratic-drag"]
    known = drag.with_parameters(
        {name: replace(p, std=0.001 * abs(p.value) or 1e-3) for name, p in drag.parameters().items()}
    )
    poor = known.with_parameters({"dry": replace(known.dry, std=0.5 * known.dry.value)})
    plan = next_experiment({"drag": poor}, data)
    assert plan.kind != "none"
    assert "error of dry" in plan.sentence
    assert plan.separates == ()


def test_without_a_force_only_releases_remain(rivals):
    models, data = rivals
    free = {name: replace(model, mass=None) for name, model in models.items()}
    decay = replace(data, segments=tuple(replace(s, force=None, rests=False) for s in data.segments))
    plan = next_experiment(free, decay)
    assert plan.kind in ("decay", "none")
    assert plan.signal is None


def test_a_rig_that_may_hardly_move_gets_no_plan_or_a_small_one(rivals):
    models, data = rivals
    small = Limits(force=data.scales.force, displacement=1e-9, band_hz=(7.0, 13.0))
    assert next_experiment(models, data, limits=small).kind in ("none", "decay")
    assert next_experiment({}, data).kind == "none"


def test_a_rival_that_ran_away_is_left_out(rivals):
    """A resonator a thousand times faster than the rig would take minutes to rehearse."""
    models, data = rivals
    fast = {"mass-ratio": 0.01, "frequency": 1e3 * VALUES["omega0"], "damping": 1.0}
    runaway = with_term(Oscillator.from_values(VALUES), "attached-resonator", fast)
    plan = next_experiment({**models, "attached-resonator": runaway}, data)
    assert plan.kind in ("sweep", "multisine", "sine")
    assert {name for pair in plan.separates for name in pair[:2]} == set(models)


@pytest.mark.parametrize(("times", "planned"), [(38.0, True), (42.0, False)])
def test_a_model_stiffer_than_any_recording_shows_is_rehearsed_no_more(rivals, times, planned, monkeypatch):
    """Forty times the internal steps of a plain oscillator: a contact that rings at a hundred times its frequency."""
    models, data = rivals
    module = "dashpot.diagnose.experiment.next_experiment"
    pace = times * 75.0 * data.scales.omega / (2 * np.pi)
    monkeypatch.setattr(f"{module}._pace", lambda *_: pace)
    rehearsed = []
    monkeypatch.setattr(f"{module}.rehearse", lambda *given: rehearsed.append(given) or rehearse(*given))
    plan = next_experiment({"quadratic-drag": models["quadratic-drag"]}, data)
    assert bool(rehearsed) is planned
    assert ("as stiff as no recording shows" in plan.sentence) is not planned


def test_a_plain_oscillator_takes_seventy_five_steps_a_period():
    """The stiffest that is rehearsed is told in these: the rig's own mode is what they are counted against."""
    plain = Oscillator.from_values(VALUES | {"viscous": 0.0, "dry": 0.0})
    assert _pace(plain, 1e-3) == pytest.approx(75.0 * 60.0 / (2 * np.pi))


@pytest.mark.parametrize(("times", "rehearsed"), [(9.0, True), (11.0, False)])
def test_a_rival_ten_times_as_slow_as_the_first_model_is_not_rehearsed(rivals, times, rehearsed, monkeypatch):
    models, data = rivals
    module = "dashpot.diagnose.experiment.next_experiment"
    seen = []

    def refuse(model, *_):
        seen.append(model)
        raise BadInput("does not simulate")

    def pace(model, reach):
        return (1.0 if model is models["quadratic-drag"] else times) * data.scales.omega

    monkeypatch.setattr(f"{module}._pace", pace)
    monkeypatch.setattr(f"{module}.rehearse", refuse)
    assert "does not simulate beyond the recordings" in next_experiment(models, data).sentence
    assert [model is models["quadratic-drag"] for model in seen] == [True, False][: 1 + rehearsed]


# --- responses put in by hand, whose differences and derivatives are known


def sweep(relative: float) -> Excitation:
    return Excitation("sweep", 0.06 * relative, relative, (7.0, 13.0), 2.0)


def answers(*responses: tuple[float, ...], imitates: float = np.inf) -> SimpleNamespace:
    """A model that answers each plan so, in units of the noise, and has nothing to re-tune."""
    own = tuple(np.array(response) for response in responses)
    return SimpleNamespace(
        responses=own, derivatives=(np.zeros((0, 1)),) * len(own), imitates=lambda other, i: imitates
    )


@pytest.mark.parametrize(("beyond", "chosen"), [(0.98, 1.0), (1.02, 1.5)])
def test_going_beyond_what_was_recorded_has_to_tell_more_by_three_tenths(beyond, chosen):
    """At one and a half times the level the difference counts as if it were 0.7 times as large."""
    played = {"first": answers((0.0,), (0.0,)), "rival": answers((10.0,), (beyond * 10.0 / 0.7,))}
    plans = [sweep(1.0), sweep(1.5)]
    plan = _separating("first", ["rival"], played, plans, [0, 1], Oscillator.from_values(VALUES), FS)  # type: ignore[arg-type]
    assert plan.level == pytest.approx(0.06 * chosen)
    assert ("as much as ever so far" in plan.sentence) is (chosen == 1.0)


def test_the_nearest_of_the_rivals_that_are_told_apart_says_by_how_much():
    """Three responses in a right triangle of 12, 9 and 15; the first rival, re-tuned, comes as near as 8."""
    played = {"first": answers((0.0, 0.0)), "near": answers((12.0, 0.0), imitates=8.0), "far": answers((0.0, 9.0))}
    plan = _separating("first", ["near", "far"], played, [sweep(1.0)], [0], Oscillator.from_values(VALUES), FS)  # type: ignore[arg-type]
    assert plan.separates == (
        ("first", "near", 8.0),
        ("first", "far", pytest.approx(9.0)),
        ("near", "far", pytest.approx(15.0)),
    )
    assert "first then differs from near and far by 8 times the noise or more" in plan.sentence


def separating(played, plans):
    model = Oscillator.from_values(VALUES)
    rivals = [name for name in played if name != "first"]
    return _separating("first", rivals, played, plans, list(range(len(plans))), model, FS)  # type: ignore[arg-type]


def test_a_plan_is_worth_what_it_tells_of_the_nearest_rival():
    """The first tells one rival by far and the other hardly, the second both."""
    played = {
        "first": answers((0.0, 0.0), (0.0, 0.0)),
        "one": answers((100.0, 0.0), (20.0, 0.0)),
        "other": answers((0.0, 8.0), (0.0, 20.0)),
    }
    plan = separating(played, [sweep(1.0), replace(sweep(1.0), band_hz=(8.0, 12.0))])
    assert plan.band_hz == (8.0, 12.0)


def test_a_rival_that_it_does_not_tell_is_named():
    played = {"first": answers((0.0, 0.0)), "clear": answers((20.0, 0.0)), "like": answers((0.0, 0.1))}
    sentence = separating(played, [sweep(1.0)]).sentence
    assert "first then differs from clear by 20 times" in sentence
    assert "it does not tell first from like" in sentence


def test_a_level_beyond_what_was_recorded_is_told_to_two_figures():
    played = {"first": answers((0.0,)), "rival": answers((100.0,))}
    assert "(1.4 times the largest so far)" in separating(played, [sweep(1.4142)]).sentence


def sharpened(information: list[dict[str, float]], plans: list[Excitation], stds: dict[str, float]):
    """What is chosen where each plan tells of each parameter by itself: 1 / its relative error, squared, from it."""
    model = Oscillator.from_values(VALUES)
    model = model.with_parameters(
        {n: replace(p, std=stds.get(n, 0.01) * (abs(p.value) or 1.0)) for n, p in model.parameters().items()}
    )
    parameters = model.parameters()
    derivatives = [
        np.diag([np.sqrt(told.get(n, 0.0)) / (abs(p.value) or 1.0) for n, p in parameters.items()])
        for told in information
    ]
    played = SimpleNamespace(derivatives=derivatives)
    return _sharpening("drag", model, played, plans, range(len(plans)), FS)  # type: ignore[arg-type]


@pytest.mark.parametrize(("part", "told"), [(0.65, True), (0.75, False)])
def test_a_poorly_known_parameter_is_named_where_its_error_shrinks_by_three_tenths(part, told):
    """Precisions add: an error of half the value shrinks to this part of it where (1 / part² - 1) / 0.5² is told."""
    plan = sharpened([{"dry": (1 / part**2 - 1) / 0.25}], [sweep(1.0)], {"dry": 0.5})
    assert (f"it brings the error of dry from 50 to about {100 * 0.5 * part:.2g} %" in plan.sentence) is told
    assert ("sharpens dry most" in plan.sentence) is not told


def test_where_all_is_known_well_the_parameter_that_gains_most_is_named():
    plan = sharpened([{"mass": 1e4, "viscous": 9e4, "dry": 2e4}], [sweep(1.0)], {})
    assert "this tests it hardest and sharpens viscous most" in plan.sentence


@pytest.mark.parametrize(("beyond", "chosen"), [(0.98, 1.0), (1.02, 1.5)])
def test_going_beyond_has_to_sharpen_more_than_what_stays_within(beyond, chosen):
    """What is told beyond what is known: of six errors of 1 % one is halved within."""
    more = beyond * np.log(4.0) / 0.7
    plans = [sweep(1.0), sweep(1.5)]
    plan = sharpened([{"dry": 3e4}, {"dry": 1e4 * np.expm1(more)}], plans, {})
    assert plan.level == pytest.approx(0.06 * chosen)
