"""Laws that act alike: who stands in whose place, and where it begins there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.likeness import alike
from dashpot.identify.data import data_of
from dashpot.identify.structure import Structure
from dashpot.model.laws import find
from dashpot.model.terms import with_term


def fitted(case, law, values):
    """A rig's own law, fitted from the true values, and the data."""
    data = data_of(case.training, case.model)
    truth = case.truth["parameters"]
    names = {"omega0": "omega"} | {name: name for name in ("mass", "cubic", "preload", "viscous", "dry")}
    known = case.model.parameters()
    model = case.model.with_parameters(
        {name: replace(known[name], value=truth[theirs]) for name, theirs in names.items()}
    )
    return Structure(with_term(model, law, values), data).fit(settle=True), data, truth


def test_the_other_stop_takes_the_place_of_one_and_begins_where_it_is(rig):
    case = rig("single", "one-sided-stop")
    truth = case.truth["parameters"]
    side, sign = ("up", 1.0) if "up_at" in truth else ("down", -1.0)
    contact = {"stiffness": truth[f"{side}_stiffness"], "position": sign * truth[f"{side}_at"]}
    fit, data, truth = fitted(case, "one-sided-stop", contact | {"damping": truth[f"{side}_damping"]})
    others = ["two-sided-stop", "quintic-stiffness", "actuator-lag", "attached-resonator"]
    first, *rest = alike(fit, data, "one-sided-stop", [find(name) for name in others])
    assert first.law == "two-sided-stop"
    assert all(other.gain < first.gain for other in rest)
    values = first.model.values()
    assert "one-sided-stop.position" not in values
    assert values["omega0"] == pytest.approx(truth["omega"], rel=0.1)
    assert values["two-sided-stop.position"] == pytest.approx(truth[f"{side}_at"], rel=0.2)


def test_a_delay_takes_the_place_of_a_lag_and_the_motion_begins_as_it_did(rig):
    case = rig("single", "actuator-lag")
    fit, data, truth = fitted(case, "actuator-lag", {"time": case.truth["parameters"]["actuator_lag"]})
    (delay,) = alike(fit, data, "actuator-lag", [find("time-delay")])
    assert delay.model.values()["time-delay.delay"] == pytest.approx(truth["actuator_lag"], rel=0.05)
    amplitude = float(np.max(np.abs(data.segments[-1].response)))
    assert delay.initial[-1, :2] == pytest.approx(fit.initial[-1, :2], abs=0.05 * amplitude * truth["omega"])
    assert delay.initial[-1, 0] == pytest.approx(fit.initial[-1, 0], abs=0.02 * amplitude)
