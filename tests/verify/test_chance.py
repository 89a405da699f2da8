"""What chance makes of a perfect model, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decays import Decay
from dashpot.identify.problem.replay import Replay
from dashpot.identify.signals.odds import BY_CHANCE
from dashpot.recording import Recording
from dashpot.verify.chance import Run, by_chance, powers, usual
from dashpot.verify.model_inside import Twin
from dashpot.verify.noise_floor import Piece
from scipy.stats import chi2

N, SENSOR = 4000, 1e-3


def run(covariance):
    """A free piece whose response is a straight line of two parameters, its sensor's noise known."""
    t = np.arange(N) / N
    values = np.array([1.0, 2.0])

    def respond(force, values):
        return values[0] * t + values[1]

    record = Recording(name="line.csv", fs=100.0, response=respond(None, values))
    twin = Twin(values, np.asarray(covariance, float), respond)
    piece = Piece(record, (Decay(0, N),), SENSOR, np.zeros(N))
    return Run(piece, Replay(np.zeros(2), respond(None, values)), twin)


def test_without_force_and_own_errors_the_sensor_alone_leaves_something():
    left = powers([run(np.zeros((2, 2)))], 40, own=True)
    assert np.mean(left) == pytest.approx(SENSOR**2, rel=0.02)
    assert np.std(left) == pytest.approx(SENSOR**2 * np.sqrt(2.0 / N), rel=0.3)


def test_the_models_own_errors_leave_what_their_covariance_says():
    """Cov(a) 4, cov(b) 1, correlation 0.5: the mean square of a t + b over t from 0 to 1 is 4/3 + 1 + 1."""
    covariance = np.array([[4.0, 1.0], [1.0, 1.0]])
    left = powers([run(covariance)], 4000, own=True)
    assert np.mean(left) == pytest.approx(4.0 / 3.0 + 2.0, rel=0.1)
    assert np.mean(powers([run(covariance)], 40, own=False)) == pytest.approx(SENSOR**2, rel=0.02)


def test_a_draw_has_the_same_parameters_in_all_pieces():
    one = powers([run(np.diag([4.0, 1.0]))], 30, own=True)
    both = powers([run(np.diag([4.0, 1.0]))] * 2, 30, own=True)
    assert both == pytest.approx(one, rel=1e-2)


def test_draws_that_do_not_simulate_are_left_out():
    whole = run(np.diag([4.0, 1.0]))
    twin = whole.twin
    broken = Twin(twin.values, twin.covariance, lambda f, v: twin.respond(f, v) * (np.nan if v[0] > 1.0 else 1.0))
    left = powers([Run(whole.piece, whole.replay, broken)], 40, own=True)
    assert 5 < left.size < 35
    assert np.all(np.isfinite(left))


@pytest.mark.parametrize("freedom", [3, 50])
def test_chance_exceeds_its_limit_once_in_a_thousand(freedom):
    random = np.random.default_rng(2)
    drawn = 7.0 * random.chisquare(freedom, 20_000) / freedom
    assert by_chance(drawn) == pytest.approx(7.0 * chi2.isf(BY_CHANCE, freedom) / freedom, rel=0.05)
    assert by_chance(np.full(10, 7.0)) == 7.0


def test_a_draw_that_ends_in_another_motion_does_not_make_the_floor():
    drawn = 1e-6 * np.random.default_rng(3).chisquare(400, 21) / 400
    assert usual(drawn) == pytest.approx(1e-3, rel=0.03)
    drawn[4] = 1.0
    assert usual(drawn) == pytest.approx(1e-3, rel=0.03)
