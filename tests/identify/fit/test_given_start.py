"""A model to start from that is of another rig: the search begins at an estimate of its own, and says so."""

from __future__ import annotations

from dataclasses import replace

import pytest
from dashpot.examples.lies import STANDS, told
from dashpot.identify.fit.given_start import leads, with_shared
from dashpot.identify.identification import identify
from dashpot.model import Oscillator
from dashpot.model.library import find
from dashpot.model.terms import with_term

STAND = replace(STANDS["built-in"], cycles=40.0, fs=300.0)
RECORDINGS = told(STAND, None)
RIG = Oscillator.from_values(STAND.values)


def off(**times: float) -> Oscillator:
    return Oscillator.from_values({name: value * times.get(name, 1.0) for name, value in STAND.values.items()})


@pytest.mark.parametrize(
    "times", [{"omega0": 100.0}, {"omega0": 0.01}, {"mass": 1e-6}, {"dry": 1e4}, {"omega0": 1e4}], ids=str
)
def test_a_start_of_another_rig_ends_where_the_own_one_does(times):
    found = identify(RECORDINGS, start=off(**times), doubted=False)
    assert any("does not predict the motion, not even over one cycle" in note for note in found.notes)
    assert found.work.times < 150
    for name, parameter in found.oscillator.parameters().items():
        assert abs(parameter.value - STAND.values[name]) < 5.0 * parameter.std


@pytest.mark.parametrize("times", [{}, {"omega0": 1.02}, {"mass": 1.5}, {"viscous": 3.0}], ids=str)
def test_a_start_that_is_near_is_taken(times):
    assert leads(off(**times), RIG, RECORDINGS)


def test_laws_keep_their_own_values():
    given = with_term(off(mass=3.0), "stribeck", {p.name: 0.0 for p in find("stribeck").parameters})
    made = with_shared(given, RIG)
    assert made.mass.value == RIG.mass.value
    assert made.terms == given.terms
