"""Where a start has lost the motion: what leads it back."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import Measure
from dashpot.diagnose.search.race import Entry, Start, any_lost, started
from dashpot.identify.problem.descent import Descent
from dashpot.identify.signals.odds import DECISIVE


def test_a_start_that_has_lost_the_motion_is_led_to_it(plain, bent):
    """And keeps what it is to keep; one that follows begins where it was put."""
    data, model = plain
    entry = Entry((), bent(model, omega0=1.05, viscous=2.0), fixed=("viscous",))
    lost, found = Start(entry, data, Measure()), started(entry, data, Measure())
    assert any_lost(data.segments, lost.descent.residuals)
    assert found is not None
    assert not any_lost(data.segments, found.descent.residuals)
    assert found.model.omega0.value == pytest.approx(model.omega0.value, rel=1e-3)
    assert found.model.viscous.value == 2.0 * model.viscous.value
    near = started(Entry((), bent(model, viscous=1.001)), data, Measure())
    assert near is not None
    assert near.model.viscous.value == 1.001 * model.viscous.value
    beside = started(entry, data, Measure(), beside_noise=True)  # what loses it there acts like nothing that is known
    assert beside is not None
    assert beside.model.omega0.value == 1.05 * model.omega0.value


def test_a_stretch_that_was_lost_is_begun_anew_before_a_start_rests(plain):
    """At the right parameters no step leads from another swing than the recorded one; the motion itself does."""
    data, model = plain
    start = Start(Entry((), model), data, Measure())
    good = start.value
    assert not start._settled_anew()
    lost = start.descent.state.initial.copy()
    lost[1] = -0.3 * lost[1]
    start.descent = Descent(start.descent.problem, replace(start.descent.state, initial=lost))
    start._white = True
    start._measure()
    assert start.value < good - DECISIVE
    assert not start.near
    assert start._settled_anew()
    assert start.value == pytest.approx(good, abs=1.0)
    assert not start.resting


@pytest.mark.parametrize(("left", "noise", "lost"), [(0.29, 0.0, False), (0.31, 0.0, True), (0.31, 0.1, False)])
def test_a_motion_is_lost_where_three_tenths_of_it_are_left_beyond_the_noise(left, noise, lost):
    motion = np.tile([1.0, -1.0], 50)
    segments = [SimpleNamespace(response=motion, noise=noise)] * 2
    assert any_lost(segments, [0.0 * motion, left * motion]) is lost
    assert any_lost(segments, [0.0 * motion, np.full(100, np.nan)])
