"""Each fault of a measuring chain: what it shows of a response, undone again; what it does to force and clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify.faults.fault import Clock, ForceGain, ForceHum, Hum, Late, ResponseGain, ZeroStep
from dashpot.identify.faults.fault_score import KINDS
from dashpot.identify.problem.segments import Segment
from dashpot.simulate.force import force_between

N, DT, BEGIN = 2000, 0.002, 1.0
TIME = BEGIN + np.arange(N) * DT


def drive(t: np.ndarray) -> np.ndarray:
    return np.sin(2 * np.pi * 5.0 * t)


def segment(hold: str = "smooth", highest: float = 20.0) -> Segment:
    response = np.cos(2 * np.pi * 6.0 * TIME)
    return Segment(0, 0, N, response, force_between(drive(TIME), DT, hold, highest), DT, BEGIN, 2 * np.pi * 6.0)


def samples(part: Segment) -> np.ndarray:
    """Of the force."""
    return part.force.pieces[:: part.force.fine, 0]


@pytest.mark.parametrize(
    ("fault", "sizes"),
    [(ResponseGain(0, 2.0), [-0.2]), (Hum(0, 50.0), [0.3, -0.1]), (ZeroStep(0, 2.0), [0.4])],
)
def test_what_is_shown_of_a_response_is_undone_again(fault, sizes):
    sound = segment()
    shown = fault.shown(sound.response, sound, np.array(sizes))
    assert np.max(np.abs(shown - sound.response)) > 0.1
    meant = fault.meant(replace(sound, response=shown), np.array(sizes))
    np.testing.assert_allclose(meant.response, sound.response, atol=1e-12)
    assert meant.force is sound.force


@pytest.mark.parametrize("kind", KINDS)
def test_a_fault_without_size_is_none(kind):
    sound, fault = segment(), kind(0, 2.0)
    none = np.zeros(fault.count)
    meant = fault.meant(sound, none)
    np.testing.assert_allclose(meant.response, sound.response, atol=1e-12)
    np.testing.assert_allclose(samples(meant), samples(sound), atol=1e-12)
    assert meant.dt == sound.dt
    np.testing.assert_array_equal(fault.shown(sound.response, sound, none), sound.response)


@pytest.mark.parametrize("hold", ["smooth", "linear", "zero"])
@pytest.mark.parametrize("highest", [10.0, 60.0])
def test_a_gain_of_the_force_is_taken_off_from_its_time_on(hold, highest):
    meant = ForceGain(0, 2.0).meant(segment(hold, highest), np.array([0.25]))
    wanted = drive(TIME) / np.where(TIME < 2.0, 1.0, 1.25)
    np.testing.assert_allclose(samples(meant), wanted[: samples(meant).size], atol=1e-9)


@pytest.mark.parametrize("by", [0.0034, -0.0061])
def test_a_late_response_was_driven_by_the_force_of_as_much_earlier(by):
    meant = Late(0).meant(segment(), np.array([by]))
    inside = slice(10, -10)
    at = samples(meant).size
    # Hermite through 100 samples a cycle
    np.testing.assert_allclose(samples(meant)[inside], drive(TIME[:at] - by)[inside], atol=1e-6)


def test_a_clock_changes_the_intervals_and_no_value():
    sound = segment()
    meant = Clock(0).meant(sound, np.array([0.01]))
    assert meant.dt == pytest.approx(1.01 * DT)
    short = meant.dt / meant.force.fine
    ends = meant.force.pieces @ short ** np.arange(4)
    np.testing.assert_allclose(ends[:-1], sound.force.pieces[1:, 0], atol=1e-9)


@pytest.mark.parametrize(("size", "way"), [(0.01, "faster"), (-0.01, "slower")])
def test_intervals_that_are_longer_than_stated_make_the_motion_look_faster(size, way):
    assert f"1 ± 0.1 % {way}" in Clock(0).in_words(np.array([size]), np.array([1e-3]), "m", "N")


def test_a_line_on_the_force_is_taken_off_with_all_its_derivatives():
    sizes, turn = np.array([0.3, -0.2]), 2 * np.pi * 17.0
    sound = segment()
    meant = ForceHum(0, 17.0).meant(sound, sizes)
    wanted = sizes[0] * np.sin(turn * TIME) + sizes[1] * np.cos(turn * TIME)
    slope = turn * (sizes[0] * np.cos(turn * TIME) - sizes[1] * np.sin(turn * TIME))
    taken = (sound.force.pieces - meant.force.pieces)[:: sound.force.fine]
    np.testing.assert_allclose(taken[:, 0], wanted[: len(taken)], atol=1e-12)
    np.testing.assert_allclose(taken[:, 1], slope[: len(taken)], atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_is_told_with_its_size(kind):
    fault = kind(0, 12.3)
    sentence = fault.in_words(np.full(fault.count, -0.05), np.full(fault.count, 0.001), (1e3, "mm"), (1.0, "N"))
    assert "record" in sentence or "rate" in sentence
    assert any(figure in sentence for figure in ("0.95", "50", "5", "70.7 mm", "0.0707 N"))
    assert ("12.3" in sentence) == (fault.timed or fault.tonal)
