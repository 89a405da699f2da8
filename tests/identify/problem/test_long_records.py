"""What is done otherwise of a long record gives what is done of a short one, to well below a standard error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.identify.hilbert import forced_regression
from dashpot.identify.problem import linearised, output_error
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals import hilbert
from dashpot.model import Oscillator
from dashpot.simulate import force

SECONDS = 40.0


def taken_for_long(monkeypatch, samples):
    for module in (forced_regression, hilbert, linearised, output_error):
        monkeypatch.setattr(module, "LONG", samples)
    monkeypatch.setattr(force, "_LONG", samples)


def again(recording):
    """The same, of which nothing has been measured."""
    return replace(recording)


@pytest.mark.parametrize(
    ("quantity", "sweep", "begin"),
    [
        ("displacement", (1.0, 5.0, 20.0), (0.0, 0.0)),
        ("acceleration", (1.0, 5.0, 20.0), (0.0, 0.0)),
        ("velocity", None, (9e-3, 0.0)),
    ],
)
def test_a_long_record_gives_what_it_gives_as_a_short_one(monkeypatch, quantity, sweep, begin):
    drive = {"sweep": sweep, "force_noise": 1e-3} if sweep else {}
    recording = recording_of(
        begin=begin, fs=1000.0, seconds=SECONDS if sweep else 4.0, quantity=quantity, noise=1e-4, name="run", **drive
    )
    short = identify([recording])
    taken_for_long(monkeypatch, 2000)
    long = identify([again(recording)])
    for name, known in short.oscillator.parameters().items():
        found = long.oscillator.parameters()[name]
        assert abs(found.value - known.value) <= 0.01 * (known.std or 0.0), name
        if known.std is not None:  # of 60 draws and of as many a variance is good to a fifth
            assert found.std == pytest.approx(known.std, rel=0.35 if sweep else 1e-3), name
            assert abs(found.value - TRUTH[name]) < 5 * (found.std or 0.0), name
    assert long.fit.log_likelihood == pytest.approx(short.fit.log_likelihood, rel=1e-6)


def test_a_long_record_with_a_zero_of_the_load_cell_gives_what_it_gives_as_a_short_one(monkeypatch):
    clean = recording_of(sweep=(1.0, 5.0, 20.0), fs=1000.0, seconds=10.0, noise=2e-6, name="sweep")
    off = replace(clean, force=np.asarray(clean.force) + 0.15)
    short = identify([off])
    taken_for_long(monkeypatch, 2000)
    long = identify([again(off)])
    for name, known in short.oscillator.parameters().items():
        found = long.oscillator.parameters()[name]
        assert found.value == pytest.approx(known.value, abs=0.02 * (known.std or 0.0)), name
        assert found.std == pytest.approx(known.std, rel=0.35), name
        assert abs(found.value - TRUTH[name]) < 5 * (found.std or 0.0), name
    (zero,), (expected,) = ([o for o in found.fit.offsets if o.channel == "force"] for found in (long, short))
    assert zero.value == pytest.approx(expected.value, abs=0.02 * expected.std)
    assert abs(zero.value - 0.15) < 5 * zero.std


@pytest.mark.parametrize("memory", [FREE, 8.0])
def test_the_jacobian_of_a_long_record_is_that_of_a_short_one(monkeypatch, memory):
    """With zeros of the force and of the sensor and a drift, each unknown after the others at one point."""
    recording = recording_of(sweep=(1.0, 5.0, 20.0), begin=(1e-3, 0.0), fs=1000.0, seconds=6.0, noise=2e-6)
    model = Oscillator.from_values(TRUTH)
    offsets = (Offset(0, "force", 1e-3, 0.1), Offset(0, "response", 1e-5, 2e-5), Offset(0, "drift", 1e-5, 1e-5, 3.0))
    structure = Structure(model, data_of([recording], model, coarse=False), offsets=offsets)
    problem, state = structure.problem.predicting(memory), structure.state(None)
    (segment,) = problem.segments
    assert not segment.rests  # its initial states are among the unknowns
    residuals = problem.residuals(state)
    (short,) = problem.derivatives(state, residuals)
    assert np.all(np.any(short != 0.0, axis=1))
    monkeypatch.setattr(output_error, "LONG", 100)
    for _ in range(2):  # computed, then as they were kept
        (long,) = problem.derivatives(state, residuals)
        assert np.max(np.abs(long - short) / np.max(np.abs(short), axis=1, keepdims=True)) < 1e-6


def test_its_noise_is_that_which_scipy_measures(monkeypatch):
    random = np.random.default_rng(0)
    signal = np.cumsum(1e-2 * random.standard_normal(30_001)) + random.standard_normal(30_001)
    known = hilbert.noise_level(signal, 500.0)
    monkeypatch.setattr(hilbert, "LONG", 1000)
    assert hilbert.noise_level(signal, 500.0) == pytest.approx(known, rel=1e-12)


def test_what_is_known_of_one_point_is_not_told_of_another(monkeypatch):
    recording = recording_of(sweep=(1.0, 5.0, 20.0), fs=1000.0, seconds=10.0, noise=2e-6)
    model = Oscillator.from_values(TRUTH)
    problem = Structure(model, data_of([recording], model, coarse=False)).problem

    def derived(problem, state):
        return problem.derivatives(state, problem.residuals(state))[0]

    here = Structure(model, data_of([recording], model, coarse=False)).state(None)
    moved = type(here)(here.values * (1.0 + 1e-3), here.initial, here.offsets)
    asked = [(problem, here), (problem, moved), (problem.predicting(8.0), here), (problem.coarsely(), here)]
    expected = [derived(*one) for one in asked]
    monkeypatch.setattr(output_error, "LONG", 1000)
    for one, rows in zip([*asked, *asked], [*expected, *expected], strict=True):
        for _ in range(2):
            found = derived(*one)
            size = np.max(np.abs(rows), axis=1, keepdims=True)
            assert np.max(np.abs(found - rows) / np.where(size > 0, size, 1.0)) < 1e-6
    single = problem.derivatives(here, problem.residuals(here), single=True)[0]
    assert single.dtype == np.float32
