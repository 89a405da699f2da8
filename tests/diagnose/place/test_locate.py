"""Where the mismatch lies: concealed rigs of another integrator, and what their sentences must say."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.place.locate import locate
from dashpot.diagnose.result import RecordFit
from dashpot.diagnose.wording import quantity
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator, Response


def found(case):
    """Location by the family's own best fit."""
    data = data_of(case.training, case.model)
    return locate(Structure(case.model, data).fit(settle=True, most=40), data)


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


def test_drag_grows_with_speed_at_every_displacement(rig):
    where = found(rig("single", "quadratic-drag"))
    assert where.path == "dissipation"
    assert "grows faster with speed" in where.statement
    assert where.displacement[0] < 0 < where.displacement[1]


def test_a_constant_force_is_told_with_its_size(rig):
    case = rig("single", "constant-force")
    where = found(case)
    assert where.path == "restoring"
    assert "constant pull" in where.statement
    assert where.harmonics[0] > 0.7


def test_a_tone_is_told_with_its_frequency(rig):
    case = rig("single", "tonal-disturbance")
    where = found(case)
    assert where.path == "environment"
    tone = case.truth["parameters"]["tone_omega"] / (2 * np.pi)
    assert where.frequency_hz == pytest.approx((tone, tone), rel=0.01)


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


# --- a missing force put in by hand

SIZE, PACE, NOISE = 6e-3, 80.0, 2e-6
MODEL = Oscillator.from_values(TRUTH)


@pytest.fixture
def located(monkeypatch):
    """``located(*stretches)``: where the mismatch of two recordings lies whose equation lacks what these do."""

    def locate_in(*stretches, evidence=1.0, values=None, problem=None):
        def lacking(model, data):
            if problem is not None:
                raise problem
            return list(stretches), evidence

        monkeypatch.setattr("dashpot.diagnose.place.locate.equation_error", lacking)
        recordings = [
            SimpleNamespace(name="loud", fs=500.0, start=2.0, duration=12.0),
            SimpleNamespace(name="quiet", fs=200.0, start=1.0, duration=9.0),
        ]
        data = SimpleNamespace(
            recordings=recordings,
            scales=SimpleNamespace(length=SIZE, omega=PACE),
        )
        model = MODEL if values is None else Oscillator.from_values(TRUTH | values)
        records = [
            RecordFit(name, False, times * NOISE, 0.0, NOISE, *[np.zeros(0)] * 4, None, Response())
            for name, times in (("loud", 30.0), ("quiet", 3.0))
        ]
        return locate(Fitted(model, np.zeros((2, 2)), (), 0.0, ()), data, records)  # pyright: ignore[reportArgumentType]

    return locate_in


def nowhere(where):
    """Whether all that was recorded is given as the place."""
    assert (where.path, where.harmonics, where.recordings) == ("unknown", {}, ("loud", "quiet"))
    assert where.displacement == (-SIZE, SIZE)
    assert where.velocity == (-SIZE * PACE, SIZE * PACE)
    assert where.amplitude == (0.0, SIZE)
    assert where.frequency_hz == (0.0, 250.0)
    assert where.time_s == (1.0, 14.0)
    return True


def drag(s):
    return 60.0 * s.v * np.abs(s.v)


@pytest.mark.parametrize(("evidence", "located_at"), [(0.014, "unknown"), (0.016, "dissipation")])
def test_a_missing_force_gains_a_hundredth_a_sample(located, stretch, evidence, located_at):
    """That is 2 % of the noise's power, which is known no better."""
    where = located(stretch(drag, name="loud"), evidence=evidence)
    assert where.path == located_at
    assert where.path != "unknown" or nowhere(where)
    assert "response off by up to 30 times the noise, in loud" in where.statement


def test_where_it_cannot_be_told_that_is_said_with_the_widest_ranges(located, stretch):
    for where, words in (
        (located(values={"dry": float("inf")}), "values that are no numbers"),
        (located(problem=BadInput("it does not oscillate")), "it does not oscillate"),
        (located(), "move too little or for too few cycles"),
        (located(stretch(name="loud"), stretch(name="quiet", seed=1)), "too little stands out of the noise in any one"),
    ):
        assert words in where.statement
        assert nowhere(where)


def test_a_drag_is_placed_by_the_motion_that_it_acts_on(located, stretch):
    loud = stretch(drag, name="loud")
    where = located(loud)
    assert where.path == "dissipation"
    assert where.recordings == ("loud",)
    assert "resistance that grows faster with speed" in where.statement
    assert "; in loud (" in where.statement
    assert where.statement.endswith("(response off by up to 30 times the noise, in loud)")
    assert where.velocity == pytest.approx((np.min(loud.v), np.max(loud.v)), rel=0.1)
    assert where.displacement == pytest.approx((np.min(loud.x), np.max(loud.x)), rel=0.1)
    assert where.amplitude[1] == pytest.approx(np.max(loud.amplitude), rel=0.02)
    assert where.amplitude[0] > 0.2 * np.max(loud.amplitude)  # a drag is nothing where the motion is small
    assert where.time_s[0] < 1.0 < 11.0 < where.time_s[1] < 12.0
    assert where.harmonics[3] > 3 * where.harmonics[2]


def test_a_stop_narrows_the_displacement_to_where_it_acts(located, stretch):
    where = located(stretch(lambda s: 4e3 * np.maximum(s.x - 2e-3, 0.0), name="loud"))
    assert where.path == "restoring"
    assert where.displacement == pytest.approx((2e-3, 5e-3), abs=1e-4)


def test_a_tone_narrows_the_frequency(located, stretch):
    where = located(stretch(lambda s: 0.3 * np.cos(2 * np.pi * 3.37 * s.time), name="loud"))
    assert where.path == "environment"
    assert where.frequency_hz == pytest.approx((3.37, 3.37), abs=0.05)


def test_ranges_in_which_nothing_stands_out_are_those_of_all(located, stretch, monkeypatch):
    """Beyond the noise in the whole, and in no part of any coordinate."""
    monkeypatch.setattr("dashpot.diagnose.place.locate.excess_range", lambda *_: None)
    loud = stretch(drag, name="loud")
    where = located(loud)
    assert where.displacement == (np.min(loud.x), np.max(loud.x))
    assert where.velocity == (np.min(loud.v), np.max(loud.v))
    assert (where.amplitude, where.frequency_hz, where.time_s) == ((0.0, SIZE), (0.0, 250.0), (1.0, 14.0))
