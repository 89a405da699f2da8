"""What no curve passes is not drawn as measured."""

from __future__ import annotations

import numpy as np
from dashpot.report.covered import covered, parted, spans_of

#: A sweep of small and bursts of large amplitudes; of the last nothing is known.
SPANS = spans_of([np.array([0.1, 2.0, 2.7, np.nan]), np.array([8.6, 7.6]), np.array([np.nan])])


def test_spans_are_of_what_is_finite():
    assert SPANS == [(0.1, 2.7), (7.6, 8.6)]


def test_between_curves_nothing_is_covered():
    assert covered(np.array([0.05, 0.1, 2.5, 5.0, 8.0, 9.0]), SPANS).tolist() == [False, True, True, False, True, False]
    assert not covered(np.ones(2), []).any()


def test_a_line_parts_where_no_curve_passes():
    at, force = parted(np.array([1.0, 2.5, 8.0, 8.5]), SPANS, np.array([1.0, 2.0, 3.0, 4.0]))
    np.testing.assert_equal(at, [1.0, 2.5, np.nan, 8.0, 8.5])
    np.testing.assert_equal(force, [1.0, 2.0, np.nan, 3.0, 4.0])
