"""Smoothing as one banded system, against the same Gaussian problem written out in full."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.penalised_states import PenalisedStates
from scipy.linalg import block_diag, solveh_banded

N = 7


class Problem:
    """Random dynamics of three states, seen in one combination of them, and its dense covariances."""

    def __init__(self, seed: int = 0, force_noise: float = 0.3) -> None:
        random = np.random.default_rng(seed)
        self.phi = np.eye(3) + 0.2 * random.standard_normal((N - 1, 3, 3))
        root = random.standard_normal((N - 1, 3, 3))
        self.q = root @ root.transpose(0, 2, 1) + 0.5 * np.eye(3)
        self.begin = np.array([2.0, 0.7, 1.3])
        self.h = random.standard_normal((N, 3))
        self.given = random.standard_normal((N - 1, 3))
        self.seen = random.standard_normal(N)
        inverse = np.linalg.inv(self.q)
        # D z = given + w with w of precision W: its normal equations are the definition of the system
        self.difference = np.eye(3 * N)
        for k in range(N - 1):
            self.difference[3 * k + 3 : 3 * k + 6, 3 * k : 3 * k + 3] = -self.phi[k]
        self.weight = block_diag(np.diag(1 / self.begin), *inverse)
        self.rows = block_diag(*(row[None] for row in self.h))
        precision = self.difference.T @ self.weight @ self.difference + self.rows.T @ self.rows
        self.precision = precision
        band = np.zeros((6, 3 * N))
        for i in range(6):
            band[i, : 3 * N - i] = np.diagonal(precision, -i)
        prior = float(np.linalg.slogdet(self.weight)[1])
        carried = self.phi.transpose(0, 2, 1) @ inverse
        self.system = PenalisedStates(band, carried, inverse, self.h, self.seen, self.given, force_noise, prior)

    @property
    def input(self) -> np.ndarray:
        return np.concatenate([np.zeros(3), self.given.ravel()])


@pytest.mark.parametrize("seed", range(3))
def test_the_right_side_is_that_of_the_normal_equations(seed):
    problem = Problem(seed)
    expected = problem.rows.T @ problem.seen + problem.difference.T @ problem.weight @ problem.input
    assert problem.system.right(problem.seen, problem.given) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_the_solution_is_the_most_likely_motion(seed):
    """Whatever else the states are, the penalty is larger."""
    problem = Problem(seed)
    system = problem.system
    states = solveh_banded(system.band, system.right(system.seen, system.given), lower=True)

    def penalty(z):
        off, push = system.seen - problem.rows @ z, problem.difference @ z - problem.input
        return off @ off + push @ problem.weight @ push

    random = np.random.default_rng(seed)
    least = penalty(states)
    assert all(penalty(states + 1e-2 * random.standard_normal(3 * N)) > least for _ in range(30))
    # and what the misfit holds whatever the states are is the penalty of states at zero
    assert system.constant() == pytest.approx(penalty(np.zeros(3 * N)))


@pytest.mark.parametrize("seed", range(3))
def test_the_likelihood_is_that_of_the_samples_covariance(seed):
    problem = Problem(seed)
    passed = np.linalg.inv(problem.difference)
    covariance = problem.rows @ passed @ np.linalg.inv(problem.weight) @ passed.T @ problem.rows.T + np.eye(N)
    beyond = problem.seen - problem.rows @ passed @ problem.input
    exact = -0.5 * (beyond @ np.linalg.solve(covariance, beyond) + np.linalg.slogdet(covariance)[1])
    assert problem.system.log_likelihood() == pytest.approx(exact, rel=1e-9)


def test_numbers_that_do_not_carry_it_have_no_likelihood():
    system = Problem().system
    upside_down = system.band.copy()
    upside_down[0, 4] = -1.0
    assert replace(system, band=upside_down).log_likelihood() == -np.inf
    assert replace(system, prior=np.nan).log_likelihood() == -np.inf


def test_noise_is_that_of_sensor_and_force_and_the_same_for_a_seed():
    problem = Problem(force_noise=0.0)
    random = np.random.default_rng(5)
    random.standard_normal(N - 1)  # the force's, which has none here
    quiet = problem.system.right(random.standard_normal(N), np.zeros((N - 1, 3)))
    assert problem.system.noise(5) == pytest.approx(quiet)
    assert not np.array_equal(problem.system.noise(5), problem.system.noise(6))
    # a held force moves the displacement by half of what it adds to the speed
    system = replace(problem.system, h=np.zeros((N, 3)), force_noise=0.4)
    kicks = np.linalg.lstsq(_pushes(system), system.noise(5))[0]
    assert np.std(kicks) > 0.0
    assert _pushes(system) @ kicks == pytest.approx(system.noise(5), abs=1e-12)
    louder = replace(system, force_noise=0.8)
    assert louder.noise(5) == pytest.approx(2.0 * system.noise(5))


def _pushes(system):
    """(3 n, n - 1) right sides of a unit of held force in each sample."""
    columns = []
    for k in range(N - 1):
        given = np.zeros((N - 1, 3))
        given[k] = [0.5, 1.0, 0.0]
        columns.append(system.right(np.zeros(N), given))
    return np.column_stack(columns)
