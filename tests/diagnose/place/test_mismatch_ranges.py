"""Ranges, harmonic orders and tones of a missing force that was put in by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.free_form import rows_of
from dashpot.diagnose.place.mismatch_ranges import excess_range, line_in, orders, where_it_is


def x_of(rows):
    return rows.joined(lambda s: s.x)


def test_a_force_beyond_a_position_is_found_there(stretch):
    rows = rows_of([stretch(lambda s: np.where(s.x > 3e-3, 5.0, 0.0))])
    rows = replace(rows, left=rows.target, silent=rows.noise)  # all of it, not what the family cannot bend
    low, high = excess_range(rows, x_of(rows))
    bin_width = np.ptp(x_of(rows)) / 20
    assert low == pytest.approx(3e-3, abs=bin_width)
    assert high == pytest.approx(np.quantile(x_of(rows), 0.998))
    low, high = excess_range(rows, -x_of(rows))
    assert high == pytest.approx(-3e-3, abs=bin_width)
    assert low == pytest.approx(np.quantile(-x_of(rows), 0.002))


def test_noise_has_no_range(stretch):
    rows = rows_of([stretch()])
    assert excess_range(rows, x_of(rows)) is None
    assert excess_range(rows, rows.joined(lambda s: s.v)) is None


def test_what_is_faint_beside_the_largest_is_not_in_the_range(stretch):
    """A twentieth of the largest power is where a range ends."""

    def both(part):
        return rows_of([stretch(lambda s: np.where(s.x > 3e-3, 5.0, np.where(s.x < -3e-3, np.sqrt(part) * 5.0, 0.0)))])

    for part, reaches in ((0.03, False), (0.08, True)):
        rows = both(part)
        rows = replace(rows, left=rows.target, silent=rows.noise)
        low, _ = excess_range(rows, x_of(rows))
        assert (low < -2.5e-3) == reaches


@pytest.mark.parametrize(("samples", "enough"), [(59, False), (60, True)])
def test_three_samples_a_bin_are_the_fewest(samples, enough, stretch):
    rows = rows_of([stretch(lambda s: np.full(s.n, 5.0))])
    rows = replace(rows, left=rows.target, silent=rows.noise)
    use = np.zeros(rows.target.size, bool)
    use[:samples] = True
    # a coordinate with so many samples in one bin that it may be judged
    values = np.where(np.arange(rows.target.size) % 2, 0.0, 1.0)
    assert (excess_range(rows, np.where(use, values, np.nan)) is not None) == enough


def test_each_stretch_is_judged_by_its_own_noise(stretch):
    loud = stretch(lambda s: 60 * s.v * np.abs(s.v), name="loud")
    quiet = stretch(name="quiet", seed=1)
    rows = rows_of([loud, quiet])
    rows = replace(rows, left=rows.target, silent=rows.noise)
    assert where_it_is(rows) == [True, False]


@pytest.mark.parametrize(("excess", "beyond"), [(0.15, False), (0.25, True)])
def test_noise_is_known_to_a_fifth_of_its_power(excess, beyond, stretch):
    rows = rows_of([stretch(cycles=4000)])
    louder = replace(rows, left=np.sqrt(1 + excess) * rows.silent)
    assert where_it_is(louder) == [beyond]


def test_excess_must_exceed_three_of_its_standard_errors(stretch):
    """Noise whose power scatters from block to block, and an excess on either side of three times that."""
    rows = rows_of([stretch(cycles=40)])
    random = np.random.default_rng(1)
    silent = random.standard_normal(rows.silent.size) * (1 + 2.0 * (rows.block % 2))
    sums = np.bincount(rows.block, silent**2)
    error = np.sqrt(2 * np.sum((sums - sums.mean()) ** 2))
    for times, beyond in ((2.8, False), (3.2, True)):
        scale = np.sqrt(1 + times * error / sums.sum())
        assert where_it_is(replace(rows, silent=silent, left=scale * silent)) == [beyond]


@pytest.mark.parametrize(("cycles", "excess", "beyond"), [(8, 5.9, False), (8, 6.1, True), (12, 5.9, True)])
def test_two_blocks_do_not_show_their_scatter(cycles, excess, beyond, stretch):
    """Their noise may be off by twice itself; three show that it is the same in each."""
    rows = rows_of([stretch(cycles=cycles)])
    flat = np.ones_like(rows.silent)
    assert where_it_is(replace(rows, silent=flat, left=np.sqrt(1 + excess) * flat)) == [beyond]


def with_left(rows, left):
    return replace(rows, left=left, silent=np.zeros_like(left))


@pytest.mark.parametrize("order", range(6))
def test_a_force_in_step_with_the_motion_has_its_order(order, stretch):
    rows = rows_of([stretch()])
    phase = rows.joined(lambda s: s.phase)
    by_order, _ = orders(with_left(rows, np.cos(order * phase + 0.4)))
    assert by_order[order] == pytest.approx(1.0, abs=1e-9)
    assert sum(by_order.values()) == pytest.approx(1.0, abs=1e-9)


def test_orders_share_the_power_and_what_keeps_no_step_has_none(stretch):
    rows = rows_of([stretch(), stretch(cycles=60, seed=1)])
    phase, time = rows.joined(lambda s: s.phase), rows.joined(lambda s: s.time)
    left = np.cos(phase) + 2 * np.sin(3 * phase) + np.sqrt(5) * np.cos(0.4333 * 62.8 * time)
    by_order, first = orders(with_left(rows, left))
    assert by_order[1] == pytest.approx(0.1, abs=0.02)
    assert by_order[3] == pytest.approx(0.4, abs=0.02)
    assert sum(by_order.values()) == pytest.approx(0.5, abs=0.05)
    assert first == (pytest.approx(0.1, abs=0.02), pytest.approx(0.0, abs=0.01))
    _, first = orders(with_left(rows, np.sin(phase)))
    assert first == (pytest.approx(0.0, abs=1e-9), pytest.approx(1.0))


def test_the_noise_in_an_order_is_taken_off(stretch):
    rows = rows_of([stretch()])
    phase = rows.joined(lambda s: s.phase)
    by_order, first = orders(replace(rows, left=np.cos(phase) + np.cos(2 * phase), silent=np.cos(2 * phase)))
    assert by_order[1] == pytest.approx(1.0)
    assert by_order[2] == pytest.approx(0.0, abs=1e-9)
    assert first[0] == pytest.approx(1.0)


def test_the_noise_in_the_first_order_is_taken_off_its_parts(stretch):
    """Of a power of 1, an eighth is noise in step with the displacement."""
    rows = rows_of([stretch()])
    phase = rows.joined(lambda s: s.phase)
    _, first = orders(replace(rows, left=np.cos(phase) + np.cos(2 * phase), silent=0.5 * np.cos(phase)))
    assert first == (pytest.approx((1 / 2 - 1 / 8) / (1 - 1 / 8), abs=1e-3), pytest.approx(0.0, abs=1e-9))


def test_a_stretch_without_a_phase_has_no_orders(stretch):
    plain = stretch()
    rows = rows_of([replace(plain, phase=np.full(plain.n, np.nan))])
    assert set(orders(with_left(rows, np.cos(plain.phase)))[0].values()) == {0.0}


TONE = 3.37


def tone(level):
    return lambda s: level * np.cos(2 * np.pi * TONE * s.time + 0.7)


def test_a_tone_is_found_with_its_frequency_and_size(stretch):
    line = line_in(rows_of([stretch(tone(0.3)), stretch(tone(0.3), seed=1, cycles=100)]))
    assert line.frequency_hz == pytest.approx(TONE, abs=0.5 / 12.0)  # twelve seconds, and as many zeros
    assert line.amplitude == pytest.approx(0.3, rel=0.1)
    assert line.steady


@pytest.mark.parametrize(("part", "steady"), [(0.42, False), (0.58, True)])
def test_a_force_from_outside_has_one_size(part, steady, stretch):
    line = line_in(rows_of([stretch(tone(0.5)), stretch(tone(part * 0.5), seed=1)]))
    assert line.steady == steady


@pytest.mark.parametrize(("beside", "alone"), [(-0.4, False), (0.4, False), (-1.3, True), (1.3, True)])
def test_a_line_stands_alone(beside, alone, stretch):
    """With a third of its power four tenths of a hertz below or above it is a resonance."""
    rows = rows_of([stretch(lambda s: tone(0.5)(s) + 0.3 * np.cos(2 * np.pi * (TONE + beside) * s.time))])
    assert (line_in(rows) is not None) is alone


def test_a_tone_in_one_recording_alone_is_none(stretch):
    assert line_in(rows_of([stretch(tone(0.3)), stretch(seed=1)])) is None


def test_noise_has_no_line(stretch):
    for seed in range(5):
        assert line_in(rows_of([stretch(seed=seed)])) is None


@pytest.mark.parametrize(("cycles", "enough"), [(79, False), (83, True)])
def test_a_line_takes_eighty_cycles(cycles, enough, stretch):
    assert (line_in(rows_of([stretch(tone(0.3), cycles=cycles)])) is not None) == enough


def test_a_passage_of_a_sweep_is_no_line(stretch):
    swept = stretch(lambda s: 0.5 * np.cos(2 * np.pi * (3.0 * s.time + 0.1 * s.time**2)))
    assert line_in(rows_of([swept])) is None
