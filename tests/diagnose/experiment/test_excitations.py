"""What may be asked of a rig, and the limits that excitations keep to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.experiment.excitations import BEYOND, CYCLES, Limits, candidates, limits_of
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator

FS, NATURAL = 600.0, 10.0
LIMITS = Limits(force=2.0, displacement=3e-3, band_hz=(6.0, 15.0))


def test_the_candidates_keep_to_the_limits():
    plans = candidates(LIMITS, NATURAL)
    for plan in plans:
        assert plan.seconds == pytest.approx(CYCLES / NATURAL)
        assert plan.relative <= BEYOND
        assert np.max(np.abs(plan.signal(FS))) <= BEYOND * LIMITS.force * (1 + 1e-9)
        largest = LIMITS.displacement if plan.kind == "decay" else LIMITS.force
        assert plan.level == pytest.approx(plan.relative * largest)
    assert {plan.kind for plan in plans} == {"sweep", "multisine", "sine", "decay"}
    # up and down, within the band; one beyond it, at the level that was recorded
    bands = {plan.band_hz for plan in plans if plan.kind == "sweep"}
    assert bands == {(6.0, 15.0), (15.0, 6.0), (6.0 / BEYOND, 15.0 * BEYOND)}
    assert [p.relative for p in plans if p.band_hz == (6.0 / BEYOND, 15.0 * BEYOND)] == [1.0]
    # at the smallest level only sweeps: a multisine would not rise out of the friction
    assert {plan.kind for plan in plans if plan.relative == min(p.relative for p in plans)} == {"sweep"}
    assert {plan.band_hz for plan in plans if plan.kind == "sine"} == {(10.0, 10.0), (10.0 / 3, 10.0 / 3)}
    assert max(p.relative for p in plans if p.band_hz == (10.0 / 3, 10.0 / 3)) == BEYOND


def test_a_band_far_from_the_resonance_is_cut():
    wide = Limits(force=2.0, displacement=3e-3, band_hz=(0.1, 400.0))
    bands = {plan.band_hz for plan in candidates(wide, NATURAL) if plan.kind == "multisine"}
    assert bands == {(3.0, 30.0)}


def test_without_a_force_only_releases_remain():
    plans = candidates(Limits(force=0.0, displacement=3e-3, band_hz=(6.0, 15.0)), NATURAL)
    assert {plan.kind for plan in plans} == {"decay"}
    assert [plan.level for plan in plans] == pytest.approx([0.9e-3, 1.8e-3, 3e-3, 4.5e-3])


@pytest.fixture(scope="module")
def model():
    return Oscillator.from_values(TRUTH)


def test_limits_are_those_of_what_was_recorded(model, recorded):
    natural = TRUTH["omega0"] / (2 * np.pi)
    wide = recorded(sweep=(0.8, 5.0, 25.0), seconds=5.0)
    limits = limits_of(data_of([wide], model))
    assert limits.force == pytest.approx(np.max(np.abs(wide.force)))
    assert limits.displacement == pytest.approx(np.max(np.abs(wide.response)), rel=0.05)
    assert limits.band_hz[0] < 0.6 * natural
    assert limits.band_hz[1] > 1.6 * natural
    narrow = limits_of(data_of([recorded(sweep=(0.8, 12.4, 12.9), seconds=8.0)], model))
    assert narrow.band_hz == pytest.approx((0.7 * natural, 1.4 * natural))  # the resonance at least


def test_where_nothing_drives_no_force_can_be_asked_for(model, recorded):
    decay = recorded(begin=(5e-3, 0.0), seconds=3.0)
    data = data_of([decay], model)
    assert limits_of(data).force == 0.0
    # a force channel that drives no segment is none either
    assert limits_of(replace(data, scales=replace(data.scales, force=3.0))).force == 0.0
