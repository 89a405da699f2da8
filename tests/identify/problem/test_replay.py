"""A model run along a recording begins where the motion does, whatever the sensor shows at zero."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify.problem.replay import replayed, run_along
from dashpot.model import Oscillator
from dashpot.recording import Recording

SOFT = {"mass": 5.0, "omega0": 5.5, "cubic": -90.0, "preload": 0.0, "viscous": 0.5, "dry": 0.02}
DT = 0.01


def driven(load):
    """Driven about the angle that a constant part of the force holds it at."""
    t = DT * np.arange(2000)
    force = 1.5 * np.sin(2 * np.pi * 0.8 * t) + load
    begin = load / (5.0 * 5.5**2) - 0.02, -0.15
    return force, integrate_pieces(SOFT, force[:-1, None], DT, *begin)[0], begin


@pytest.mark.parametrize("offset", [0.0, 1.4, -1.4])
@pytest.mark.parametrize("load", [0.0, 20.0])
def test_an_offset_far_beyond_the_motion_is_no_place_to_start_from(offset, load):
    """At 1.4 the softening spring pushes away: a simulation from there does not come back."""
    force, moved, begin = driven(load)
    recording = Recording("lab", 1 / DT, moved + offset, force, unit="rad", hold="zero")
    replay = replayed(Oscillator.from_values(SOFT), recording)
    assert np.sqrt(np.mean((replay.response - recording.response) ** 2)) < 1e-3 * np.std(moved)
    assert replay.zero == pytest.approx(offset, abs=1e-4)
    assert replay.initial[:2] == pytest.approx(begin, abs=1e-3)
    assert replay.load == 0.0  # a constant part of the force that acts is no zero of its cell


def test_what_a_load_cell_shows_at_zero_is_left_aside():
    """Five newtons that nobody pushes with: the spring softens, so that they would change the motion."""
    force, moved, begin = driven(0.0)
    recording = Recording("lab", 1 / DT, moved, force + 5.0, unit="rad", hold="zero")
    replay = replayed(Oscillator.from_values(SOFT), recording)
    assert replay.load == pytest.approx(5.0, abs=1e-3)
    assert np.sqrt(np.mean((replay.response - moved) ** 2)) < 1e-4 * np.std(moved)
    assert replay.initial[:2] == pytest.approx(begin, abs=1e-3)


@pytest.mark.parametrize(("drift", "seen"), [(0.0, False), (4e-6, False), (2e-3, True), (-2e-3, True)])
def test_what_its_sensor_drifts_by_is_left_aside_where_it_stands_out(drift, seen):
    force, moved, _ = driven(0.0)
    t = DT * np.arange(moved.size)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(moved.size)
    recording = Recording("lab", 1 / DT, moved + 0.01 + drift * (t - t.mean()) + noise, force, unit="rad", hold="zero")
    replay = replayed(Oscillator.from_values(SOFT), recording)
    assert bool(replay.drift) is seen
    assert replay.drift == pytest.approx(drift if seen else 0.0, rel=0.02)
    assert replay.zero == pytest.approx(0.01, abs=1e-4)
    assert np.std(replay.response - recording.response) < 1.1e-3


def test_a_motion_that_runs_away_is_followed_first_as_far_as_it_goes():
    """One beside it grows by five thousand millions in the record: only the very beginning tells where to begin."""
    t, omega = DT * np.arange(round(8.0 / DT)), 2.0
    moved = np.cos(omega * t + 0.3)
    begin = np.array([moved[0], -omega * np.sin(0.3)])

    def simulator(initial, n, load):
        off = initial[:2] - begin
        response = moved[:n] + (off[0] + off[1] / omega) * np.exp(2.8 * t[:n]) + off[0] * np.sin(omega * t[:n])
        return np.where(np.logical_or.accumulate(np.abs(response) > 3.0), np.nan, response)

    replay = run_along(simulator, Recording("lab", 1 / DT, moved, unit="rad"))
    assert replay.initial[:2] == pytest.approx(begin, abs=1e-6)
    assert replay.response == pytest.approx(moved, abs=1e-3)


def test_what_nothing_pushes_does_not_begin_at_rest():
    """However loud the noise over its first cycle: at rest it would stay there, held by friction."""
    truth = SOFT | {"cubic": 0.0, "viscous": 0.02}
    x, _ = integrate_pieces(truth, np.zeros((1200, 1)), DT, 0.05, 0.0)
    seen = x + 0.02 * np.random.default_rng(8).standard_normal(x.size)
    replay = replayed(Oscillator.from_values(truth), Recording("loud", 1 / DT, seen, unit="rad"))
    assert np.std(replay.response - x) < 0.1 * np.std(x)
