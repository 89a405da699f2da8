"""Lies change what they say they change, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, lies, odd_lies, told
from dashpot.examples.odd_chains import copied, gain_walks, mean_of, on_force, on_response, saturates, wraps

STAND = STANDS["built-in"]
CLEAN = told(STAND, None)


@pytest.mark.parametrize("lie", odd_lies(STAND), ids=lambda lie: lie.name)
def test_an_odd_lie_changes_the_records_it_is_told_in_alone(lie):
    for place, (before, after) in enumerate(zip(CLEAN, told(STAND, lie), strict=True)):
        same = after.n == before.n and np.array_equal(before.response, after.response)
        same = same and (before.force is None or np.array_equal(before.force, after.force))
        assert same == (place not in ((1, 2) if lie.driven else (lie.record,)))
        assert np.all(np.isfinite(after.response))
        assert after.n > 0.9 * before.n


def test_each_lie_has_a_name_of_its_own_and_thirty_kinds_are_new():
    names = [lie.name for lie in (*lies(STAND), *odd_lies(STAND))]
    assert len(set(names)) == len(names)
    assert len({lie.kind for lie in odd_lies(STAND)} - {lie.kind for lie in lies(STAND)}) >= 30


def test_sizes_are_those_that_are_stated():
    (run,) = [r for r in CLEAN if r.name == "strong.csv"]
    top = np.max(np.abs(run.response))
    assert np.max(np.abs(on_response(saturates(0.03))(run).response)) == pytest.approx(0.97 * top)
    np.testing.assert_allclose(on_response(gain_walks(0.03))(run).response[-1], 1.03 * run.response[-1], rtol=1e-3)
    wrapped = on_force(wraps(0.7))(run).force
    assert np.max(np.abs(wrapped)) <= 0.7 * np.max(np.abs(run.force)) * (1 + 1e-12)
    ramp = on_response(mean_of(4))(run).response
    np.testing.assert_allclose(ramp[10], np.mean(run.response[7:11]))
    block = copied(1.0, 2.0, 0.5)(run)
    first = run.n // 2
    np.testing.assert_array_equal(block.response[first : first + 500], run.response[first - 1000 : first - 500])
    assert on_force(wraps(0.7))(CLEAN[0]) is CLEAN[0]
