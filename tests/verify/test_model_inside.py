"""The model inside an FMU: what it says of its errors, and when its core stands in for the FMU."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.replay import Replay, force_of, replayed
from dashpot.model import Oscillator
from dashpot.model.file import dumps
from dashpot.model.oscillator import Provenance
from dashpot.model.parameter import Parameter
from dashpot.verify.model_inside import SAME, covariance_of, model_inside, twin_of

MODEL = Oscillator.from_values(TRUTH)


def test_a_model_file_is_read_and_anything_else_is_no_model(tmp_path):
    path = tmp_path / "model.yaml"
    assert model_inside(path) is None
    path.write_text("a: [1, 2", encoding="utf-8")
    assert model_inside(path) is None
    path.write_text("#" * 10_000_000, encoding="utf-8")
    assert model_inside(path) is None
    path.write_text(dumps(MODEL), encoding="utf-8")
    assert model_inside(path).values() == MODEL.values()


def test_the_covariance_is_that_of_the_file_then_standard_errors_then_none():
    stated = {name: replace(MODEL.parameters()[name], std=std) for name, std in (("mass", 9.0), ("dry", 2.0))}
    told = Provenance(parameters=("omega0", "mass"), covariance=((4.0, 1.0), (1.0, 25.0)))
    model = replace(MODEL.with_parameters(stated), identified=told)
    found = covariance_of(model, ("mass", "omega0", "cubic", "dry"))
    assert found == pytest.approx(np.array([[25.0, 1.0, 0, 0], [1.0, 4.0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 4.0]]))
    assert isinstance(model.mass, Parameter)


@pytest.mark.parametrize(("apart", "same"), [(0.9 * SAME, True), (1.1 * SAME, False)])
def test_the_core_stands_in_where_it_gives_the_fmus_response(recorded, apart, same):
    record = recorded(sweep=(1.0, 8.0, 18.0), seconds=3.0)
    replay = replayed(MODEL, record)
    response = replay.response + apart * 1e-6  # what the FMU would give beside the core
    shown = Replay(replay.initial, response, replay.zero)
    twin = twin_of(MODEL, record, force_of(record), shown, 1e-6)
    assert (twin is not None) == same
    assert twin is None or twin.exact


def test_no_core_stands_in_for_an_fmu_without_a_model_or_with_other_states(recorded):
    record = recorded(begin=(8e-3, 0.0), seconds=3.0)
    replay = replayed(MODEL, record)
    assert twin_of(None, record, None, replay, 1e-6) is None
    assert twin_of(MODEL, record, None, replace(replay, initial=np.zeros(3)), 1e-6) is None
