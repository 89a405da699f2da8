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


@pytest.mark.parametrize(("samples", "counts"), [(1, False), (2, True)])
def test_a_piece_of_two_samples_counts(samples, counts):
    """A sample between two gaps has no spacing of its own."""
    early, late = record(1e-3), record(1e-3, start=100.0)
    lone = 50.0 + np.arange(samples) / FS
    time = np.concatenate([early.time, lone, late.time])
    y = np.concatenate([early.measured, np.full(samples, 4e-3), late.measured])
    joined = RecordFit("j", False, 0.1, 0.1, 0.01, time, y, y, y, None, early.response)
    top = recorded_ranges([joined], model()).displacement
    assert top is not None
    assert top[1] == pytest.approx(4e-3 if counts else 1e-3, rel=0.01)


@pytest.mark.parametrize(("times", "apart"), [(1.4, False), (1.6, True)])
def test_a_gap_is_a_spacing_half_as_large_again(times, apart):
    """Across a step of the motion no velocity is taken where the record has a gap."""
    one = record(1e-3)
    time = one.time.copy()
    time[2500:] += (times - 1.0) / FS
    y = one.measured + np.where(np.arange(time.size) < 2500, 0.0, 5e-3)
    joined = RecordFit("j", False, 0.1, 0.1, 0.01, time, y, y, y, None, one.response)
    velocity = recorded_ranges([joined], model()).velocity
    assert velocity is not None
    assert (velocity[1] < 2e-3 * OMEGA) is apart


def test_free_motion_covers_the_middle_nine_tenths_of_its_frequencies_while_it_is_large():
    """From 8 to 12 Hz at one amplitude; what comes after at a twentieth of it tells nothing."""
    t = np.arange(5000) / FS
    rate = 8.0 + 0.4 * t
    x = 1e-3 * np.cos(2 * np.pi * (8.0 * t + 0.2 * t**2))
    x = np.concatenate([x, 5e-5 * np.cos(2 * np.pi * 20.0 * t)])
    time = np.arange(x.size) / FS
    free = RecordFit("f", False, 0.1, 0.1, 0.01, time, x, x, x, None, Response("displacement", "m"))
    expected = np.quantile(rate, [0.05, 0.95])
    assert recorded_ranges([free], model()).frequency_hz == pytest.approx(tuple(expected), abs=0.12)


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_what_is_integrated_does_not_count_for_a_cycle_at_its_ends(quantity):
    """A step in the first cycle is a wandering integral and no motion."""
    plain = record(1e-3, quantity=quantity)
    bent = record(1e-3, quantity=quantity)
    bent.measured[: round(0.5 * FS / 8.0)] *= 3.0
    ranges = [recorded_ranges([one], model(quantity)).displacement for one in (plain, bent)]
    assert ranges[1] == pytest.approx(ranges[0], rel=0.2)
