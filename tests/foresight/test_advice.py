"""What would tell a parameter that is not told: a test that halves its error, or the truth that there is none."""

from __future__ import annotations

import pytest
from dashpot.examples.truth import TRUTH
from dashpot.foresight.advice import advised
from dashpot.foresight.told import Told
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator

FREE = Oscillator.from_values({**TRUTH, "mass": None}, name="free")


@pytest.fixture(scope="module")
def data(recorded):
    return data_of([recorded(begin=(3e-3, 0.0), seconds=3.0, noise=5e-5)], FREE)


def lost(std):
    return Told("preload", 0.01, std, "m/s2", "not told", "preload is not told: 0.01")


def test_a_release_is_named_where_it_halves_the_error(data):
    (told,) = advised([lost(0.5)], FREE, data)
    assert told.words.startswith("preload is not told: 0.01; to know it to ± 0.0")
    assert "release it from" in told.words


def test_where_none_does_that_is_said(data):
    (told,) = advised([lost(1e-6)], FREE, data)
    assert told.words.endswith("record longer, or with less noise")


def test_what_is_told_needs_none(data):
    known = Told("omega0", 79.6, 0.01, "rad/s", "told")
    assert advised([known], FREE, data) == (known,)
