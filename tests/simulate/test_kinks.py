"""Derivatives of expressions whose kinks hang on one another."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from dashpot.simulate.kinks import sided


def test_a_kink_of_what_an_earlier_comparison_chose_has_a_side_of_its_own():
    """The acceleration of a mass that has a floor, bent by a sensor: |x (1 + (x > 1) x) - 3|."""
    x = ca.SX.sym("x")
    made = sided(ca.fabs(x * (1 + (x > 1) * x) - 3), [x], x, x)
    values = ca.Function("values", [x], [made.values])
    slope = ca.Function("slope", [x, made.sides], [made.jacobian])
    for at, expected in ((0.5, -1.0), (1.1, -3.2), (2.0, 5.0)):
        assert float(slope(at, values(at))) == pytest.approx(expected)
    assert np.array(values(2.0)).ravel().tolist() == [1.0, 1.0]
    # on the other side of the comparison, held: the slope of that branch
    assert float(slope(1.1, ca.DM([0.0, -1.0]))) == pytest.approx(-1.0)
