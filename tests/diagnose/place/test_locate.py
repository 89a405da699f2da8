"""Where the mismatch lies: concealed rigs of another integrator, and what their sentences must say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.locate import locate
from dashpot.diagnose.wording import quantity, spoken
from dashpot.identify.data import data_of
from dashpot.identify.structure import Fitted, Structure


def found(case):
    """Location by the family's own best fit."""
    data = data_of(case.training, case.model)
    return locate(Structure(case.model, data).fit(settle=True, most=40), data)


@pytest.mark.long  # of each sentence a case by hand: test_statement.py
def test_a_stop_is_beyond_its_position_and_on_its_side(rig):
    case = rig("single", "one-sided-stop", variants=("elastic",))
    where = found(case)
    stops = {key: value for key, value in case.truth["parameters"].items() if key.endswith("_at")}
    ((side, position),) = stops.items()
    assert where.path == "restoring"
    low, high = where.displacement
    if side.startswith("up"):
        assert low == pytest.approx(position, rel=0.25)
        assert "on the positive side" in where.statement
    else:
        assert high == pytest.approx(-position, rel=0.25)
        assert "on the negative side" in where.statement
    assert where.harmonics[0] + where.harmonics[2] > 0.3


@pytest.mark.long
def test_drag_grows_with_speed_at_every_displacement(rig):
    where = found(rig("single", "quadratic-drag"))
    assert where.path == "dissipation"
    assert "grows faster with speed" in where.statement
    assert where.displacement[0] < 0 < where.displacement[1]


@pytest.mark.long
def test_a_constant_force_is_told_with_its_size(rig):
    case = rig("single", "constant-force")
    where = found(case)
    assert where.path == "restoring"
    assert "constant pull" in where.statement
    assert where.harmonics[0] > 0.7


@pytest.mark.long
def test_a_tone_is_told_with_its_frequency(rig):
    case = rig("single", "tonal-disturbance")
    where = found(case)
    assert where.path == "environment"
    tone = case.truth["parameters"]["tone_omega"] / (2 * np.pi)
    assert where.frequency_hz == pytest.approx((tone, tone), rel=0.01)


@pytest.mark.long
def test_a_delay_enters_with_the_force(rig):
    where = found(rig("single", "time-delay"))
    assert where.path == "excitation"
    assert "forced recordings" in where.statement
    assert "ms after" in where.statement


def test_nothing_missing_is_said_so(rig):
    where = found(rig("none"))
    assert where.path == "unknown"
    assert "stands out of the noise" in where.statement
    assert len(where.recordings) == 3


def test_a_model_that_does_not_move_gives_the_widest_ranges(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    nothing = tuple(np.full(s.n, np.nan) for s in data.segments)
    broken = case.model.with_parameters({"viscous": replace(case.model.viscous, value=float("nan"))})
    where = locate(Fitted(broken, np.zeros((3, 2)), nothing, -np.inf, ()), data)
    assert where.path == "unknown"
    assert where.displacement == (-data.scales.length, data.scales.length)


def test_numbers_read_well():
    assert quantity(4.1e-3, "m") == "4.1 mm"
    assert quantity(2.5, "m/s2") == "2.5 m/s2"
    assert spoken(["a", "b", "c"]) == "a, b and c"
