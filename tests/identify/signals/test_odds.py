"""The level of doubt, said three ways."""

from __future__ import annotations

import math

import pytest
from dashpot.identify.signals.odds import BEYOND_ERRORS, BY_CHANCE, DECISIVE
from scipy.stats import norm


@pytest.mark.parametrize(("odds", "settled"), [(990.0, False), (1010.0, True)])
def test_a_thousand_to_one_settles(odds: float, settled: bool) -> None:
    assert (math.log(odds) > DECISIVE) is settled
    assert (1.0 / odds < BY_CHANCE) is settled


@pytest.mark.parametrize(("errors", "believed"), [(3.7, False), (3.73, True)])
def test_so_many_errors_from_zero_a_value_is_a_thousand_times_as_likely_as_zero(errors: float, believed: bool) -> None:
    odds = norm.pdf(0.0) / norm.pdf(errors)
    assert bool(odds > 1000.0) is believed
    assert (errors > BEYOND_ERRORS) is believed
