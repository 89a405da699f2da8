"""What a load cell reads when nothing pushes, and how well that is known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.force_off import zero_of
from dashpot.identify.problem.offset import zero_of_load_cell

FS, PERIOD = 500.0, 50
OMEGA = 2 * np.pi * FS / PERIOD
ZERO = 0.02


def sweep(fade, zero=0.0, noise=0.0, seconds=20.0, first=2.0):
    """A sweep from a fifth of the rig's frequency up, faded in over some seconds."""
    t = np.arange(round(seconds * FS)) / FS
    window = np.clip(t / fade, 0.0, 1.0) if fade else 1.0
    force = 0.3 * window * np.sin(2 * np.pi * (first * t + 0.5 * (20.0 - first) / seconds * t**2))
    return force + zero + noise * np.random.default_rng(0).standard_normal(t.size)


def silent_before(seconds, force):
    return np.concatenate([force[0] * np.ones(round(seconds * FS)), force])


def test_where_the_force_is_off_its_zero_is_known_to_the_noise():
    quiet = ZERO + 1e-4 * np.random.default_rng(1).standard_normal(1000)
    value, error = zero_of(np.concatenate([quiet, sweep(0.0, ZERO)]), PERIOD)
    assert value == pytest.approx(ZERO, abs=4 * error)
    assert error < 1e-4


@pytest.mark.parametrize("fade", [0.2, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("first", [1.0, 2.0, 5.0])
def test_the_fade_of_a_sweep_stands_still_nowhere(fade, first):
    """Within a cycle of the rig a slow beginning hardly moves, wherever it is: that is no zero."""
    force = sweep(fade, first=first)
    value, error = zero_of(force, PERIOD)
    assert abs(value) < 2 * error
    assert zero_of_load_cell(force, FS, OMEGA) == 0.0


def test_a_force_that_never_stands_still_is_centred_where_its_cycles_are():
    """A median of its samples would be off by a tenth of its size: a sine is seldom at its middle."""
    force = sweep(0.0, ZERO, first=9.0)
    value, error = zero_of(force, PERIOD)
    assert value == pytest.approx(ZERO, abs=4 * error)
    assert error < 0.1 * ZERO
    assert zero_of_load_cell(force, FS, OMEGA) == value


def test_a_force_that_stands_still_on_either_side_of_zero_pushes_at_both_levels():
    levels = np.repeat([1.0, -1.0, 1.0, -1.0], [400, 70, 30, 500])
    value, error = zero_of(levels, PERIOD)
    assert value == 0.0
    assert zero_of_load_cell(levels, FS, OMEGA) == 0.0
    assert error >= 1.0


@pytest.mark.parametrize(("times", "asked"), [(2.0, False), (6.0, True)])
def test_a_zero_is_asked_for_where_it_stands_out_of_its_error(times, asked):
    """At 3.7 standard errors."""
    _, error = zero_of(sweep(0.0, first=9.0), PERIOD)
    zero = zero_of_load_cell(sweep(0.0, times * error, first=9.0), FS, OMEGA)
    assert (zero != 0.0) is asked
