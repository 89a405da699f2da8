"""Values that each recording has of its own, against the closed forms of one mean of groups of equal errors."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.faults.random_effects import OwnValues
from dashpot.identify.problem.linearised import Sums

ERROR = 0.1
MEANS = np.array([[1.0, 1.6, 0.7, 1.1, 2.0]])


def own_values(means, error=ERROR):
    """Of kinds (kinds, groups) of measured means: columns of the common values, then of each group's deviations."""
    kinds, groups = means.shape
    of_group = np.eye(kinds * groups) / error
    columns = np.vstack([np.kron(np.eye(kinds), np.ones(groups)) / error, of_group])
    # the point at which each group has its own value, about the first one's
    return OwnValues(Sums.of(columns, np.zeros(kinds * groups)), kinds, means - means[:, :1])


def test_the_spread_is_what_the_scatter_is_more_than_the_errors():
    """Balanced one-way layout: the restricted likelihood's variance is that of the means less that of their errors."""
    expected = np.sqrt(np.var(MEANS[0], ddof=1) - ERROR**2)
    assert own_values(MEANS).sizes([0])[0] == pytest.approx(expected, rel=0.12)


def test_deviations_shrink_towards_the_mean():
    size = 0.3
    step, effects = own_values(MEANS).effects([0], np.array([size]))
    shrunk = size**2 / (size**2 + ERROR**2)
    assert step[0] + MEANS[0, 0] == pytest.approx(np.mean(MEANS), abs=1e-9)
    assert effects[0] == pytest.approx(shrunk * (MEANS[0] - np.mean(MEANS)), abs=1e-9)


def test_what_is_lost_without_them_is_half_of_cochrans_sum():
    lost = np.sum((MEANS[0] - np.mean(MEANS)) ** 2) / (2 * ERROR**2)
    assert own_values(MEANS).lost([]) == pytest.approx(lost)
    assert own_values(MEANS).lost([0]) == 0.0


def test_of_two_kinds_each_loses_its_own():
    both = own_values(np.vstack([MEANS, 3.0 + 0.1 * MEANS]))
    assert both.lost([0]) == pytest.approx(1e-2 * both.lost([1]))
    assert both.lost([]) == pytest.approx(both.lost([0]) + both.lost([1]))
    step, effects = both.effects([1], np.array([0.5]))
    # where the first kind does not differ its common value is the mean too
    assert step[0] == pytest.approx(np.mean(MEANS) - MEANS[0, 0])
    assert effects.shape == (1, 5)
