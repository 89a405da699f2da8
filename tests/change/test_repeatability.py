"""What repeats show is what they were drawn with."""

from __future__ import annotations

import numpy as np
from dashpot.change.estimates import side_by_side
from dashpot.change.repeatability import KNOWN, learnt_from

SPREAD = np.array([0.3, 0.0, 0.0, 0.2, 0.0])  # omega0 and viscous differ from one repeat to the next


def learnt(drawn, seed, **how):
    random = np.random.default_rng(seed)
    models = [drawn(random, shift=50.0 * (i // 4), **how) for i in range(24)]
    estimates = side_by_side(models)
    return estimates, learnt_from(estimates, [range(4 * g, 4 * g + 4) for g in range(6)], trusted=True)


def test_the_spread_between_repeats_is_found_beside_the_stated_errors(drawn):
    found = []
    for seed in range(6):
        estimates, known = learnt(drawn, seed, spread=SPREAD)
        found.append(known.spread * estimates.scale)
        assert known.learnt == 18
        assert known.freedom[0] < 30  # what was learnt from 18 degrees of freedom is known no better
    middle = np.median(found, axis=0)
    np.testing.assert_allclose(middle[[0, 3]], SPREAD[[0, 3]], rtol=0.2)
    assert np.all(middle[[2, 4]] < 0.5 * np.array([2e-4, 1e-4]))


def test_stated_errors_that_are_too_small_are_found_to_be(drawn):
    inflation = [learnt(drawn, seed, inflation=9.0)[1].inflation for seed in range(6)]
    assert 6.0 < np.median(inflation) < 13.0


def test_stated_errors_that_are_right_are_left_alone(drawn):
    for seed in range(4):
        _, known = learnt(drawn, seed)
        assert known.inflation < 1.6
        assert np.all(known.spread < 1.0)


def test_what_does_not_repeat_teaches_nothing(drawn):
    random = np.random.default_rng(0)
    estimates = side_by_side([drawn(random), drawn(random)])
    known = learnt_from(estimates, [[0], [1]], trusted=True)
    assert known.source == "errors"
    assert np.all(known.freedom == KNOWN)
