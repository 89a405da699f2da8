"""Samples packed for a browser: what comes out is what went in, to a step; of too many the extremes stay."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from dashpot.report.even_samples import is_even, packed


def unpacked(data):
    """x and y as charts.js has them."""
    counts = np.frombuffer(base64.b64decode(data["samples"]), "<i2").astype(float)
    y = np.where(counts == -32768, np.nan, data["least"] + data["unit"] * (32767 + counts))
    return data["from"] + data["step"] * np.arange(y.size), y


def test_what_is_unpacked_is_what_was_packed_to_half_a_step():
    x = 5.0 + np.arange(4000) / 500.0
    y = 3e-3 * np.sin(80 * x) * np.exp(-x / 5)
    y[700:720] = np.nan
    back_x, back = unpacked(packed(x, y, 4000))
    assert back_x == pytest.approx(x, abs=1e-9)
    assert np.array_equal(np.isnan(back), np.isnan(y))
    assert np.nanmax(np.abs(back - y)) <= 0.5001 * np.ptp(y[np.isfinite(y)]) / 65_000


@pytest.mark.parametrize("n", [3, 1000, 1001, 99_991])
@pytest.mark.parametrize("room", [2000, 5001])
def test_of_too_many_the_extremes_stay_where_they_are(n, room):
    x = np.arange(n) / 1000.0
    y = np.random.default_rng(n).standard_normal(n)
    back_x, back = unpacked(packed(x, y, room))
    assert back.size <= max(room, n if n <= room else 0)
    step = np.ptp(y) / 65_000
    assert (back.min(), back.max()) == pytest.approx((y.min(), y.max()), abs=step)
    far = 0.0 if n <= room else 2 * (x[-1] - x[0]) / (back.size / 2 - 2)
    assert abs(back_x[np.argmax(back)] - x[np.argmax(y)]) <= far
    assert abs(back_x[-1] - x[-1]) <= far


def test_a_gap_stays_one_and_nothing_at_all_is_no_number():
    y = np.sin(np.arange(50_000) / 100.0)
    y[20_000:21_000] = np.nan
    x, back = unpacked(packed(np.arange(50_000.0), y, 2000))
    assert np.all(np.isnan(back[(x > 20_100) & (x < 20_900)]))
    assert np.all(np.isnan(unpacked(packed(np.arange(5.0), np.full(5, np.nan), 2000))[1]))
    assert np.array_equal(unpacked(packed(np.arange(5.0), np.full(5, 2.5), 2000))[1], np.full(5, 2.5))


def test_steps_are_even_to_what_rounding_leaves():
    assert is_even(np.arange(1000) / 3.0)
    assert is_even(np.round(np.arange(1000) / 480.0, 5))
    assert not is_even(np.round(np.arange(1000) / 480.0, 3))
    assert not is_even(np.array([0.0, 1.0, 2.0, np.nan]))
    assert not is_even(np.sin(np.arange(100.0)))
    assert not is_even(np.zeros(10))
    assert not is_even(np.arange(2.0))
