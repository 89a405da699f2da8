"""Evidence against closed forms: of linear models, where Laplace's approximation is nearly exact."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.fit.evidence import Marginal, cross_validated, evidence, log_prior, marginalised, predictive
from dashpot.identify.problem.linearised import Sums

NOISE = 0.1


def line(count: int, seed: int, slope: float = 2.0, columns: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Design matrix (count, columns) and measured values of a straight line through zero, white noise on it."""
    random = np.random.default_rng(seed)
    design = random.standard_normal((count, columns))
    return design, slope * design[:, 0] + NOISE * random.standard_normal(count)


def marginal_of(design: np.ndarray, measured: np.ndarray, at: np.ndarray) -> Marginal:
    residual = measured - design @ at
    log_likelihood = -0.5 * float(residual @ residual) / NOISE**2
    return Marginal(log_likelihood, design.T @ design / NOISE**2, design.T @ residual / NOISE**2)


def best(design: np.ndarray, measured: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(design, measured)[0]


def wide(columns: int, width: float = 10.0) -> np.ndarray:
    return np.array([np.zeros(columns), np.full(columns, width)])


def test_evidence_is_the_likelihood_averaged_over_the_prior():
    design, measured = line(40, seed=1)
    at, prior = best(design, measured), wide(1)
    grid = np.linspace(at[0] - 0.5, at[0] + 0.5, 200_001)
    errors = measured[:, None] - design * grid[None, ::100]
    logs = -0.5 * np.sum(errors**2, axis=0) / NOISE**2
    logs += np.array([log_prior(np.array([value]), prior) for value in grid[::100]])
    averaged = np.log(np.trapezoid(np.exp(logs - logs.max()), grid[::100])) + logs.max()
    assert evidence(marginal_of(design, measured, at), at, prior) == pytest.approx(averaged, abs=1e-3)


def test_a_parameter_that_tells_nothing_pays_for_its_range():
    design, measured = line(200, seed=2, columns=2)
    single = best(design[:, :1], measured)
    double = best(design, measured)
    plain = evidence(marginal_of(design[:, :1], measured, single), single, wide(1))
    needless = evidence(marginal_of(design, measured, double), double, wide(2))
    assert needless < plain - 3.0
    # ten times the range costs a factor of ten in odds
    dearer = evidence(marginal_of(design, measured, double), double, np.array([[0.0, 0.0], [10.0, 100.0]]))
    assert needless - dearer == pytest.approx(np.log(10.0), abs=0.05)


def test_a_parameter_that_the_recordings_ask_for_gains():
    random = np.random.default_rng(3)
    design = random.standard_normal((200, 2))
    measured = design @ [2.0, 0.1] + NOISE * random.standard_normal(200)
    single, double = best(design[:, :1], measured), best(design, measured)
    assert evidence(marginal_of(design, measured, double), double, wide(2)) > (
        evidence(marginal_of(design[:, :1], measured, single), single, wide(1)) + 50.0
    )


def test_what_was_held_out_is_told_by_the_chain_rule():
    design, measured = line(60, seed=4, columns=2)
    training, rest = slice(0, 30), slice(30, 60)
    prior, at = wide(2, 1e3), best(design[training], measured[training])
    before = marginal_of(design[training], measured[training], at)
    after = marginal_of(design[rest], measured[rest], at)
    every = best(design, measured)
    whole = evidence(marginal_of(design, measured, every), every, prior)
    assert predictive(after, before, prior) == pytest.approx(whole - evidence(before, at, prior), abs=1e-3)


def test_a_prediction_is_forgiven_what_training_left_open():
    """The same miss on held-out data costs less where training knew the parameter less."""
    design, measured = np.ones((50, 1)), np.full(50, 2.0)
    held = marginal_of(design, measured + 0.1, np.array([2.0]))
    sure, unsure = (
        Marginal(0.0, np.array([[information]]), np.zeros(1)) for information in (1e6 / NOISE**2, 1.0 / NOISE**2)
    )
    assert predictive(held, unsure, wide(1)) > predictive(held, sure, wide(1)) + 10.0


def test_initial_states_are_averaged_over():
    """One segment with an unknown of its own beside the shared one, as one model with two unknowns has it."""
    design, measured = line(80, seed=5, columns=2)
    at, prior = best(design, measured), wide(2)
    alone = marginal_of(design, measured, at)
    sums = Sums.of(design.T / NOISE, (measured - design @ at) / NOISE)
    split = marginalised(alone.log_likelihood, sums, np.array([1]), at[1:], prior[:, 1:], 1)
    assert evidence(split, at[:1], prior[:, :1]) == pytest.approx(evidence(alone, at, prior), rel=1e-9)


def test_the_prior_is_cauchys():
    prior = np.array([[3.0], [2.0]])
    assert log_prior(np.array([3.0]), prior) == pytest.approx(-np.log(2.0 * np.pi))
    assert log_prior(np.array([5.0]), prior) == pytest.approx(-np.log(4.0 * np.pi))
    assert log_prior(np.array([-7.0]), prior) == pytest.approx(-np.log(2.0 * np.pi * 26.0))


def test_initial_states_need_not_be_at_their_best():
    """Averaged over, it does not matter where they were taken, as long as the prior is wide."""
    design, measured = line(80, seed=6, columns=2)
    at = best(design, measured) + np.array([0.02, 0.0])
    points = []
    for shift in (0.0, 0.03):
        here = at + np.array([0.0, shift])
        sums = Sums.of(design.T / NOISE, (measured - design @ here) / NOISE)
        points.append(marginalised(-0.5 * sums.power, sums, np.array([1]), here[1:], wide(1, 1e4), 1))
    assert points[0].log_likelihood == pytest.approx(points[1].log_likelihood, abs=1e-3)
    assert points[0].gradient == pytest.approx(points[1].gradient, rel=1e-6)
    # the best of the shared one is below the point that was taken
    assert points[0].gradient[0] < 0


def test_what_training_did_not_see_the_prior_bounds():
    unseen = Marginal(0.0, np.zeros((1, 1)), np.zeros(1))
    held = Marginal(-3.0, np.array([[5.0]]), np.zeros(1))
    prior = np.array([[0.0], [0.5]])  # a precision of 4
    assert predictive(held, unseen, prior) == pytest.approx(-3.0 - 0.5 * np.log(9.0 / 4.0))


def test_cross_validation_is_what_each_part_is_worth_beside_the_others():
    """Of a linear model one step is exact: the integral over the slope, with and without the part."""
    design, measured = line(30, seed=7)
    at, prior = best(design, measured), wide(1)
    thirds = [slice(0, 10), slice(10, 20), slice(20, 30)]
    score = cross_validated([marginal_of(design[part], measured[part], at) for part in thirds], prior)
    grid = np.linspace(at[0] - 0.6, at[0] + 0.6, 20_001)
    # the prior is flat here, but for the information that it adds
    logs = -0.5 * (measured[:, None] - design * grid[None, :]) ** 2 / NOISE**2
    flat = -0.5 * (grid - at[0]) ** 2 / prior[1, 0] ** 2

    def integral(rows: np.ndarray) -> float:
        total = np.sum(logs[rows], axis=0) + flat
        return float(np.log(np.trapezoid(np.exp(total - total.max()), grid)) + total.max())

    every = np.arange(30)
    expected = sum(integral(every) - integral(np.setdiff1d(every, every[part])) for part in thirds)
    assert score == pytest.approx(expected, abs=1e-6)


def test_cross_validation_sees_what_fits_but_does_not_foretell():
    random = np.random.default_rng(11)
    x = np.linspace(0.0, 1.0, 12)
    measured = 2.0 * x + NOISE * random.standard_normal(x.size)
    plain, bent = x[:, None], np.stack([x**k for k in range(1, 8)], axis=1)
    thirds = [slice(0, 4), slice(4, 8), slice(8, 12)]

    def crossed(design: np.ndarray) -> float:
        at = best(design, measured)
        return cross_validated([marginal_of(design[p], measured[p], at) for p in thirds], wide(design.shape[1]))

    assert crossed(plain) > crossed(bent) + 3.0


def test_what_initial_states_explain_as_well_tells_nothing_and_not_less():
    """A shared unknown that moves the response as an initial state does: rounding made its information negative."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        state = rng.standard_normal(50)
        sums = Sums.of(np.vstack([1e6 * rng.uniform(0.5, 2.0) * state, state]), rng.standard_normal(50))
        found = marginalised(0.0, sums, np.array([1]), np.zeros(1), np.array([[0.0], [1e12]]), 1)
        assert 0.0 <= found.information[0, 0] <= 1e-14 * sums.normal[0, 0]
