"""Signals with few points: nothing that stands out is lost."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from dashpot.report.decimate import envelope, thinned


def test_a_spike_of_one_sample_stays_with_its_time():
    x = np.sin(np.arange(400_000) * 0.08)
    x[123_456] = 5.0
    time = np.arange(x.size) / 1000.0
    few, seen = thinned(time, x, 900)
    assert few.size <= 2 * 900 + 2
    assert few[np.argmax(seen)] == 123.456
    assert np.all(np.diff(few) > 0)
    assert (few[0], few[-1]) == (time[0], time[-1])
    e = envelope(time, x, 900)
    assert e.high.max() == 5.0
    # a cycle is 78.5 samples and a stretch 444: the rms over a part of a cycle adds little
    assert np.median(e.rms) == pytest.approx(np.sqrt(0.5), rel=0.05)


def test_every_column_keeps_its_least_and_its_largest():
    rng = np.random.default_rng(1)
    y, n, columns = rng.standard_normal(12_345), 12_345, 300
    time, seen = thinned(np.arange(float(n)), y, columns)
    edges = np.linspace(0, n, columns + 1).astype(int)
    for start, stop in pairwise(edges):
        inside = seen[(time >= start) & (time < stop)]
        assert (inside.min(), inside.max()) == (y[start:stop].min(), y[start:stop].max())


def test_a_loop_keeps_its_corners_on_all_four_sides():
    turn = np.linspace(0, 20 * np.pi, 50_001)
    x, y = np.cos(turn) * (1 + 0.5 * (turn > 30)), np.sin(turn)
    across, up = thinned(x, y, 200)
    assert across.size <= 4 * 200 + 2
    for thin, whole in ((across, x), (up, y)):
        assert (thin.min(), thin.max()) == (whole.min(), whole.max())
    # it stays the curve it was: every point of it lies on one of both circles or on the step between them
    radius = np.hypot(across / np.where(np.hypot(across, up) > 1.001, 1.5, 1.0), up)
    assert np.median(np.abs(radius - 1)) < 1e-9


def test_a_gap_stays_a_gap_and_a_short_curve_stays_whole():
    y = np.sin(np.arange(10_000) * 0.1)
    y[4_000:4_500] = np.nan
    time, seen = thinned(np.arange(10_000.0), y, 100)
    assert np.any(np.isnan(seen) & (time > 3_990) & (time < 4_500))
    short = np.arange(200.0)
    assert thinned(short, short, 100)[0] is short


def test_envelope_passes_over_what_is_not_there():
    signal = np.concatenate([np.full(50, np.nan), np.ones(50)])
    e = envelope(np.arange(100.0), signal, 10)
    assert np.all(np.isnan(e.low[:5]))
    assert np.all(e.high[5:] == 1.0)
