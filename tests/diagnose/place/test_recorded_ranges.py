"""What was recorded altogether, against motions whose extremes are known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.place.recorded_ranges import recorded_ranges
from dashpot.diagnose.result import RecordFit
from dashpot.model import Oscillator, Response

FS, OMEGA = 500.0, 2 * np.pi * 8.0
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


def model(quantity="displacement"):
    values = {"mass": 0.3, "omega0": OMEGA, "viscous": 1.0, "dry": 0.0, "cubic": 0.0, "preload": 0.0}
    return Oscillator.from_values(values, response=Response(quantity, UNITS[quantity]))


def record(size, *, holdout=False, seconds=10.0, forced=True, quantity="displacement", noise=0.0, start=0.0):
    """A sine of the amplitude ``size`` in m, by its displacement, velocity or acceleration."""
    t = start + np.arange(round(seconds * FS)) / FS
    order = ("displacement", "velocity", "acceleration").index(quantity)
    measured = size * OMEGA**order * np.cos(OMEGA * t + order * np.pi / 2)
    measured = measured + noise * np.random.default_rng(1).standard_normal(t.size)
    force = np.cos(OMEGA * t) if forced else None
    shown = Response(quantity, UNITS[quantity])
    return RecordFit("a", holdout, 0.1, 0.1, 0.01, t, measured, measured, measured, force, shown)


@pytest.mark.parametrize("quantity", UNITS)
@pytest.mark.parametrize("largest_is_held_out", [False, True])
def test_the_largest_motion_counts_wherever_it_was_recorded(quantity, largest_is_held_out):
    small = record(1e-3, quantity=quantity, holdout=not largest_is_held_out)
    large = record(7e-3, quantity=quantity, holdout=largest_is_held_out)
    ranges = recorded_ranges([small, large], model(quantity))
    assert ranges.displacement == pytest.approx((-7e-3, 7e-3), rel=0.035)
    assert ranges.velocity == pytest.approx((-7e-3 * OMEGA, 7e-3 * OMEGA), rel=0.03)
    assert ranges.amplitude == pytest.approx((1e-3, 7e-3), rel=0.05)


def test_noise_is_not_taken_for_speed():
    noisy, speed = record(5e-3, noise=4e-5), 5e-3 * OMEGA
    assert np.max(np.gradient(noisy.measured, 1 / FS)) > 1.12 * speed  # sample by sample
    assert recorded_ranges([noisy], model()).velocity == pytest.approx((-speed, speed), rel=0.07)


def test_frequencies_are_those_of_the_forces_and_of_free_motion():
    t = np.arange(5000) / FS
    sweep = np.sin(2 * np.pi * (12 * t + 0.4 * t**2))  # 12 to 20 Hz
    x = record(1e-3)
    forced = RecordFit("s", True, 0.1, 0.1, 0.01, t, x.measured, x.before, x.after, sweep, x.response)
    free = record(1e-3, forced=False)
    assert recorded_ranges([forced], model()).frequency_hz == pytest.approx((12.0, 20.0), rel=0.05)
    assert recorded_ranges([forced, free], model()).frequency_hz == pytest.approx((8.0, 20.0), rel=0.05)


def test_time_is_that_of_all_and_gaps_between_pieces_are_no_motion():
    early, late = record(1e-3), record(1e-3, start=100.0, holdout=True)
    assert recorded_ranges([early, late], model()).time_s == pytest.approx((0.0, 109.998))
    time, y = np.concatenate([early.time, late.time]), np.concatenate([early.measured, -late.measured])
    joined = RecordFit("j", False, 0.1, 0.1, 0.01, time, y, y, y, None, early.response)
    ranges = recorded_ranges([joined], model())
    assert ranges.velocity == pytest.approx((-1e-3 * OMEGA, 1e-3 * OMEGA), rel=0.02)


def test_what_no_recording_tells_is_not_known():
    nothing = recorded_ranges([], model())
    assert (
        nothing.displacement is nothing.velocity is nothing.amplitude is nothing.frequency_hz is nothing.time_s is None
    )
    lost = record(1e-3, seconds=1.0)
    lost.measured[:] = np.nan
    assert recorded_ranges([lost], model()).displacement is None
    still = record(0.0, forced=False, quantity="velocity")
    assert recorded_ranges([still], model("velocity")).displacement is None
    short = record(1e-3, seconds=3 / FS)
    assert recorded_ranges([short], model()).velocity is None
