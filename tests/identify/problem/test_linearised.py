"""What follows from the sums of a linearised problem, against dense least squares of all unknowns at once."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.linearised import Linearised, Sums, off, orthonormal
from dashpot.identify.problem.unknowns import Unknown, Unknowns

SHARED, OWN, SEGMENTS, SAMPLES = 4, 2, 3, 60
PARAMETERS = tuple(Unknown("parameter", name) for name in ("mass", "omega0", "viscous"))
ZERO = Unknown("chain", "response of recording 1")
STATES = ("initial state 1", "initial state 2")


def linearised(seed: int = 0) -> tuple[Linearised, np.ndarray, np.ndarray]:
    """A problem of random columns, its dense Jacobian (all samples, all unknowns), and what is left."""
    random = np.random.default_rng(seed)
    own = tuple(tuple(Unknown("initial", name, i) for name in STATES) for i in range(SEGMENTS))
    rows = random.standard_normal((SEGMENTS, SHARED + OWN, SAMPLES))
    left = random.standard_normal((SEGMENTS, SAMPLES))
    dense = np.zeros((SEGMENTS, SAMPLES, SHARED + SEGMENTS * OWN))
    for i in range(SEGMENTS):
        dense[i, :, :SHARED] = rows[i, :SHARED].T
        dense[i, :, SHARED + i * OWN : SHARED + (i + 1) * OWN] = rows[i, SHARED:].T
    made = Linearised(Unknowns((*PARAMETERS, ZERO), STATES, own), tuple(rows), tuple(left))
    return made, dense.reshape(-1, dense.shape[-1]), left.ravel()


def power_left(dense: np.ndarray, left: np.ndarray) -> float:
    return float(np.sum((left - dense @ np.linalg.lstsq(dense, left)[0]) ** 2))


@pytest.mark.parametrize("seed", range(3))
def test_information_and_power_are_those_of_dense_least_squares(seed):
    made, dense, left = linearised(seed)
    covariance = np.linalg.inv(dense.T @ dense)
    assert np.linalg.inv(made.shared.normal) == pytest.approx(covariance[:SHARED, :SHARED], rel=1e-9)
    assert made.shared.errors() == pytest.approx(np.sqrt(np.diag(covariance)[:SHARED]), rel=1e-9)
    assert np.linalg.inv(made.information(PARAMETERS)) == pytest.approx(covariance[:3, :3], rel=1e-9)
    some = made.over([PARAMETERS[2], PARAMETERS[0]])  # in the order of the rows
    assert np.linalg.inv(some.normal) == pytest.approx(covariance[np.ix_([0, 2], [0, 2])], rel=1e-9)
    assert some.left(some.step()) == pytest.approx(power_left(dense, left), rel=1e-9)
    assert made.shared.left(made.shared.step()) == pytest.approx(power_left(dense, left), rel=1e-9)
    shared, own = made.step()
    expected = np.linalg.lstsq(dense, left)[0]
    assert np.concatenate([shared, own.ravel()]) == pytest.approx(expected, abs=1e-12)
    assert made.shared.step() == pytest.approx(shared, abs=1e-12)


def test_columns_that_are_known_take_no_part():
    made, dense, left = linearised()
    total = made.sums[0].only(np.array([0, 2]))
    columns = dense[:SAMPLES, [0, 2]]
    assert total.step() == pytest.approx(np.linalg.lstsq(columns, left[:SAMPLES])[0])
    assert total.samples == SAMPLES


def test_a_prior_is_a_sample_of_its_own():
    random = np.random.default_rng(1)
    columns, residual = random.standard_normal((3, 40)), random.standard_normal(40)
    with_prior = np.vstack([columns.T, [0.0, 0.0, 2.0]]), np.append(residual, 0.0)
    total = Sums.of(columns, residual).without([2], np.array([4.0]))
    assert total.step() == pytest.approx(np.linalg.lstsq(*with_prior)[0][:2])
    assert total.left(total.step()) == pytest.approx(power_left(*with_prior))


@pytest.mark.parametrize("along", [(0, 1, 2), (1,)])
def test_a_further_column_gains_what_the_larger_fit_gains(along):
    made, dense, left = linearised(3)
    random = np.random.default_rng(4)
    columns = {i: random.standard_normal((2, SAMPLES)) for i in along}
    wider = np.zeros((SEGMENTS, SAMPLES, 2))
    for i, more in columns.items():
        wider[i] = more.T
    both = np.hstack([dense, wider.reshape(-1, 2)])
    gain, value, information = made.gain(columns)
    assert gain == pytest.approx(0.5 * (power_left(dense, left) - power_left(both, left)), rel=1e-9)
    assert value == pytest.approx(np.linalg.lstsq(both, left)[0][-2:], abs=1e-11)
    assert np.linalg.inv(information) == pytest.approx(np.linalg.inv(both.T @ both)[-2:, -2:], rel=1e-9)


def test_blocks_add_up_to_their_segment():
    made, dense, left = linearised(5)
    edges = [[0, 7, 31, SAMPLES], [0, SAMPLES], [10, 20]]
    blocks = made.block(edges)
    assert [len(own) for own in blocks] == [3, 1, 1]
    total = blocks[0][0] + blocks[0][1] + blocks[0][2]
    assert total.samples == SAMPLES
    assert total.normal == pytest.approx(made.sums[0].normal, abs=1e-12)
    assert total.gradient == pytest.approx(made.sums[0].gradient, abs=1e-12)
    assert total.power == pytest.approx(made.sums[0].power)
    part = slice(2 * SAMPLES + 10, 2 * SAMPLES + 20)
    assert blocks[2][0].power == pytest.approx(float(left[part] @ left[part]))
    shared = dense[part][:, :SHARED]
    assert blocks[2][0].normal[:SHARED, :SHARED] == pytest.approx(shared.T @ shared)
    assert blocks[2][0].gradient[:SHARED] == pytest.approx(shared.T @ left[part])


def test_without_some_samples_it_is_the_fit_of_the_others():
    made, dense, left = linearised(6)
    kept = np.random.default_rng(7).random((SEGMENTS, SAMPLES)) < 0.7
    kept[1] = False
    rest = made.keeping(list(kept))
    expected = np.linalg.lstsq(dense[kept.ravel()], left[kept.ravel()])[0]
    assert rest.step()[0] == pytest.approx(expected[:SHARED], abs=1e-11)
    assert np.all(rest.step()[1][1] == 0.0)  # of a segment of which nothing is kept nothing moves


@pytest.mark.parametrize("precision", [float, np.float32])
def test_projected_columns_are_orthogonal_to_the_initial_states(precision):
    made, dense, _ = linearised(9)
    hat = np.diag(dense @ np.linalg.inv(dense.T @ dense) @ dense.T).reshape(SEGMENTS, SAMPLES)
    made = Linearised(made.unknowns, tuple(rows.astype(precision) for rows in made.columns), made.residuals)
    covariance = np.linalg.inv(made.shared.normal)
    for i in range(SEGMENTS):
        own = made.columns[i][SHARED:].astype(float)
        rows, taken = made.projected(i, covariance)
        assert rows @ own.T == pytest.approx(np.zeros((SHARED, OWN)), abs=1e3 * float(np.finfo(precision).eps))
        assert taken == pytest.approx(hat[i], abs=1e3 * float(np.finfo(precision).eps))


def test_what_the_states_of_a_segment_imitate_is_projected_out():
    random = np.random.default_rng(0)
    rows = random.standard_normal((3, 50))
    basis = orthonormal(np.vstack([rows, 2.0 * rows[0], np.zeros(50)]))
    assert basis @ basis.T == pytest.approx(np.eye(3), abs=1e-12)
    assert off(basis, rows) == pytest.approx(np.zeros((3, 50)), abs=1e-12)
    other = random.standard_normal((2, 50))
    assert off(basis, other) @ basis.T == pytest.approx(np.zeros((2, 3)), abs=1e-12)
    assert off(basis, other[0]) == pytest.approx(other[0] - rows.T @ np.linalg.lstsq(rows.T, other[0])[0], abs=1e-12)
    nothing = orthonormal(np.zeros((2, 50)))
    assert np.array_equal(off(nothing, other), other)


@pytest.mark.parametrize(("apart", "directions"), [(3e-9, 1), (1e-7, 2)])
def test_directions_that_only_roundings_tell_apart_are_one(apart, directions):
    """Two rows at an angle: the smaller singular value over the larger is half of it."""
    rows = np.array([[1.0, 0.0, 0.0], [np.cos(apart), np.sin(apart), 0.0]])
    assert len(orthonormal(rows)) == directions
