"""The end of a fit: as finely simulated as what is delivered, whatever searched before."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples import rig
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.fit import reported_result as module
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.fit.reported_result import delivered
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS, SECONDS = 400.0, 40.0
MODEL = Oscillator.from_values(TRUTH)


@cache
def recordings(noise=2e-7):
    """Two sweeps whose force is smooth between its samples, by the reference integrator."""
    made = []
    for seed, level in enumerate((0.3, 1.0)):
        t = np.arange(round(SECONDS * FS)) / FS
        pieces = chirp(level, 5.0, 15.0 / SECONDS, t, 1 / FS)
        x = integrate_pieces(dict(TRUTH), pieces[:-1], 1 / FS, 0.0)[0]
        y = x + noise * np.random.default_rng(seed).standard_normal(t.size)
        made.append(Recording(name=f"sweep {level}", fs=FS, response=y, force=pieces[:, 0]))
    return made


def z_scores(model):
    return np.array([(p.value - TRUTH[name]) / (p.std or np.nan) for name, p in model.parameters().items()])


def test_what_a_coarse_search_leaves_is_brought_to_the_answer_of_the_fine_one():
    """The coarse force alone moves a parameter by more than its error; what is delivered is right."""
    coarse = Structure(MODEL, data_of(recordings(2e-8), MODEL)).fit()
    fit = delivered(coarse.model, data_of(recordings(2e-8), MODEL, coarse=False), initial=coarse.initial)
    errors = np.array([p.std for p in fit.oscillator.parameters().values()])
    far = [coarse.model.values()[name] - value for name, value in TRUTH.items()]
    assert np.max(np.abs(far) / errors) > 4
    assert np.max(np.abs(z_scores(fit.oscillator))) < 3.5


def test_it_ends_where_the_whole_fit_does():
    """From a place nearby, with or without the initial states: value and error of maximum likelihood."""
    known = MODEL.parameters()
    nearby = MODEL.with_parameters({"omega0": replace(known["omega0"], value=1.000001 * known["omega0"].value)})
    data = data_of(recordings(), MODEL, coarse=False)
    whole, fit = maximum_likelihood(nearby, recordings(), data=data), delivered(nearby, data)
    assert fit.names == whole.names
    for name, parameter in whole.oscillator.parameters().items():
        mine = fit.oscillator.parameters()[name]
        assert mine.std == pytest.approx(parameter.std, rel=0.02)
        assert mine.value == pytest.approx(parameter.value, abs=0.1 * parameter.std)


def test_what_is_fixed_stays_and_has_no_error():
    fit = delivered(MODEL, data_of(recordings(), MODEL, coarse=False), ("dry",))
    assert "dry" not in fit.names
    assert fit.oscillator.dry.value == MODEL.dry.value
    assert fit.oscillator.dry.std is None
    assert fit.covariance.shape == (5, 5)


@pytest.mark.parametrize("memory", [8.0, FREE])
def test_it_keeps_the_memory_with_which_the_search_ended(memory):
    assert delivered(MODEL, data_of(recordings(), MODEL, coarse=False), memory=memory).memory == memory


def test_a_place_that_does_not_simulate_is_refused():
    bad = MODEL.with_parameters({"viscous": replace(MODEL.viscous, value=-1e6)})
    with pytest.raises(BadInput, match="no model of this structure simulates"):
        delivered(bad, data_of(recordings(), MODEL, coarse=False))


@pytest.mark.parametrize(("likelihood", "stays"), [(-np.inf, True), (5.0, False)])
def test_a_simulation_stays_where_the_model_runs_away_within_every_memory(monkeypatch, likelihood, stays):
    """That a prediction runs away is no reason to refuse what a simulation tells."""
    problem = Structure(MODEL, data_of(recordings(), MODEL, coarse=False)).problem
    state = SimpleNamespace(values=np.arange(6.0))
    outcome = SimpleNamespace(state=state, residuals=(np.ones(5),))
    free, predicted = (SimpleNamespace(likelihood=x, outcome=outcome) for x in (-9.0, likelihood))
    monkeypatch.setattr(module, "_nearest", lambda *_: None)
    monkeypatch.setattr(module, "whitened", lambda *_, **__: (predicted, 3))
    monkeypatch.setattr(module, "finished", lambda _, answer, *__, **___: (answer, 1))
    monkeypatch.setattr(module, "_simulated", lambda *_: (np.zeros(5),))
    told, answer, doubt, (left,), steps = module._most_likely(problem, free, {}, MODEL, np.inf, 5)
    assert answer is (free if stays else predicted)
    assert (told.memory == FREE) is stays
    assert not np.any(doubt)
    assert np.all(left == (1.0 if stays else 0.0))
    assert steps >= 3


def test_a_force_with_a_constant_part_that_acts_is_no_zero_of_its_cell():
    """A piece of a slow drive has one. What a guess takes off a structure that was right would not come back."""
    t = np.arange(round(SECONDS * FS)) / FS
    force = 2.0 + np.sin(2 * np.pi * (0.3 * t + 0.15 * t**2))
    x = integrate_pieces(dict(TRUTH), force[:-1, None], 1 / FS, 0.0, 0.0)[0]
    y = x + 2e-7 * np.random.default_rng(7).standard_normal(t.size)
    pushed = [Recording("slow", FS, y, force, hold="zero")]
    data = data_of(pushed, MODEL, coarse=False)
    fit = delivered(MODEL, data)
    assert fit.offsets == ()
    assert max(segment.over_noise for segment in fit.segments) < 1.1


def test_what_a_search_came_through_is_forgotten_with_its_segments(monkeypatch):
    """Cut at the end of a fit, no prediction begins where a search over other segments came through its memory."""
    problem, seen = Structure(MODEL, data_of(recordings(), MODEL, coarse=False)).problem, []

    def otherwise(problem, answer, rungs, start, most):
        seen.append((len(problem.segments), rungs))
        return np.zeros(answer.outcome.state.values.size), 0

    state = Structure(MODEL, data_of(recordings(), MODEL, coarse=False)).state(None)
    one = replace(state, initial=state.initial[:1])
    monkeypatch.setattr(module, "smooth_stretches", lambda *_, **__: (problem.segments[:1], one))
    monkeypatch.setattr(module, "over_noise", lambda *_: [9.0])
    monkeypatch.setattr(module, "_said_otherwise", otherwise)
    module.ended(problem, state, MODEL, recordings(), {1.0: state}, np.inf, [])
    assert seen == [(1, {})]


@pytest.mark.parametrize(("reach", "kept"), [(1.0, 1), (1e200, 2)])
def test_a_cut_after_which_the_rest_runs_away_is_not_made(monkeypatch, reach, kept):
    """Begun in the middle, at the reach of a spring that gives way: a recording was refused for it."""
    structure = Structure(MODEL, data_of(recordings(), MODEL, coarse=False))
    problem, state = structure.problem, structure.state(None)
    one = replace(state, initial=reach * np.ones_like(state.initial[:1]) * 1e-3)
    monkeypatch.setattr(module, "smooth_stretches", lambda *_, **__: (problem.segments[:1], one))
    fit = module.ended(problem, state, MODEL, recordings(), {}, np.inf, [])
    assert len(fit.segments) == kept
    assert any("were left out" in note for note in fit.notes) is (kept == 1)


def test_a_jump_that_only_the_end_of_the_search_meets_says_nothing():
    """Bursts of the built-in rig at ten times its noise: for some noises the mass takes off or not by almost nothing
    just at the maximum, where a difference quotient is a jump over a small step. The errors stay those of other noises,
    near the Cramér-Rao bound (benchmarks/cramer_rao.py), and the truth within them.

    Which stretches are left out depends on rounding, so the last digits of the response are drawn three times. With
    those of the second draw the fit once ended where another stretch jumps: an error of the preload 25 times too small.
    No error may be too small, and the middle one must not be too large.
    """
    pieces = rig.force("bursts")
    x = integrate_pieces(dict(TRUTH), pieces, 1 / rig.FS, 0.0)[0][: len(pieces)]
    random = np.random.default_rng([7, 10])
    y = x + 10 * rig.SENSOR_NOISE * random.standard_normal(x.size)
    f = pieces[:, 0] + 10 * rig.FORCE_NOISE * np.max(np.abs(pieces[:, 0])) * random.standard_normal(x.size)
    rounded = [y * (1.0 + 1e-14 * np.random.default_rng(digits).standard_normal(y.size)) for digits in range(3)]
    found = [identify([Recording("bursts", rig.FS, shown, force=f)]).oscillator for shown in rounded]
    usual = {"preload": 1.7e-4, "viscous": 8.5e-4, "dry": 9.5e-5}
    for name, std in usual.items():
        stds = [each.parameters()[name].std or 0.0 for each in found]
        assert 0.7 * std < min(stds), name
        assert np.median(stds) < 1.4 * std, name
    assert max(np.max(np.abs(z_scores(each))) for each in found) < 3.5
