"""Linear systems sample by sample without scipy.signal: against it, and against the samples taken one by one."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.simulate.recursion import driven_by_lines, recursion
from scipy.signal import cont2discrete, dlsim, lfilter


@pytest.mark.parametrize("n", [1, 15, 16, 17, 256, 5003])
@pytest.mark.parametrize("pole", [0.3, -0.99, np.exp(-1e-4 + 0.05j)])
def test_one_state_is_scipys_filter(n, pole):
    inputs = np.random.default_rng(0).standard_normal(n)
    expected = lfilter([1.0], [1.0, -pole], inputs)
    found = recursion(np.array([[pole]]), inputs[:, None])[:, 0]
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.max(np.abs(expected)))


def test_several_states_are_those_taken_one_by_one():
    random = np.random.default_rng(1)
    matrix, inputs, state = 0.5 * random.standard_normal((3, 3)), random.standard_normal((300, 3)), np.zeros(3)
    expected = [state := matrix @ state + given for given in inputs]
    np.testing.assert_allclose(recursion(matrix, inputs), expected, rtol=1e-9)


@pytest.mark.parametrize(
    ("poles", "direct"),
    [((-30.0,), 0.0), ((-30.0, -80.0), 0.2), ((-50.0, -50.0), 1.0)],
    ids=["one", "two", "a double pole"],
)
def test_lines_between_samples_are_exact(poles, direct):
    states = len(poles)
    a = np.diag(poles) + 50.0 * np.eye(states, k=1)  # a chain of lags
    b, c, d, dt = np.full((states, 1), 50.0), np.ones((1, states)), np.array([[direct]]), 0.01
    force = np.random.default_rng(2).standard_normal(400)
    _, expected, _ = dlsim((*cont2discrete((a, b, c, d), dt, method="foh")[:4], dt), force[:, None])
    found = driven_by_lines((a, b, c, d), force, dt)
    np.testing.assert_allclose(found, expected[:, 0], atol=1e-11 * np.max(np.abs(expected)))
