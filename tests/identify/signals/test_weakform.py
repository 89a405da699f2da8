"""Products with windows: derivatives, noise and least squares against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.signals.weakform import solve, windows

FS, N = 200.0, 2000
TIME = np.arange(N) / FS
TURN = 2 * np.pi * 7.3 * TIME
PACE = 2 * np.pi * 7.3


@pytest.fixture(scope="module")
def view():
    return windows(N, FS, 1.0, 4.0, 12.0)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_window_takes_the_derivative_of_what_is_never_differentiated(view, order):
    derivative = (np.cos(TURN), -PACE * np.sin(TURN), -(PACE**2) * np.cos(TURN))[order]
    expected = view.project(derivative)
    assert np.abs(view.project(np.cos(TURN), order) - expected) == pytest.approx(
        np.zeros(expected.shape), abs=1e-5 * np.max(np.abs(expected))
    )


def test_an_offset_does_not_pass(view):
    for order in (0, 1, 2):
        assert np.max(np.abs(view.project(np.ones(N), order))) < 1e-12 * view.omega[-1] ** order


def test_windows_cover_the_band_from_the_third_bin_on(view):
    hertz = view.omega / (2 * np.pi)
    assert hertz == pytest.approx(np.arange(4.0, 12.5, 1.0))
    assert np.array_equal(np.unique(np.diff(view.starts)), [50])  # four deep
    assert view.starts[-1] == N - view.length
    slow = windows(N, FS, 1.0, 0.2, 5.0)
    assert slow.omega[0] / (2 * np.pi) == pytest.approx(3.0)
    short = windows(100, FS, 9.0, 0.0, 90.0)
    assert (short.length, short.starts.tolist()) == (100, [0])
    assert short.omega[-1] / (2 * np.pi) == pytest.approx(90.0)  # 0.45 of the sampling rate


def test_white_noise_has_the_variance_that_is_said():
    long = windows(200000, FS, 1.0, 4.0, 40.0, 1)
    products = long.project(np.random.default_rng(0).standard_normal(200000))
    assert np.mean(np.abs(products) ** 2) == pytest.approx(long.energy / FS, rel=0.02)


def test_a_windows_band_is_as_wide_as_is_said():
    """Root mean square width of the transform of cos⁴: by Parseval that of the window's slope over the window."""
    one = windows(N, FS, 1.0, 4.0, 12.0)
    u = np.linspace(0, 1, 20001)
    shape = np.sin(np.pi * u) ** 4
    slope = np.gradient(shape, u * one.length / FS)
    assert one.width == pytest.approx(np.sqrt(np.sum(slope**2) / np.sum(shape**2)), rel=1e-4)


def test_a_denser_grid_has_the_same_windows(view):
    fine = np.arange(3 * N) / (3 * FS)
    assert view.upsampled(3).project(np.cos(PACE * fine)) == pytest.approx(view.project(np.cos(TURN)), abs=1e-5)
    assert view.mean(TIME) == pytest.approx((view.starts + view.length / 2) / FS)


def test_weighed_least_squares_of_complex_rows():
    random = np.random.default_rng(1)
    columns = random.standard_normal((300, 2)) + 1j * random.standard_normal((300, 2))
    std, truth = random.uniform(0.5, 2.0, 300), np.array([2.0, -3.0])
    noise = std / np.sqrt(2) * (random.standard_normal(300) + 1j * random.standard_normal(300))
    solution = solve(columns, columns @ truth + noise, std, 1.0)
    errors = np.sqrt(np.diag(solution.covariance))
    assert np.all(np.abs(solution.value - truth) < 4 * errors)
    # each complex row has two real ones of half its variance
    information = 2 * np.real((columns / std[:, None]).conj().T @ (columns / std[:, None]))
    assert solution.covariance == pytest.approx(np.linalg.inv(information) * solution.residual, rel=1e-9)
    assert solution.residual == pytest.approx(1.0, abs=0.2)
    # where two rows say one thing, the error is larger by the root of two
    again = solve(columns, columns @ truth + noise, std, 0.5)
    assert np.sqrt(np.diag(again.covariance)) == pytest.approx(np.sqrt(2) * errors)


def test_what_the_rows_do_not_see_is_unknown():
    columns = np.column_stack([np.ones(50), np.zeros(50)]).astype(complex)
    solution = solve(columns, 3.0 * columns[:, 0], np.ones(50), 1.0)
    assert solution.value == pytest.approx([3.0, 0.0])
    assert solution.covariance[1, 1] > 1e8 * solution.covariance[0, 0]
