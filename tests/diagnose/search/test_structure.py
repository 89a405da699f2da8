"""Structures over data: where a mass is at rest, and what becomes of a model that does not simulate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.weigh import judged
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Structure, parameter_bounds
from dashpot.identify.start.measured_motion import probes
from dashpot.model.laws import LIBRARY
from dashpot.model.terms import with_term


def test_a_mass_at_rest_under_an_offset_sensor_is_at_rest(rig):
    case = rig("none")
    offset = 0.2 * float(np.max(np.abs(case.training[0].response)))
    shifted = [replace(r, response=np.asarray(r.response) + offset) for r in case.training]
    data = data_of(shifted, case.model)
    assert not any(segment.rests for segment in data.segments)
    model = with_term(case.model, "sensor-offset", {"offset": offset})
    rests = [segment.rests for segment in Structure(model, data).segments]
    assert rests == [segment.rests for segment in data_of(case.training, case.model).segments]
    assert any(rests)


def test_a_recording_through_which_a_model_does_not_simulate_is_not_told_at_all(rig):
    case = rig("none")
    holdout = data_of(case.holdout, case.model)
    cubic = case.model.parameters()["cubic"]
    size = float(np.max(np.abs(case.training[0].response)))
    falling = replace(cubic, value=-3.0 * case.model.omega0.value**2 / size**2)
    told = judged(case.model.with_parameters({"cubic": falling}), holdout)
    assert np.isfinite(told.likelihood)
    assert told.likelihood < judged(case.model, holdout).likelihood
    assert any(r is s.response for r, s in zip(told.residuals, holdout.segments, strict=True))


@pytest.mark.parametrize("law", LIBRARY)
def test_a_search_may_begin_at_every_probe_of_a_law(rig, law):
    case = rig("none")
    data = data_of(case.training, case.model, lines=(50.0,))
    for probe in probes(LIBRARY[law], data.scales):
        model = with_term(case.model, law, probe)
        low, high = parameter_bounds(model, data.scales)
        values = np.array(list(model.values().values()))
        own = [name.startswith(f"{law}.") for name in model.values()]
        assert np.all((low <= values)[own])
        assert np.all((values <= high)[own])


def test_the_middle_between_stops_lies_within_the_motion(rig):
    """A stop far outside, hardly stiff, would be a constant force under a wrong name."""
    case = rig("none")
    data = data_of(case.training, case.model)
    model = with_term(case.model, "two-sided-stop", {"stiffness": 1.0, "position": 1e-3, "damping": 0.0, "offset": 0.0})
    place = list(model.parameters()).index("two-sided-stop.offset")
    low, high = parameter_bounds(model, data.scales)[:, place]
    assert (low, high) == (-data.scales.length, data.scales.length)
