"""What the measuring chain does is said as such, with its value, and only where it was taken off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.family import family_of
from dashpot.diagnose.measuring_chain import agree, drifts, drifts_and_loads, hold_of, known_faults, zeros
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.offset import FoundOffset
from dashpot.identify.signals.signals import response_of
from dashpot.model import Oscillator, Provenance
from dashpot.recording import Recording

MODEL = Oscillator.from_values(TRUTH)


def quiet(name="run", **changed):
    noise = 1e-6 * np.random.default_rng(0).standard_normal(4000)
    sine = 1e-3 * np.sin(80 * np.arange(4000) / 500)
    return Recording(name, 500.0, sine + noise, **changed)


@pytest.mark.parametrize(("value", "said"), [(0.9e-6, False), (1.2e-6, True)])
def test_a_zero_is_said_where_it_exceeds_the_noise(value, said):
    facts = zeros([quiet(), quiet("second")], {1: value})
    assert [fact.file for fact in facts] == ["second"] * said
    assert all(fact.value == value and fact.unit == "m" and fact.what == "offset" for fact in facts)


def test_drifts_and_load_cells_bear_their_units():
    recordings = [quiet(), quiet("pushed", force=np.ones(4000))]
    offsets = [FoundOffset(0, "drift", 2e-5, 1e-6), FoundOffset(1, "force", 1.5, 0.1), FoundOffset(1, "response", 1, 1)]
    drift, load = drifts_and_loads(recordings, offsets)
    assert (drift.what, drift.file, drift.value, drift.unit) == ("drift", "run", 2e-5, "m/s")
    assert (load.what, load.file, load.value, load.unit) == ("force-offset", "pushed", 1.5, "N")
    assert "its load cell shows 1.5 N at zero" in load.sentence


def test_a_hold_that_was_found_is_told_from_one_that_was_known():
    found, known = hold_of("zero", found=True), hold_of("zero", found=False)
    assert "held from sample to sample" in found.sentence
    assert "fitted so" in found.sentence
    assert "as the model or --hold says" in known.sentence


def test_a_fault_that_the_model_file_knows_of_is_said_of_that_very_recording():
    entry = {"file": "run", "sha256": "a" * 64, "fault": "from 2 s on the response counts 0.9 times what it should"}
    model = replace(MODEL, identified=Provenance(({"file": "other", "sha256": "b" * 64}, entry)))
    recordings = [quiet("renamed", sha256="a" * 64), quiet("run", sha256="c" * 64), quiet("made")]
    (fact,) = known_faults(model, recordings)
    assert (fact.what, fact.file, fact.value) == ("fault", "renamed", None)
    assert fact.sentence.startswith("renamed: by the model file from 2 s on the response counts 0.9 times")
    assert known_faults(MODEL, recordings) == []


def test_one_load_cell_of_two_that_rests_elsewhere_is_taken_off_and_said(recorded):
    sweeps = [
        recorded(sweep=(level, 5.0, 20.0), seconds=8.0, seed=i, name=f"{i}") for i, level in enumerate((1.0, 0.6))
    ]
    sweeps = [replace(sweep, hold="smooth") for sweep in sweeps]
    sweeps[1] = replace(sweeps[1], force=np.asarray(sweeps[1].force) + 0.1)
    family = family_of(MODEL, sweeps, [])
    (fact,) = family.chain
    assert (fact.what, fact.file) == ("force-offset", "1")
    assert fact.value == pytest.approx(0.1, abs=0.01)
    assert np.mean(family.recordings[1].force) == pytest.approx(np.mean(sweeps[1].force) - 0.1, abs=0.01)


@pytest.mark.parametrize(("part", "said"), [(0.9, False), (1.1, True)])
def test_a_drift_is_said_where_it_moves_the_zero_by_more_than_the_noise(part, said):
    recordings = [quiet(), quiet("second")]
    rate = part * response_of(recordings[1]).noise * 2 / recordings[1].duration
    assert [(fact.file, fact.value) for fact in drifts(recordings, {1: rate})] == [("second", rate)] * said


@pytest.mark.parametrize(("apart", "same"), [(7.3, True), (7.5, False)])
def test_zeros_within_as_many_errors_of_their_mean_as_settle_it_have_one_cause(apart, same):
    found = [FoundOffset(i, "response", value, 1.0) for i, value in enumerate((5.0, 5.0 + apart))]
    assert agree(found, 2) is same
    assert not agree(found, 3)  # a recording without one has none
