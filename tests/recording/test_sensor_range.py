"""What a response shows beyond the range of its sensor is left out, and said."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify import identify
from dashpot.recording.recording import from_sep5
from dashpot.recording.sensor_range import beyond_range, seen_whole

FS = 200.0
TIME = np.arange(8000) / FS
NOISE = 2e-4 * np.random.default_rng(1).standard_normal(TIME.size)
DECAY = np.exp(-0.05 * TIME) * np.cos(2 * np.pi * 1.3 * TIME)
CYCLE = FS / 1.3


def marked(signal):
    mask = np.zeros(signal.size, bool)
    for end in beyond_range(signal, CYCLE):
        for a, b in end.runs:
            mask[a:b] = True
    return mask


def folded(limit, shown):
    return np.where(limit > DECAY, shown, DECAY + NOISE)


def test_what_goes_on_at_the_other_end_of_the_range_is_left_out():
    shown = folded(-0.6, 1.4)
    np.testing.assert_array_equal(marked(shown), shown == 1.4)
    whole = seen_whole("laser", shown[:, None], FS)
    assert sum(b - a for a, b in whole.blank) == np.count_nonzero(shown == 1.4)
    (note,) = whole.notes
    assert "it shows 1.4 instead" in note
    end = float(note.partition("ends at ")[2].partition(":")[0])  # the last sample that was shown
    assert end == pytest.approx(-0.6, abs=2e-3)


def test_tops_that_scatter_behind_a_limit_are_left_out():
    shown = np.minimum(DECAY, 0.6) + NOISE
    beyond = DECAY > 0.6
    assert np.mean(marked(shown)[beyond]) > 0.9
    assert not np.any(marked(shown)[DECAY < 0.58])


def holds(level):
    """Pulled to the same place five times, within a quarter of a cycle, held for less than one, and let go."""
    parts = [np.concatenate([np.linspace(0, level, 30), np.full(120, level), level * DECAY[:1450]]) for _ in range(5)]
    return np.concatenate(parts)


@pytest.mark.parametrize("signal", [DECAY, holds(1.0), np.repeat([0.0, 1.0, 0.0, 1.0], 2000), np.zeros(8000)])
def test_what_stays_within_its_range_is_left_as_it_is(signal):
    shown = signal + NOISE
    assert beyond_range(shown, CYCLE) == []
    np.testing.assert_array_equal(seen_whole("shown", shown[:, None], FS).columns[:, 0], shown)


def test_the_rig_is_found_beside_what_its_sensor_did_not_show():
    """Of a decay that folds over in its first swings every one counts as far as it was seen."""
    recording = from_sep5({"data": 1e-2 * folded(-0.6, 1.4), "fs": FS, "unit_str": "m", "name": "laser"})
    found = identify([recording]).oscillator
    omega0 = np.hypot(2 * np.pi * 1.3, 0.05)
    assert abs(found.omega0.value - omega0) < 3.5 * found.omega0.std < 1e-3
    assert abs(found.viscous.value - 0.1) < 3.5 * found.viscous.std < 1e-3
