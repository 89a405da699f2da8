"""Bordered systems with each segment's unknowns eliminated, against the dense least squares of all unknowns at once."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.normal_equations import (
    least_squares,
    products,
    promise,
    pseudo_inverse,
    shared_information,
    solve,
    without_information,
)

SHARED, OWN, SEGMENTS, SAMPLES = 4, 3, 5, 40


def system(seed=0, scale=None):
    """Rows and right sides of each segment, their blocks, and the dense matrix of all unknowns."""
    random = np.random.default_rng(seed)
    scale = np.ones(SHARED + OWN) if scale is None else scale
    rows = [random.standard_normal((SAMPLES, SHARED + OWN)) * scale for _ in range(SEGMENTS)]
    right = [random.standard_normal(SAMPLES) for _ in range(SEGMENTS)]
    dense = np.zeros((SEGMENTS * SAMPLES, SHARED + SEGMENTS * OWN))
    for i, part in enumerate(rows):
        span = slice(i * SAMPLES, (i + 1) * SAMPLES)
        dense[span, :SHARED] = part[:, :SHARED]
        dense[span, SHARED + i * OWN : SHARED + (i + 1) * OWN] = part[:, SHARED:]
    blocks = [(part.T @ part, part.T @ b) for part, b in zip(rows, right, strict=True)]
    return blocks, dense, np.concatenate(right)


@pytest.mark.parametrize("seed", range(3))
def test_a_step_is_that_of_dense_least_squares(seed):
    blocks, dense, right = system(seed)
    expected = np.linalg.lstsq(dense, right)[0]
    shared, own = solve(blocks, 0.0, SHARED)
    assert shared == pytest.approx(expected[:SHARED], abs=1e-12)
    assert own.ravel() == pytest.approx(expected[SHARED:], abs=1e-12)


@pytest.mark.parametrize("damping", [1e-3, 1.0, 100.0])
def test_a_damped_step_is_marquardts(damping):
    """Dense: (J'J + damping diag(J'J)) step = J'r."""
    blocks, dense, right = system(1)
    normal = dense.T @ dense
    expected = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), dense.T @ right)
    shared, own = solve(blocks, damping, SHARED)
    assert np.concatenate([shared, own.ravel()]) == pytest.approx(expected, abs=1e-12)


def test_units_of_the_unknowns_do_not_matter():
    scale = np.array([1e9, 1e-7, 1.0, 1e4, 1e-5, 1e6, 1.0])
    plain, _, _ = system(2)
    scaled, _, _ = system(2, scale)
    shared, own = solve(plain, 1e-2, SHARED)
    other, others = solve(scaled, 1e-2, SHARED)
    assert other * scale[:SHARED] == pytest.approx(shared, rel=1e-9)
    assert others * scale[SHARED:] == pytest.approx(own, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_shared_information_is_the_dense_schur_complement(seed):
    blocks, dense, _ = system(seed)
    covariance = np.linalg.inv(dense.T @ dense)[:SHARED, :SHARED]
    information = shared_information(blocks, SHARED)
    assert np.linalg.inv(information) == pytest.approx(covariance, rel=1e-9)
    plain = sum(normal[:SHARED, :SHARED] for normal, _ in blocks)
    assert np.all(np.linalg.eigvalsh(plain - information) > 0)  # initial states that are free cost information


def test_a_state_that_a_segment_does_not_have_takes_no_part():
    """A stretch from rest has no free initial state: its rows are zeros."""
    blocks, dense, right = system(3)
    normal, gradient = (part.copy() for part in blocks[0])
    normal[SHARED:], normal[:, SHARED:], gradient[SHARED:] = 0.0, 0.0, 0.0
    kept = np.delete(np.arange(dense.shape[1]), np.arange(SHARED, SHARED + OWN))
    expected = np.linalg.lstsq(dense[:, kept], right)[0]
    shared, own = solve([(normal, gradient), *blocks[1:]], 0.0, SHARED)
    assert np.all(own[0] == 0.0)
    assert np.concatenate([shared, own[1:].ravel()]) == pytest.approx(expected, abs=1e-12)


def test_a_promise_is_what_a_linear_system_keeps():
    blocks, dense, right = system(4)
    random = np.random.default_rng(5)
    shared, own = random.standard_normal(SHARED), random.standard_normal((SEGMENTS, OWN))
    step = np.concatenate([shared, own.ravel()])
    gained = right @ right - np.sum((right - dense @ step) ** 2)
    assert promise(blocks, shared, own) == pytest.approx(gained, rel=1e-9)


def test_a_direction_without_information_stays_where_it_is():
    random = np.random.default_rng(6)
    rows = random.standard_normal((50, 4))
    rows[:, 3] = 0.0
    information = rows.T @ rows
    inverse = pseudo_inverse(information)
    assert inverse[:3, :3] == pytest.approx(np.linalg.inv(information[:3, :3]), rel=1e-9)
    assert np.all(inverse[3] == 0.0)
    same = np.column_stack([rows[:, :3], rows[:, 2]])  # two unknowns that do the same share it
    assert pseudo_inverse(same.T @ same) == pytest.approx(np.linalg.pinv(same.T @ same), abs=1e-9)
    assert np.all(pseudo_inverse(np.array([[np.nan, 0.0], [0.0, 1.0]])) == 0.0)
    assert pseudo_inverse(np.zeros((0, 0))).shape == (0, 0)


def test_three_unknowns_that_do_the_same_share_it():
    """Only one direction of three carries information: the others are noise of the arithmetic, however small."""
    rows = np.random.default_rng(7).standard_normal((50, 1)) * np.ones(3)
    information = rows.T @ rows
    assert pseudo_inverse(information) == pytest.approx(np.linalg.pinv(information), rel=1e-6)


@pytest.mark.parametrize(("apart", "kept"), [(1.5e-14, False), (3e-14, True)])
def test_information_below_what_the_arithmetic_carries_is_none(apart, kept):
    """Two unknowns that differ by so little: 1e-14 of the largest eigenvalue, which is two, is kept."""
    inverse = pseudo_inverse(np.array([[1.0, 1.0 - apart], [1.0 - apart, 1.0]]))
    difference = np.array([1.0, -1.0]) / np.sqrt(2)
    assert (difference @ inverse @ difference > 1e12) == kept


@pytest.mark.parametrize("least", [1e-294, 1e-300, 0.0])
def test_information_whose_inverse_is_beyond_any_number_is_none(least):
    inverse = pseudo_inverse(np.diag([4.0, least]))
    assert np.all(np.isfinite(inverse))
    assert inverse[0, 0] == pytest.approx(0.25)
    assert (inverse[1, 1] > 0) == (least == 1e-294)
    assert not np.any(pseudo_inverse(np.diag([1e-300, 1e-310])))


def test_least_squares_in_the_columns_that_are_used():
    random = np.random.default_rng(0)
    columns, target = random.standard_normal((30, 3)) * (1.0, 1e-6, 1e6), random.standard_normal(30)
    used = np.array([True, False, True])
    solved = least_squares(columns.T @ columns, columns.T @ target, used)
    assert solved[used] == pytest.approx(np.linalg.lstsq(columns[:, used], target)[0])
    assert solved[1] == 0.0


def test_rows_in_single_precision_are_summed_in_double():
    random = np.random.default_rng(0)
    rows = random.standard_normal((3, 100_001)).astype(np.float32)
    rows[1] = rows[0] + 1e-3 * rows[1]  # of which sums in single precision would not tell the difference
    vector = random.standard_normal(100_001)
    exact = rows.astype(float)
    size = np.linalg.norm(exact, axis=1)
    assert products(rows, rows) / np.outer(size, size) == pytest.approx(
        exact @ exact.T / np.outer(size, size), abs=1e-13
    )
    assert products(rows, vector) / size == pytest.approx(exact @ vector / size, abs=1e-11)


def test_what_two_unknowns_do_together_may_have_no_information():
    """A sum of two alone is seen. The third is not seen at all, which is no matter of directions."""
    rows = np.array([[2.0, 0.5, 0.0, 1.0], [4.0, 1.0, 0.0, -3.0]])
    directions = without_information(rows.T @ rows)
    assert directions.shape == (4, 1)
    assert directions[:, 0] / directions[0, 0] == pytest.approx([1.0, -4.0, 0.0, 0.0], abs=1e-6)
    assert without_information(np.diag([1e-3, 1e9])).shape == (2, 0)
