"""The experiment that tells models apart, held against fits to recordings of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.experiment.excitations import BEYOND, Limits
from dashpot.diagnose.experiment.next_experiment import next_experiment
from dashpot.diagnose.experiment.rehearsal import rehearse
from dashpot.identify.data import data_of
from dashpot.identify.structure import Structure
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
